#pragma once

#include "tools/emulator/canopen/drive_settings.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/ptu/ptu_settings.hpp"

namespace slamsensor::tools {

/// The settings of the serial unit that `profile` names (not CanOpen).
[[nodiscard]] PtuSettings ptu_settings_of(const PtuProfile& profile);

/// The settings of two CANopen axes that begin, boot and answer as `profile` says.
[[nodiscard]] CanopenHeadSettings canopen_settings_of(const PtuProfile& profile);

}  // namespace slamsensor::tools
