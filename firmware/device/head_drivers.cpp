#include "firmware/device/head_drivers.hpp"

#include "hal/pantilt/canopen/canopen_pan_tilt.hpp"
#include "hal/pantilt/ptu_driver.hpp"

#include <string>
#include <string_view>
#include <utility>

namespace slamsensor::firmware {
namespace {

template <typename Device>
using Made = tl::expected<std::unique_ptr<Device>, hal::InitError>;

/// The driver as `Device`, or the error with the section of the configuration that it is about.
template <typename Device, typename Driver>
Made<Device> in_section(std::string_view section, Made<Driver> made) {
  if (!made) {
    return tl::unexpected(hal::InitError{std::string(section) + ": " + made.error().message});
  }
  return std::unique_ptr<Device>(std::move(*made));
}

hal::InitError no_link(std::string_view setting, std::string_view device, std::string_view needed) {
  return {std::string(setting) + ": " + std::string(device) + " needs " + std::string(needed) +
          "; give it one, or choose another kind of device"};
}

Made<hal::PanTilt> make_pan_tilt(const HeadConfig& config, const HeadLinks& links) {
  if (config.pan_tilt == PanTiltKind::Canopen) {
    if (links.pan_tilt_can == nullptr) {
      return tl::unexpected(no_link("head.pan_tilt", "the CANopen pan-tilt unit", "a CAN bus"));
    }
    return in_section<hal::PanTilt>("canopen",
                                    hal::CanopenPanTilt::create(config.canopen, *links.pan_tilt_can));
  }
  if (links.pan_tilt_bytes == nullptr) {
    return tl::unexpected(no_link("head.pan_tilt", "the pan-tilt unit", "a serial line"));
  }
  return in_section<hal::PanTilt>("ptu", hal::PtuDriver::create(config.ptu, *links.pan_tilt_bytes));
}

Made<hal::Rangefinder> make_on_bus(const HeadConfig& config, const HeadLinks& links) {
  if (links.rangefinder_can == nullptr) {
    return tl::unexpected(no_link("head.rangefinder", "the Benewake rangefinder", "a CAN bus"));
  }
  hal::BenewakeCanConfig whole = config.benewake_can;
  whole.device = config.benewake_serial.device;
  return in_section<hal::Rangefinder>("benewake", hal::make_benewake_can(whole, *links.rangefinder_can));
}

Made<hal::Rangefinder> make_rangefinder(const HeadConfig& config, const HeadLinks& links) {
  if (config.rangefinder == RangefinderKind::BenewakeCan) {
    return make_on_bus(config, links);
  }
  if (links.rangefinder_bytes == nullptr) {
    return tl::unexpected(no_link("head.rangefinder", "the rangefinder", "a serial line"));
  }
  hal::ByteLink& line = *links.rangefinder_bytes;
  switch (config.rangefinder) {
    case RangefinderKind::Lwnx:
      return in_section<hal::Rangefinder>("lwnx", hal::make_lwnx_rangefinder(config.lwnx, line));
    case RangefinderKind::PointLaser:
      return in_section<hal::Rangefinder>("point_laser", hal::make_point_laser(config.point_laser, line));
    case RangefinderKind::BenewakeSerial:
    case RangefinderKind::BenewakeCan:
      break;
  }
  return in_section<hal::Rangefinder>("benewake", hal::make_benewake_serial(config.benewake_serial, line));
}

}  // namespace

tl::expected<HeadDrivers, hal::InitError> make_head_drivers(const HeadConfig& config,
                                                            const HeadLinks& links) {
  auto pan_tilt = make_pan_tilt(config, links);
  if (!pan_tilt) {
    return tl::unexpected(std::move(pan_tilt.error()));
  }
  auto rangefinder = make_rangefinder(config, links);
  if (!rangefinder) {
    return tl::unexpected(std::move(rangefinder.error()));
  }
  return HeadDrivers{std::move(*pan_tilt), std::move(*rangefinder)};
}

}  // namespace slamsensor::firmware
