#pragma once

#include <string>

namespace slamsensor::firmware {

/// `value` with `decimals` digits behind the point, whatever the locale; -0.0 has no sign. "unknown" when it
/// is not finite.
[[nodiscard]] std::string decimal_text(double value, int decimals);

}  // namespace slamsensor::firmware
