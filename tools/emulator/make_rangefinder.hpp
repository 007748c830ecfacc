#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/head_profile.hpp"

#include <cstdint>
#include <memory>

namespace slamsensor::tools {

/// The rangefinder of `profile` on a serial line (a TF03 also when the profile says CAN). `sink` and `scene`
/// outlive it.
[[nodiscard]] std::unique_ptr<EmulatedSerialDevice> make_serial_rangefinder(const RangefinderProfile& profile,
                                                                            ByteSink& sink, RangeScene& scene,
                                                                            std::uint64_t seed);

/// The TF03 of `profile` on a CAN bus.
[[nodiscard]] std::unique_ptr<EmulatedCanDevice> make_can_rangefinder(const RangefinderProfile& profile,
                                                                      FrameSink& sink, RangeScene& scene,
                                                                      std::uint64_t seed);

}  // namespace slamsensor::tools
