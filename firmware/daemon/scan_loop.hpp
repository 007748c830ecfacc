#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/daemon/handover.hpp"
#include "firmware/daemon/inclination_loop.hpp"
#include "firmware/daemon/realtime.hpp"
#include "firmware/device/head_drivers.hpp"
#include "firmware/gpio/gpio_panel.hpp"
#include "firmware/recording/recording_links.hpp"
#include "firmware/scan/scan_config.hpp"
#include "firmware/scan/sensor_head.hpp"
#include "firmware/status/sensor_status.hpp"
#include "firmware/status/sensor_tracker.hpp"
#include "hal/stamp.hpp"

#include <tl/expected.hpp>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace slamsensor::firmware {

/// The sensor head as the scan thread steps it: links, drivers on them, and what leads and reads the two.
class HeadRuntime {
 public:
  /// The head of `config` on real links; each with a tap before it that writes onto `tape`, when that is not
  /// null. The error names the setting.
  [[nodiscard]] static tl::expected<std::unique_ptr<HeadRuntime>, std::string> create(const Config& config,
                                                                                      TapeWriter* tape);

  [[nodiscard]] hal::PanTilt& pan_tilt() noexcept { return *drivers_.pan_tilt; }
  [[nodiscard]] hal::Rangefinder& rangefinder() noexcept { return *drivers_.rangefinder; }
  [[nodiscard]] SensorHead& head() noexcept { return *head_; }
  /// What the devices' links have counted.
  [[nodiscard]] std::span<const hal::Counter> pan_tilt_link() const noexcept {
    return links_.pan_tilt_bytes ? links_.pan_tilt_bytes->counters() : links_.pan_tilt_can->counters();
  }
  [[nodiscard]] std::span<const hal::Counter> rangefinder_link() const noexcept {
    return links_.rangefinder_bytes ? links_.rangefinder_bytes->counters()
                                    : links_.rangefinder_can->counters();
  }
  /// What is being recorded, or null.
  [[nodiscard]] TapeWriter* tape() noexcept { return tape_; }
  /// Nothing is written onto the tape any more.
  void leave_tape() noexcept;

 private:
  explicit HeadRuntime(OwnedHeadLinks links) : links_(std::move(links)) {}

  OwnedHeadLinks links_;
  std::optional<RecordingHeadLinks> taps_;  // of a head that was made for a recording
  TapeWriter* tape_ = nullptr;
  HeadDrivers drivers_;
  std::unique_ptr<SensorHead> head_;
};

/// What the other threads want of the scan thread; each value may be set by any of them.
struct ScanOrders {
  std::atomic<std::uint32_t> scans_requested{0};  ///< since start
  std::atomic<std::uint32_t> aborts_requested{0};
  std::atomic<bool> paused{false};
  std::atomic<ScanMode> mode{ScanMode::Continuous};
};

/// From bytes to scanlines: the body of the scan thread. What the head gets beside the devices' bytes goes
/// onto the tape too, when there is one. No allocation after construction, no lock, no clock;
/// one thread.
class ScanLoop {
 public:
  /// The others outlive this. `panel` may be null: no trigger, no interlock.
  ScanLoop(HeadRuntime& head, GpioInputs* panel, ScanOrders& orders, ScanQueue& queue, Wakeup& slam,
           Mailbox<HeadStatus>& status);

  /// The head gets what comes from `reports`, which outlives this. Before the first step().
  void read_inclination(Mailbox<InclinationReport>& reports, hal::Stamp max_age) noexcept {
    inclination_.emplace(reports, max_age);
  }

  /// One look at the devices. `timer` is the thread's, for the report.
  void step(hal::Stamp now, const PeriodicTimer& timer) noexcept;

 private:
  void obey(hal::Stamp now) noexcept;
  void command(TapeCommand what, std::uint64_t argument = 0) noexcept;
  void set_hold(HoldReason reason, bool is_held) noexcept;
  void hand_on() noexcept;
  void report(hal::Stamp now, const PeriodicTimer& timer) noexcept;
  void measure_rate(hal::Stamp now) noexcept;

  HeadRuntime& head_;
  GpioInputs* panel_;
  ScanOrders& orders_;
  ScanQueue& queue_;
  Wakeup& slam_;
  Mailbox<HeadStatus>& status_;
  std::optional<InclinationFeed> inclination_;
  DeviceWatch pan_tilt_watch_;
  DeviceWatch rangefinder_watch_;
  std::array<bool, kHoldReasons> is_held_{};
  std::optional<ScanMode> mode_;
  std::uint32_t scans_requested_;
  std::uint32_t aborts_requested_;
  std::uint32_t scan_ = 0;
  hal::Stamp stepped_{};
  std::uint32_t stops_ = 0;
  hal::Stamp last_stop_{};
  hal::Stamp reported_{};
  hal::Stamp rate_since_{};
  std::uint64_t rate_readings_ = 0;
  double rate_hz_ = 0.0;
};

}  // namespace slamsensor::firmware
