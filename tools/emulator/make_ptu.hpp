#pragma once

#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/ptu/ptu_settings.hpp"

namespace slamsensor::tools {

/// The settings of the serial unit that `profile` names (not CanOpen).
[[nodiscard]] PtuSettings ptu_settings_of(const PtuProfile& profile);

}  // namespace slamsensor::tools
