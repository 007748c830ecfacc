#pragma once

#include "firmware/device/head_drivers.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/in_process_head.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

namespace slamsensor::tools {

using firmware::HeadDrivers;

/// The settings by which a host talks to the devices of an emulated head; its lines and bus are to be filled
/// in.
[[nodiscard]] firmware::HeadConfig head_config(const HeadProfile& profile);

/// Drivers for the devices of `profile` on the links of `head`, which outlives them. Refused when a driver
/// refuses its settings.
[[nodiscard]] tl::expected<HeadDrivers, WorldError> make_head_drivers(const HeadProfile& profile,
                                                                      InProcessHead& head);

}  // namespace slamsensor::tools
