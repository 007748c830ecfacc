#include "firmware/device/head_drivers.hpp"

#include "hal/pantilt/canopen/canopen_pan_tilt.hpp"
#include "hal/pantilt/canopen/cia402.hpp"
#include "hal/pantilt/ptu_driver.hpp"
#include "hal/transport/can_socket.hpp"
#include "hal/transport/serial_port.hpp"

#include <string>
#include <string_view>
#include <utility>

namespace slamsensor::firmware {
namespace {

using OpenedBytes = tl::expected<std::unique_ptr<hal::ByteLink>, hal::InitError>;
using OpenedCan = tl::expected<std::unique_ptr<hal::CanLink>, hal::InitError>;

hal::InitError at_setting(std::string_view setting, const hal::InitError& error) {
  return {std::string(setting) + ": " + error.message};
}

/// `baud`: the rate that the driver tries first, so that the port does not open at another one.
OpenedBytes open_port(hal::SerialConfig config, std::uint32_t baud, std::string_view setting) {
  config.line.baud = baud;
  auto port = hal::SerialPort::create(config);
  if (!port) {
    return tl::unexpected(at_setting(setting, port.error()));
  }
  return std::unique_ptr<hal::ByteLink>(std::move(*port));
}

OpenedCan open_bus(const std::string& interface, const hal::CanFilter& filter) {
  hal::CanConfig config;
  config.interface = interface;
  config.filters = {filter};
  auto socket = hal::CanSocket::create(config);
  if (!socket) {
    return tl::unexpected(at_setting("head.can_interface", socket.error()));
  }
  return std::unique_ptr<hal::CanLink>(std::move(*socket));
}

/// CANopen uses 11-bit identifiers; a node may keep its PDOs at any of them.
constexpr hal::CanFilter kEveryStandardFrame{.id = 0, .mask = 0, .extended = false};

hal::CanFilter readings_of(const hal::BenewakeCanConfig& config) noexcept {
  const std::uint32_t whole = config.device_id_is_extended ? 0x1FFF'FFFF : 0x7FF;
  return {.id = config.device_id, .mask = whole, .extended = config.device_id_is_extended};
}

std::uint32_t first_baud(const HeadConfig& config) noexcept {
  switch (config.rangefinder) {
    case RangefinderKind::Lwnx:
      return config.lwnx.baud;
    case RangefinderKind::PointLaser:
      return config.point_laser.baud;
    case RangefinderKind::BenewakeSerial:
    case RangefinderKind::BenewakeCan:
      break;
  }
  return config.benewake_serial.baud;
}

/// Puts what was opened into `place`; the error when it was not.
template <typename Link>
std::optional<hal::InitError> keep(std::unique_ptr<Link>& place,
                                   tl::expected<std::unique_ptr<Link>, hal::InitError> opened) {
  if (!opened) {
    return opened.error();
  }
  place = std::move(*opened);
  return std::nullopt;
}

std::optional<hal::InitError> open_pan_tilt(const HeadConfig& config, OwnedHeadLinks& links) {
  if (config.pan_tilt == PanTiltKind::Canopen) {
    return keep(links.pan_tilt_can, open_bus(config.can_interface, kEveryStandardFrame));
  }
  const std::uint32_t baud =
      config.ptu.rates_baud.empty() ? config.pan_tilt_port.line.baud : config.ptu.rates_baud.front();
  return keep(links.pan_tilt_bytes, open_port(config.pan_tilt_port, baud, "pan_tilt_port"));
}

std::optional<hal::InitError> open_rangefinder(const HeadConfig& config, OwnedHeadLinks& links) {
  if (config.rangefinder == RangefinderKind::BenewakeCan) {
    return keep(links.rangefinder_can, open_bus(config.can_interface, readings_of(config.benewake_can)));
  }
  return keep(links.rangefinder_bytes,
              open_port(config.rangefinder_port, first_baud(config), "rangefinder_port"));
}

}  // namespace

tl::expected<OwnedHeadLinks, hal::InitError> open_head_links(const HeadConfig& config) {
  OwnedHeadLinks links;
  if (auto error = open_pan_tilt(config, links)) {
    return tl::unexpected(std::move(*error));
  }
  if (auto error = open_rangefinder(config, links)) {
    return tl::unexpected(std::move(*error));
  }
  return links;
}

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

namespace {

tl::expected<OwnedInclinometer, hal::InitError> open_can(const hal::Cia410Config& config) {
  hal::CanConfig can;
  can.interface = config.interface;
  for (const std::uint32_t base : {hal::cob::kSdoReply, hal::cob::kHeartbeat, hal::cob::kEmergency}) {
    can.filters.push_back({.id = base + config.node, .mask = 0x7FF, .extended = false});
  }
  auto socket = hal::CanSocket::create(can);
  if (!socket) {
    return tl::unexpected(std::move(socket.error()));
  }
  auto device = hal::Cia410Inclinometer::create(config, **socket);
  if (!device) {
    return tl::unexpected(std::move(device.error()));
  }
  return OwnedInclinometer{std::move(*socket), std::move(*device)};
}

tl::expected<OwnedInclinometer, hal::InitError> open_iio(const hal::IioConfig& config) {
  auto device = hal::IioAccelerometer::create(config);
  if (!device) {
    return tl::unexpected(std::move(device.error()));
  }
  return OwnedInclinometer{nullptr, std::move(*device)};
}

}  // namespace

tl::expected<OwnedInclinometer, hal::InitError> open_inclinometer(const HeadConfig& config,
                                                                  InclinationSource source) {
  switch (source) {
    case InclinationSource::Can:
      return open_can(config.cia410);
    case InclinationSource::Iio:
      return open_iio(config.iio);
    case InclinationSource::None:
    case InclinationSource::Fixed:
      break;
  }
  return OwnedInclinometer{};
}

}  // namespace slamsensor::firmware
