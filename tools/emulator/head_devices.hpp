#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/emulated_port.hpp"
#include "tools/emulator/memory_can_bus.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <memory>
#include <string_view>

namespace slamsensor::tools {

/// Names of what faults can be injected into: the pan-tilt unit and its line, the rangefinder and its line,
/// the CAN bus.
inline constexpr std::string_view kPtuName = "ptu";
inline constexpr std::string_view kRangefinderName = "rangefinder";
inline constexpr std::string_view kCanName = "can";

/// The devices of a sensor head on their lines, and the inclinometer on the bus. A device without a port is
/// on the bus.
struct HeadDevices {
  std::unique_ptr<EmulatedPort> ptu_port;          ///< null: the unit is on the bus
  std::unique_ptr<EmulatedPort> rangefinder_port;  ///< null: the rangefinder is on the bus
  std::unique_ptr<MemoryCanBus> bus;               ///< null: no device is on a bus
  std::unique_ptr<EmulatedDevice> ptu;
  std::unique_ptr<EmulatedDevice> rangefinder;
  std::unique_ptr<EmulatedDevice> inclinometer;  ///< null: there is none
  const PointingTruth* pointing = nullptr;       ///< the unit's
};

struct Scenario;

/// The devices of the scenario's head profile, switched on at time 0, each with its own random stream of the
/// scenario's seed; the rangefinder shoots into `scene`, which outlives them. Refused when a device cannot be
/// set up as the profile says.
[[nodiscard]] tl::expected<HeadDevices, WorldError> make_head_devices(const Scenario& scenario,
                                                                      RangeScene& scene);

}  // namespace slamsensor::tools
