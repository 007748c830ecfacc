#pragma once

#include "hal/fixed_text.hpp"
#include "hal/stamp.hpp"

#include <chrono>
#include <cstddef>
#include <string_view>

namespace slamsensor::hal {

/// How patiently a lost transport is opened again: the wait doubles from `first` to `longest`.
struct ReopenConfig {
  Stamp first = std::chrono::milliseconds(50);
  Stamp longest = std::chrono::seconds(2);
};

inline constexpr std::string_view kReopenRule =
    "the waits before reopening must be 1 ms to 1 min, the first not above the longest";

/// Whether `config` keeps kReopenRule.
[[nodiscard]] constexpr bool is_valid(const ReopenConfig& config) noexcept {
  return config.first >= std::chrono::milliseconds(1) && config.first <= config.longest &&
         config.longest <= std::chrono::minutes(1);
}

/// When to try to open a transport: at once the first time, then with back-off. A transport that fails again
/// soon after it was opened has gained nothing, so only one that stood for `longest` starts over at `first`.
class ReopenTimer {
 public:
  /// `config` must be valid.
  explicit ReopenTimer(const ReopenConfig& config) noexcept : config_(config) {}

  /// Whether an attempt is due at `now`.
  [[nodiscard]] bool is_due(Stamp now) const noexcept { return now >= next_; }

  void failed(Stamp now) noexcept { wait_from(now); }
  void opened(Stamp now) noexcept { opened_ = now; }

  /// The transport, opened before, was found lost at `now`.
  void lost(Stamp now) noexcept {
    if (now - opened_ >= config_.longest) {
      wait_ = Stamp{};
    }
    wait_from(now);
  }

 private:
  void wait_from(Stamp now) noexcept {
    wait_ = wait_ == Stamp{} ? config_.first : wait_;
    next_ = now + wait_;
    wait_ = wait_ < config_.longest - wait_ ? wait_ * 2 : config_.longest;
  }

  ReopenConfig config_;
  Stamp wait_{};  ///< the next wait; zero: `first`
  Stamp next_ = Stamp::min();
  Stamp opened_{};
};

/// Longest name of a device that a transport takes (a stable path), so that no problem's words are cut.
inline constexpr std::size_t kDeviceNameMax = 160;

inline constexpr std::size_t kProblemMax = 400;

using ReopenProblem = FixedText<kProblemMax>;

/// What stands in the way of opening a transport.
struct OpenFailure {
  std::string_view doing;   ///< the step that failed ("open"); empty: `error` says it all
  int error = 0;            ///< errno of the step; 0: none
  std::string_view advice;  ///< what to do; empty: that of the error itself
};

/// What to do where the unit of the service keeps it from a device of `group` (device_group): the line to add
/// to the unit.
class DeniedAdvice {
 public:
  explicit DeniedAdvice(std::string_view group) noexcept;
  [[nodiscard]] std::string_view view() const noexcept { return text_.view(); }

 private:
  FixedText<160> text_;
};

/// "serial port /dev/ptu: open: Permission denied; add the user to the group of the device (dialout)": kind
/// and name of the device, the failure, what to do. Takes no memory.
[[nodiscard]] ReopenProblem describe(std::string_view kind, std::string_view name,
                                     const OpenFailure& failure) noexcept;

}  // namespace slamsensor::hal
