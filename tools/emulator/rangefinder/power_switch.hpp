#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/head_profile.hpp"

#include <algorithm>

namespace slamsensor::tools {

/// Whether a device runs, and when it will: power comes, a boot time passes, it runs.
class PowerSwitch {
 public:
  /// The power comes at time 0, or the device has long been running.
  PowerSwitch(DeviceBegin begin, Stamp boot_time)
      : boot_time_(boot_time), up_at_(begin == DeviceBegin::Ready ? hal::kNever : boot_time) {}

  [[nodiscard]] bool is_up() const { return up_at_ == hal::kNever; }

  /// When the device will be up; hal::kNever when it is.
  [[nodiscard]] Stamp next() const { return up_at_; }

  /// No power before `until`.
  void cut(Stamp until) { up_at_ = std::max(is_up() ? Stamp::min() : up_at_, until + boot_time_); }

  /// next() has come.
  void go_up() { up_at_ = hal::kNever; }

 private:
  Stamp boot_time_;
  Stamp up_at_;
};

}  // namespace slamsensor::tools
