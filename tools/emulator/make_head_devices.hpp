#pragma once

#include "tools/emulator/head_devices.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

namespace slamsensor::tools {

struct Scenario;

/// The devices of the scenario's head profile, switched on at time 0, each with its own random stream of the
/// scenario's seed; the rangefinder shoots into `scene`, which outlives them. Refused when a device cannot be
/// set up as the profile says.
[[nodiscard]] tl::expected<HeadDevices, WorldError> make_head_devices(const Scenario& scenario,
                                                                      RangeScene& scene);

}  // namespace slamsensor::tools
