#pragma once

#include <string_view>

namespace slamsensor::firmware {

/// Of the product; that of the CMake project.
inline constexpr std::string_view kVersion = SLAMSENSOR_VERSION;

}  // namespace slamsensor::firmware
