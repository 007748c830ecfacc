#pragma once

#include "hal/pantilt/canopen/canopen_config.hpp"
#include "hal/pantilt/ptu_config.hpp"
#include "hal/rangefinder/benewake_config.hpp"
#include "hal/rangefinder/lwnx_driver.hpp"
#include "hal/rangefinder/point_laser.hpp"
#include "hal/transport/can_socket_config.hpp"
#include "hal/transport/serial_port_config.hpp"

#include <cstdint>
#include <string>

namespace slamsensor::firmware {

/// Which driver leads the pan-tilt unit.
enum class PanTiltKind : std::uint8_t { Ptu, Canopen };

/// Which driver reads the rangefinder.
enum class RangefinderKind : std::uint8_t { Lwnx, BenewakeSerial, BenewakeCan, PointLaser };

/// What a point laser is before its own keys are laid over it.
enum class PointLaserPreset : std::uint8_t { AstechLds70a, MdlLaserAceImHr, Custom };

/// The devices of the sensor head and how they are reached. Of the drivers' settings those of the chosen
/// kinds count.
struct HeadConfig {
  PanTiltKind pan_tilt = PanTiltKind::Ptu;
  RangefinderKind rangefinder = RangefinderKind::Lwnx;

  hal::SerialConfig pan_tilt_port{.path = "/dev/slamsensor/pantilt"};         ///< kind Ptu
  hal::SerialConfig rangefinder_port{.path = "/dev/slamsensor/rangefinder"};  ///< all kinds but BenewakeCan
  std::string can_interface = "can0";                                         ///< Canopen, BenewakeCan

  hal::PtuConfig ptu;
  hal::CanopenConfig canopen;
  hal::LwnxConfig lwnx;
  hal::BenewakeSerialConfig benewake_serial;  ///< its `device` also for BenewakeCan
  hal::BenewakeCanConfig benewake_can;
  PointLaserPreset point_laser_preset = PointLaserPreset::AstechLds70a;
  hal::PointLaserConfig point_laser = hal::astech_lds70a();
};

}  // namespace slamsensor::firmware
