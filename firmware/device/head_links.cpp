#include "firmware/device/head_drivers.hpp"
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

}  // namespace slamsensor::firmware
