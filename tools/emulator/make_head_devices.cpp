#include "tools/emulator/make_head_devices.hpp"

#include "tools/emulator/canopen/emulated_canopen_head.hpp"
#include "tools/emulator/canopen/emulated_inclinometer.hpp"
#include "tools/emulator/make_ptu.hpp"
#include "tools/emulator/make_rangefinder.hpp"
#include "tools/emulator/ptu/emulated_ptu.hpp"
#include "tools/emulator/scenario.hpp"

#include <string>
#include <utility>

namespace slamsensor::tools {
namespace {

// Random streams of the scenario's seed, beside those of EmulatedHead.
constexpr std::uint64_t kPtuLineStream = 16;
constexpr std::uint64_t kPtuStream = 17;
constexpr std::uint64_t kRangefinderLineStream = 18;
constexpr std::uint64_t kRangefinderStream = 19;

MemoryCanBus& bus_of(HeadDevices& devices) {
  if (devices.bus == nullptr) {
    devices.bus = std::make_unique<MemoryCanBus>();
  }
  return *devices.bus;
}

void add_canopen_ptu(const Scenario& scenario, HeadDevices& devices) {
  MemoryCanBus& bus = bus_of(devices);
  FrameSink& pan = bus.add_device_node();
  FrameSink& tilt = bus.add_device_node();
  auto unit = std::make_unique<EmulatedCanopenHead>(canopen_settings_of(scenario.head.ptu), pan, tilt,
                                                    mix_seed(scenario.seed, kPtuStream));
  bus.attach(pan, unit->pan());
  bus.attach(tilt, unit->tilt());
  devices.pointing = unit.get();
  devices.ptu = std::move(unit);
}

void add_ptu(const Scenario& scenario, HeadDevices& devices) {
  const PtuProfile& profile = scenario.head.ptu;
  if (is_on_bus(profile.unit)) {
    return add_canopen_ptu(scenario, devices);
  }
  devices.ptu_port = std::make_unique<EmulatedPort>(mix_seed(scenario.seed, kPtuLineStream));
  auto unit = std::make_unique<EmulatedPtu>(ptu_settings_of(profile), *devices.ptu_port,
                                            mix_seed(scenario.seed, kPtuStream));
  devices.ptu_port->attach(*unit);
  devices.pointing = unit.get();
  devices.ptu = std::move(unit);
}

void add_rangefinder(const Scenario& scenario, RangeScene& scene, HeadDevices& devices) {
  const RangefinderProfile& profile = scenario.head.rangefinder;
  const std::uint64_t seed = mix_seed(scenario.seed, kRangefinderStream);
  if (is_on_bus(profile.unit)) {
    FrameSink& node = bus_of(devices).add_device_node();
    auto device = make_can_rangefinder(profile, node, scene, seed);
    devices.bus->attach(node, *device);
    devices.rangefinder = std::move(device);
    return;
  }
  devices.rangefinder_port = std::make_unique<EmulatedPort>(mix_seed(scenario.seed, kRangefinderLineStream));
  auto device = make_serial_rangefinder(profile, *devices.rangefinder_port, scene, seed);
  devices.rangefinder_port->attach(*device);
  devices.rangefinder = std::move(device);
}

void add_inclinometer(const Scenario& scenario, HeadDevices& devices) {
  const InclinometerProfile& profile = scenario.head.inclinometer;
  if (profile.unit == InclinometerModel::None) {
    return;
  }
  InclinometerSettings settings;
  settings.node_id = static_cast<std::uint8_t>(profile.node);
  settings.resolution = static_cast<std::uint16_t>(profile.resolution);
  FrameSink& node = bus_of(devices).add_device_node();
  auto device = std::make_unique<EmulatedInclinometer>(settings, node);
  device->lean(scenario.mount.roll_rad, scenario.mount.pitch_rad, Stamp{});
  devices.bus->attach(node, *device);
  devices.inclinometer = std::move(device);
}

}  // namespace

tl::expected<HeadDevices, WorldError> make_head_devices(const Scenario& scenario, RangeScene& scene) {
  HeadDevices devices;
  add_ptu(scenario, devices);
  add_rangefinder(scenario, scene, devices);
  add_inclinometer(scenario, devices);
  return devices;
}

}  // namespace slamsensor::tools
