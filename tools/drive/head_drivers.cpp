#include "tools/drive/head_drivers.hpp"

#include "hal/rangefinder/point_laser.hpp"

#include <utility>

namespace slamsensor::tools {
namespace {

constexpr std::int8_t kToLowerSwitch = 17;  // CiA 402, homing methods
constexpr double kRawRateHz = 20'000.0;     // LWNX devices send it in packets of raw readings alone

void set_pan_tilt(firmware::HeadConfig& config, const PtuProfile& profile) {
  if (!is_on_bus(profile.unit)) {
    return;
  }
  config.pan_tilt = firmware::PanTiltKind::Canopen;
  for (hal::CanopenAxisConfig* const axis : {&config.canopen.pan, &config.canopen.tilt}) {
    axis->scale = hal::CanopenScale::FromDrive;
    axis->speed_max_radps = 5.0;
    axis->homing_method = profile.encoder == DriveMemory::Incremental ? kToLowerSwitch : 0;
  }
}

void set_point_laser(firmware::HeadConfig& config, firmware::PointLaserPreset preset,
                     const RangefinderProfile& profile) {
  config.rangefinder = firmware::RangefinderKind::PointLaser;
  config.point_laser_preset = preset;
  config.point_laser = firmware::preset_config(preset);
  config.point_laser.baud = profile.baud;
  config.point_laser.rate_hz = profile.rate_hz;
}

void set_rangefinder(firmware::HeadConfig& config, const RangefinderProfile& profile) {
  switch (profile.unit) {
    case RangefinderModel::Lw20:
    case RangefinderModel::Sf30d:
    case RangefinderModel::Sf45:
    case RangefinderModel::Grf500:
      config.rangefinder = firmware::RangefinderKind::Lwnx;
      config.lwnx.baud = profile.baud;
      config.lwnx.rate_hz = profile.rate_hz;
      config.lwnx.mode = profile.rate_hz >= kRawRateHz ? hal::LwnxMode::RawReadings : hal::LwnxMode::Readings;
      return;
    case RangefinderModel::Tf03:
    case RangefinderModel::Tf03Can:
      config.rangefinder = is_on_bus(profile.unit) ? firmware::RangefinderKind::BenewakeCan
                                                   : firmware::RangefinderKind::BenewakeSerial;
      config.benewake_serial.device.rate_hz = profile.rate_hz;
      config.benewake_serial.baud = profile.baud;
      return;
    case RangefinderModel::Lds70a:
      set_point_laser(config, firmware::PointLaserPreset::AstechLds70a, profile);
      return;
    case RangefinderModel::LaserAceIm:
      break;
  }
  set_point_laser(config, firmware::PointLaserPreset::MdlLaserAceImHr, profile);
}

}  // namespace

firmware::HeadConfig head_config(const HeadProfile& profile) {
  firmware::HeadConfig config;
  set_pan_tilt(config, profile.ptu);
  set_rangefinder(config, profile.rangefinder);
  return config;
}

tl::expected<HeadDrivers, WorldError> make_head_drivers(const HeadProfile& profile, InProcessHead& head) {
  return firmware::make_head_drivers(head_config(profile), {head.ptu_bytes(), head.ptu_can(),
                                                            head.rangefinder_bytes(), head.rangefinder_can()})
      .map_error([](const hal::InitError& error) { return WorldError{error.message}; });
}

}  // namespace slamsensor::tools
