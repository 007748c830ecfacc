#include "firmware/device/inclinometers.hpp"

#include "hal/pantilt/canopen/cia402.hpp"
#include "hal/transport/can_socket.hpp"

#include <utility>

namespace slamsensor::firmware {
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
