#pragma once

#include "hal/stamp.hpp"

#include <chrono>
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

}  // namespace slamsensor::hal
