#pragma once

#include "firmware/device/head_drivers.hpp"
#include "firmware/scan/sensor_head.hpp"
#include "tools/emulator/emulated_head.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/scenario.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace slamsensor::tools {

using firmware::HeadDrivers;

/// The settings by which a host talks to the devices of an emulated head; its lines and bus are to be filled
/// in.
[[nodiscard]] firmware::HeadConfig head_config(const HeadProfile& profile);

/// Drivers for the devices of `profile` on the links of `head`, which outlives them. Refused when a driver
/// refuses its settings.
[[nodiscard]] tl::expected<HeadDrivers, WorldError> make_head_drivers(const HeadProfile& profile,
                                                                      InProcessHead& head);

/// How far the pan of the readings is from where the head truly pointed.
struct PanErrors {
  std::size_t readings = 0;  ///< with a known truth
  double rms_rad = 0.0;
  double mean_rad = 0.0;  ///< towards the sweep: what a wrong latency does
  double worst_rad = 0.0;
};

/// One scan that came through the drivers.
struct DrivenScan {
  firmware::ScanEnded ended;
  core::Pose2 stand_W;  ///< where the sensor stood when it ended
  std::vector<std::vector<core::Reading>> scanlines;
  PanErrors pan;
};

/// A drive of an emulated head in simulated time, from bytes to scans: devices, lines, drivers, angle of each
/// reading. The head is stepped every millisecond. The same arguments give the same scans, bit for bit.
class ByteDrive {
 public:
  /// The head of `scenario`, whose stands change when a scan ends.
  [[nodiscard]] static tl::expected<std::unique_ptr<ByteDrive>, WorldError> create(
      Scenario scenario, const firmware::SensorHeadConfig& config);

  /// The same with host settings and links of the caller's: `through` gets the links of the emulated devices
  /// and returns those for the drivers, which may pass on less, more or later.
  using Through = std::function<firmware::HeadLinks(InProcessHead& head)>;
  [[nodiscard]] static tl::expected<std::unique_ptr<ByteDrive>, WorldError> create(
      Scenario scenario, const firmware::SensorHeadConfig& config, const firmware::HeadConfig& host,
      const Through& through);

  /// Runs until a scan has ended, and moves on to the next stand; nothing when none ended within `limit_s`.
  [[nodiscard]] std::optional<DrivenScan> next_scan(double limit_s);

  /// Runs for `seconds`, whatever happens; scans that end meanwhile are lost.
  void run(double seconds);

  [[nodiscard]] InProcessHead& head() noexcept { return *head_; }
  [[nodiscard]] const HeadDrivers& drivers() const noexcept { return drivers_; }
  [[nodiscard]] const firmware::SensorHead& sensor() const noexcept { return *sensor_; }

 private:
  ByteDrive(std::unique_ptr<InProcessHead> head, HeadDrivers drivers,
            const firmware::SensorHeadConfig& config);

  /// One millisecond; true when a scan ended in it.
  bool step();
  void add(const firmware::Scanline& line);
  void compare(const firmware::Scanline& line);

  std::unique_ptr<InProcessHead> head_;
  HeadDrivers drivers_;
  std::unique_ptr<firmware::SensorHead> sensor_;
  std::vector<ShotTruth> truth_;  // of readings that no line has claimed yet, in the order of time
  DrivenScan scan_;
  double pan_error_sum_ = 0.0;
  double pan_error_squares_ = 0.0;
};

}  // namespace slamsensor::tools
