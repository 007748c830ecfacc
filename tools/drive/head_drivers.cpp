#include "tools/drive/head_drivers.hpp"

#include "hal/pantilt/canopen/canopen_pan_tilt.hpp"
#include "hal/pantilt/ptu_driver.hpp"
#include "hal/rangefinder/benewake_config.hpp"
#include "hal/rangefinder/lwnx_driver.hpp"
#include "hal/rangefinder/point_laser.hpp"

#include <utility>

namespace slamsensor::tools {
namespace {

using MadePanTilt = tl::expected<std::unique_ptr<hal::PanTilt>, hal::InitError>;
using MadeRangefinder = tl::expected<std::unique_ptr<hal::Rangefinder>, hal::InitError>;

hal::CanopenConfig canopen_config() {
  hal::CanopenConfig config;
  for (hal::CanopenAxisConfig* const axis : {&config.pan, &config.tilt}) {
    axis->scale = hal::CanopenScale::FromDrive;
    axis->speed_max_radps = 5.0;
  }
  return config;
}

MadePanTilt make_pan_tilt(const PtuProfile& profile, InProcessHead& head) {
  if (is_on_bus(profile.unit)) {
    return hal::CanopenPanTilt::create(canopen_config(), *head.ptu_can());
  }
  return hal::PtuDriver::create(hal::PtuConfig{}, *head.ptu_bytes());
}

hal::LwnxConfig lwnx_config(const RangefinderProfile& profile) {
  hal::LwnxConfig config;
  config.baud = profile.baud;
  config.rate_hz = profile.rate_hz;
  if (profile.rate_hz >= 20'000.0) {
    config.mode = hal::LwnxMode::RawReadings;
  }
  return config;
}

MadeRangefinder make_point_laser(hal::PointLaserConfig config, const RangefinderProfile& profile,
                                 InProcessHead& head) {
  config.baud = profile.baud;
  config.rate_hz = profile.rate_hz;
  return hal::make_point_laser(config, *head.rangefinder_bytes());
}

MadeRangefinder make_rangefinder(const RangefinderProfile& profile, InProcessHead& head) {
  switch (profile.unit) {
    case RangefinderModel::Lw20:
    case RangefinderModel::Sf30d:
    case RangefinderModel::Sf45:
    case RangefinderModel::Grf500:
      return hal::make_lwnx_rangefinder(lwnx_config(profile), *head.rangefinder_bytes());
    case RangefinderModel::Tf03: {
      hal::BenewakeSerialConfig config;
      config.device.rate_hz = profile.rate_hz;
      config.baud = profile.baud;
      return hal::make_benewake_serial(config, *head.rangefinder_bytes());
    }
    case RangefinderModel::Tf03Can: {
      hal::BenewakeCanConfig config;
      config.device.rate_hz = profile.rate_hz;
      return hal::make_benewake_can(config, *head.rangefinder_can());
    }
    case RangefinderModel::Lds70a:
      return make_point_laser(hal::astech_lds70a(), profile, head);
    case RangefinderModel::LaserAceIm:
      break;
  }
  return make_point_laser(hal::mdl_laserace_im_hr_unverified(), profile, head);
}

}  // namespace

tl::expected<HeadDrivers, WorldError> make_head_drivers(const HeadProfile& profile, InProcessHead& head) {
  auto pan_tilt = make_pan_tilt(profile.ptu, head);
  if (!pan_tilt) {
    return tl::unexpected(WorldError{pan_tilt.error().message});
  }
  auto rangefinder = make_rangefinder(profile.rangefinder, head);
  if (!rangefinder) {
    return tl::unexpected(WorldError{rangefinder.error().message});
  }
  return HeadDrivers{std::move(*pan_tilt), std::move(*rangefinder)};
}

}  // namespace slamsensor::tools
