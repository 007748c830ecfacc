#include "firmware/serving/nmea_tcp_server.hpp"

#include <algorithm>
#include <array>
#include <unistd.h>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr std::array<std::string_view, kNmeaTcpEvents> kNames = {"nmea_tcp_opened",
                                                                 "nmea_tcp_open_failed",
                                                                 "nmea_tcp_clients_accepted",
                                                                 "nmea_tcp_clients_refused",
                                                                 "nmea_tcp_accept_failed",
                                                                 "nmea_tcp_clients_left",
                                                                 "nmea_tcp_clients_displaced",
                                                                 "nmea_tcp_clients_stuck",
                                                                 "nmea_tcp_epochs",
                                                                 "nmea_tcp_bytes",
                                                                 "nmea_tcp_epochs_dropped",
                                                                 "nmea_tcp_bytes_ignored"};

constexpr int kAcceptsMax = 32;  // a step ends although clients come without pause

}  // namespace

tl::expected<std::unique_ptr<NmeaTcpServer>, hal::InitError> NmeaTcpServer::create(
    const NmeaTcpConfig& config) {
  std::optional<TcpAddress> address = TcpAddress::parse(config.address, config.port);
  if (!address) {
    return tl::unexpected(hal::InitError{"NMEA over TCP: cannot listen on address \"" + config.address +
                                         "\" port " + std::to_string(config.port) +
                                         "; give an IPv4 or IPv6 address in numbers (127.0.0.1, 0.0.0.0, "
                                         "::1, ::) and a port from 1 to 65535"});
  }
  if (config.clients_max == 0) {
    return tl::unexpected(hal::InitError{"NMEA over TCP: clients_max 0; allowed are 1 to 64"});
  }
  return std::unique_ptr<NmeaTcpServer>(new NmeaTcpServer(std::move(*address), config.clients_max));
}

NmeaTcpServer::NmeaTcpServer(TcpAddress address, std::size_t clients_max)
    : listener_(std::move(address), "NMEA TCP port"), clients_(clients_max), counters_(kNames) {
}

void NmeaTcpServer::step(hal::Stamp now) noexcept {
  now_ = now;
  const std::uint64_t failures = listener_.failures();
  counters_.count(NmeaTcpEvent::Opened, listener_.service(now) ? 1 : 0);
  counters_.count(NmeaTcpEvent::OpenFailed, listener_.failures() - failures);
  for (TcpClient& client : clients_) {
    if (client.is_open()) {
      look_after(client);
    }
  }
  for (int i = 0; i < kAcceptsMax; ++i) {
    const Accepted accepted = listener_.accept(now);
    if (accepted.status == AcceptStatus::None) {
      break;
    }
    if (accepted.status == AcceptStatus::Client) {
      take_in(accepted.fd);
    } else {
      counters_.count(NmeaTcpEvent::AcceptFailed);
    }
  }
}

void NmeaTcpServer::take_in(int fd) noexcept {
  TcpClient* const place = free_place();
  if (place == nullptr) {
    ::close(fd);
    counters_.count(NmeaTcpEvent::Refused);
    return;
  }
  if (place->is_open()) {
    let_go(*place, NmeaTcpEvent::Displaced);
  }
  place->open(fd, now_);
  counters_.count(NmeaTcpEvent::Accepted);
}

/// A closed place, else one whose client has probably left; null when there is neither.
TcpClient* NmeaTcpServer::free_place() noexcept {
  auto place =
      std::find_if(clients_.begin(), clients_.end(), [](const TcpClient& c) { return !c.is_open(); });
  if (place == clients_.end()) {
    place = std::find_if(clients_.begin(), clients_.end(), [](const TcpClient& c) { return c.has_hushed(); });
  }
  return place == clients_.end() ? nullptr : &*place;
}

void NmeaTcpServer::look_after(TcpClient& client) noexcept {
  std::uint64_t ignored = 0;
  const ClientStatus heard = client.drain(ignored);
  counters_.count(NmeaTcpEvent::Ignored, ignored);
  if (heard == ClientStatus::Gone || client.flush(now_) == ClientStatus::Gone) {
    let_go(client, NmeaTcpEvent::Left);
  } else if (client.stuck_for(now_) > kStuckMax) {
    let_go(client, NmeaTcpEvent::Stuck);
  }
}

void NmeaTcpServer::let_go(TcpClient& client, NmeaTcpEvent why) noexcept {
  client.close();
  counters_.count(why);
}

void NmeaTcpServer::send(std::span<const char> epoch, const OutputTime& now) noexcept {
  for (TcpClient& client : clients_) {
    if (!client.is_open()) {
      continue;
    }
    switch (client.send(epoch, now.monotonic)) {
      case ClientStatus::Ok:
        counters_.count(NmeaTcpEvent::Epochs);
        counters_.count(NmeaTcpEvent::Bytes, epoch.size());
        break;
      case ClientStatus::Full:
        counters_.count(NmeaTcpEvent::Dropped);
        break;
      case ClientStatus::Gone:
        let_go(client, NmeaTcpEvent::Left);
        break;
    }
  }
}

std::size_t NmeaTcpServer::poll_on(std::span<pollfd> into) const noexcept {
  std::size_t count = 0;
  const auto add = [&](const pollfd& entry) {
    if (entry.fd >= 0 && count < into.size()) {
      into[count++] = entry;
    }
  };
  add({listener_.poll_fd(now_), POLLIN, 0});
  for (const TcpClient& client : clients_) {
    add(client.poll_on());
  }
  return count;
}

std::size_t NmeaTcpServer::clients() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(clients_.begin(), clients_.end(), [](const TcpClient& c) { return c.is_open(); }));
}

}  // namespace slamsensor::firmware
