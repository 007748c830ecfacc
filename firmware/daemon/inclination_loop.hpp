#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/daemon/handover.hpp"
#include "firmware/device/head_drivers.hpp"
#include "firmware/recording/tape_format.hpp"
#include "firmware/status/sensor_status.hpp"
#include "firmware/status/sensor_tracker.hpp"
#include "hal/stamp.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace slamsensor::firmware {

/// What the inclinometer's thread hands to the scan thread.
struct InclinationReport {
  DeviceStatus device;
  std::optional<hal::Inclination> latest;  ///< nothing before the first measurement
};

/// Reads the inclinometer: the body of a thread of its own, because reading may wait. One thread.
class InclinationLoop {
 public:
  /// The inclinometer of `config`; null when it asks for none. The error names the section.
  [[nodiscard]] static tl::expected<std::unique_ptr<InclinationLoop>, std::string> create(
      const Config& config);

  /// One look at the device. At least every 10 ms.
  void step(hal::Stamp now) noexcept;

  /// For the scan thread.
  [[nodiscard]] Mailbox<InclinationReport>& reports() noexcept { return reports_; }

 private:
  explicit InclinationLoop(OwnedInclinometer inclinometer) : inclinometer_(std::move(inclinometer)) {}

  OwnedInclinometer inclinometer_;
  DeviceWatch watch_;
  std::optional<hal::Inclination> latest_;
  hal::Stamp posted_{};
  Mailbox<InclinationReport> reports_;
};

/// The scan thread's end: what the head gets of the inclinometer's reports.
class InclinationFeed {
 public:
  struct Order {
    TapeCommand what = TapeCommand::Incline;
    std::uint64_t argument = 0;
  };

  /// `reports` outlives this. A head that has an inclinometer begins held.
  InclinationFeed(Mailbox<InclinationReport>& reports, hal::Stamp max_age) noexcept
      : reports_(reports), max_age_(max_age) {}

  /// An attitude for each measurement; once a hold when the last one has become too old.
  [[nodiscard]] std::optional<Order> step(hal::Stamp now) noexcept;

  /// Of the newest report.
  [[nodiscard]] const DeviceStatus& device() const noexcept { return reports_.value().device; }

 private:
  Mailbox<InclinationReport>& reports_;
  hal::Stamp max_age_;
  std::optional<hal::Stamp> known_;  // of the measurement in force
  hal::Stamp told_ = hal::Stamp::min();
};

}  // namespace slamsensor::firmware
