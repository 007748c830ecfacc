#pragma once

#include "core/config.hpp"
#include "hal/inclination/cia410.hpp"
#include "hal/inclination/iio_accelerometer.hpp"
#include "hal/pantilt/canopen/canopen_config.hpp"
#include "hal/pantilt/ptu_config.hpp"
#include "hal/rangefinder/benewake_driver.hpp"
#include "hal/rangefinder/lwnx_driver.hpp"
#include "hal/rangefinder/point_laser.hpp"
#include "hal/transport/can_socket.hpp"
#include "hal/transport/serial_line.hpp"

#include <cstdint>
#include <string>

namespace slamsensor::firmware {

/// Which driver leads the pan-tilt unit.
enum class PanTiltKind : std::uint8_t { Ptu, Canopen };

/// Which driver reads the rangefinder.
enum class RangefinderKind : std::uint8_t { Lwnx, BenewakeSerial, BenewakeCan, PointLaser };

/// What a point laser is before its own keys are laid over it.
enum class PointLaserPreset : std::uint8_t { AstechLds70a, MdlLaserAceImHr, Custom };

/// The settings that `preset` stands for.
[[nodiscard]] inline hal::PointLaserConfig preset_config(PointLaserPreset preset) {
  switch (preset) {
    case PointLaserPreset::AstechLds70a:
      return hal::astech_lds70a();
    case PointLaserPreset::MdlLaserAceImHr:
      return hal::mdl_laserace_im_hr_unverified();
    case PointLaserPreset::Custom:
      break;
  }
  return {};
}

/// hal's defaults with limits in round degrees.
[[nodiscard]] inline hal::CanopenConfig default_canopen() {
  hal::CanopenConfig config;
  for (hal::CanopenAxisConfig* const axis : {&config.pan, &config.tilt}) {
    axis->max_rad = (axis == &config.pan ? 170.0 : 85.0) * core::kDegree;
    axis->min_rad = -axis->max_rad;
    axis->speed_max_radps = 60.0 * core::kDegree;
    axis->window_rad = 0.05 * core::kDegree;
  }
  return config;
}

/// The devices of the sensor head and how they are reached. Of the drivers' settings those of the chosen
/// kinds count.
struct HeadConfig {
  PanTiltKind pan_tilt = PanTiltKind::Ptu;
  RangefinderKind rangefinder = RangefinderKind::Lwnx;

  hal::SerialConfig pan_tilt_port{.path = "/dev/slamsensor/pantilt"};         ///< kind Ptu
  hal::SerialConfig rangefinder_port{.path = "/dev/slamsensor/rangefinder"};  ///< all kinds but BenewakeCan
  std::string can_interface = "can0";                                         ///< Canopen, BenewakeCan

  hal::PtuConfig ptu;
  hal::CanopenConfig canopen = default_canopen();
  hal::LwnxConfig lwnx;
  hal::BenewakeSerialConfig benewake_serial;  ///< its `device` also for BenewakeCan
  hal::BenewakeCanConfig benewake_can;
  PointLaserPreset point_laser_preset = PointLaserPreset::AstechLds70a;
  hal::PointLaserConfig point_laser = hal::astech_lds70a();

  hal::Cia410Config cia410;  ///< the inclinometer of LevellingConfig::source, on its own CAN socket
  hal::IioConfig iio;
};

}  // namespace slamsensor::firmware
