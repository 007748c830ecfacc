#pragma once

#include "firmware/config/config.hpp"
#include "firmware/device/head_drivers.hpp"
#include "firmware/recording/recording_links.hpp"
#include "firmware/scan/sensor_head.hpp"

#include <tl/expected.hpp>

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

}  // namespace slamsensor::firmware
