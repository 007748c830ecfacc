#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "hal/rangefinder/rangefinder.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/in_process_head.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <memory>

namespace slamsensor::tools {

/// The drivers that a host would use for the devices of an emulated head.
struct HeadDrivers {
  std::unique_ptr<hal::PanTilt> pan_tilt;
  std::unique_ptr<hal::Rangefinder> rangefinder;
};

/// Drivers for the devices of `profile` on the links of `head`, which outlives them. Refused when a device
/// has no driver, or a driver its settings.
[[nodiscard]] tl::expected<HeadDrivers, WorldError> make_head_drivers(const HeadProfile& profile,
                                                                      InProcessHead& head);

}  // namespace slamsensor::tools
