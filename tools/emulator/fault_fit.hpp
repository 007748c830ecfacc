#pragma once

#include "tools/emulator/fault.hpp"
#include "tools/emulator/head_profile.hpp"

#include <string>
#include <string_view>

namespace slamsensor::tools {

/// Empty when `device` ("ptu", "rangefinder", "can") of `head` can have the fault `kind`; else what is wrong
/// with it.
[[nodiscard]] std::string misfit(const HeadProfile& head, std::string_view device, FaultKind kind);

}  // namespace slamsensor::tools
