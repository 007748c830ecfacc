#include "tools/emulator/head_devices.hpp"

#include "tools/emulator/canopen/drive_axis.hpp"
#include "tools/emulator/canopen/emulated_drive.hpp"
#include "tools/emulator/canopen/emulated_inclinometer.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/ptu/emulated_ptu.hpp"
#include "tools/emulator/ptu/ptu_head.hpp"
#include "tools/emulator/rangefinder/emulated_lwnx.hpp"
#include "tools/emulator/rangefinder/emulated_point_laser.hpp"
#include "tools/emulator/rangefinder/emulated_tf03.hpp"
#include "tools/emulator/scenario.hpp"

#include <cstdint>
#include <string>
#include <utility>

namespace slamsensor::tools {
namespace {

PtuKind kind_of(PanTiltModel unit) noexcept {
  switch (unit) {
    case PanTiltModel::D46_70:
      return PtuKind::D46_70;
    case PanTiltModel::E46_17_5:
      return PtuKind::E46_17_5;
    case PanTiltModel::D300E:
    case PanTiltModel::FastE:
      return PtuKind::D300E;
    case PanTiltModel::D46_17_5:
    case PanTiltModel::CanOpen:
      break;
  }
  return PtuKind::D46_17_5;
}

/// 321 deg/s reached at once: the base speed is the highest.
void make_fast(PtuAxisModel& axis) noexcept {
  constexpr long kFastest = 50'000;  // positions/s
  axis.base_speed = kFastest;
  axis.upper_speed = kFastest;
  axis.upper_speed_max = kFastest;
}

/// The settings of the serial unit that `profile` names (not CanOpen).
PtuSettings ptu_settings_of(const PtuProfile& profile) {
  PtuSettings settings = ptu_settings(kind_of(profile.unit));
  if (profile.unit == PanTiltModel::FastE) {
    settings.model.name = "FAST-E";
    make_fast(settings.model.pan);
    make_fast(settings.model.tilt);
  }
  settings.begin = profile.begin == DeviceBegin::Ready ? PtuBegin::Ready : PtuBegin::PowerUp;
  settings.factory_baud = profile.baud;
  settings.reply_latency = {hal::from_seconds(profile.reply_latency_s),
                            hal::from_seconds(profile.reply_jitter_s)};
  settings.position_latency = hal::from_seconds(profile.position_age_s);
  settings.boot_time = hal::from_seconds(profile.boot_s);
  settings.reset_time = hal::from_seconds(profile.reset_s);
  return settings;
}

/// The settings of two CANopen axes that begin, boot and answer as `profile` says.
CanopenHeadSettings canopen_settings_of(const PtuProfile& profile) {
  CanopenHeadSettings settings = canopen_head_settings();
  for (DriveSettings* const axis : {&settings.pan, &settings.tilt}) {
    axis->begin = profile.begin;
    axis->memory = profile.encoder;
    if (profile.encoder == DriveMemory::Incremental) {
      axis->home_offset = axis->lower_limit - axis->switch_margin;  // as homing by method 17 needs it
    }
    axis->boot_time = hal::from_seconds(profile.boot_s);
    axis->sdo_latency = {hal::from_seconds(profile.reply_latency_s),
                         hal::from_seconds(profile.reply_jitter_s)};
    axis->sync_latch = -hal::from_seconds(profile.position_age_s);
  }
  return settings;
}

using Made = std::unique_ptr<EmulatedSerialDevice>;

Delay record_delay(const RangefinderProfile& profile) noexcept {
  return {hal::from_seconds(profile.latency_s), hal::from_seconds(profile.jitter_s)};
}

Made make_lwnx(LwnxModel model, const RangefinderProfile& profile, ByteSink& sink, RangeScene& scene,
               std::uint64_t seed) {
  LwnxSettings settings;
  settings.product = lwnx_product(model);
  settings.begin = profile.begin;
  settings.baud = profile.baud;
  settings.delays.record = record_delay(profile);
  settings.crystal_ppm = profile.crystal_ppm;
  settings.seed = seed;
  set_rate(settings, profile.rate_hz);
  return std::make_unique<EmulatedLwnx>(settings, sink, scene);
}

Made make_point_laser(PointSettings settings, const RangefinderProfile& profile, ByteSink& sink,
                      RangeScene& scene, std::uint64_t seed) {
  settings.begin = profile.begin;
  settings.baud = profile.baud;
  settings.rate_hz = profile.rate_hz;
  settings.delays.record = record_delay(profile);
  settings.crystal_ppm = profile.crystal_ppm;
  settings.seed = seed;
  return std::make_unique<EmulatedPointLaser>(settings, sink, scene);
}

Tf03Settings tf03_settings_of(const RangefinderProfile& profile, std::uint64_t seed) {
  Tf03Settings settings = tf03_settings(BenewakeModel::Tf03);
  settings.begin = profile.begin;
  settings.saved.baud = profile.baud;
  settings.delays.record = record_delay(profile);
  settings.crystal_ppm = profile.crystal_ppm;
  settings.seed = seed;
  set_rate(settings, profile.rate_hz);
  return settings;
}

/// The TF03 of `profile` on a CAN bus.
std::unique_ptr<EmulatedCanDevice> make_can_rangefinder(const RangefinderProfile& profile, FrameSink& sink,
                                                        RangeScene& scene, std::uint64_t seed) {
  Tf03Settings settings = tf03_settings_of(profile, seed);
  settings.saved.wire = Tf03Wire::Can;
  return std::make_unique<EmulatedTf03Can>(settings, sink, scene);
}

/// The rangefinder of `profile` on a serial line (a TF03 also when the profile says CAN). `sink` and `scene`
/// outlive it.
Made make_serial_rangefinder(const RangefinderProfile& profile, ByteSink& sink, RangeScene& scene,
                             std::uint64_t seed) {
  switch (profile.unit) {
    case RangefinderModel::Lw20:
      return make_lwnx(LwnxModel::Lw20, profile, sink, scene, seed);
    case RangefinderModel::Sf30d:
      return make_lwnx(LwnxModel::Sf30d, profile, sink, scene, seed);
    case RangefinderModel::Sf45:
      return make_lwnx(LwnxModel::Sf45b, profile, sink, scene, seed);
    case RangefinderModel::Grf500:
      return make_lwnx(LwnxModel::Grf500, profile, sink, scene, seed);
    case RangefinderModel::Tf03:
    case RangefinderModel::Tf03Can:
      return std::make_unique<EmulatedTf03>(tf03_settings_of(profile, seed), sink, scene);
    case RangefinderModel::Lds70a:
      return make_point_laser(lds70a_settings(), profile, sink, scene, seed);
    case RangefinderModel::LaserAceIm:
      break;
  }
  return make_point_laser(laserace_im_settings(), profile, sink, scene, seed);
}

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
