#pragma once

#include "hal/fixed_text.hpp"

#include <cstddef>
#include <string_view>

namespace slamsensor::hal {

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
