#include "tools/spy/lcm_receiver.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

namespace slamsensor::tools {
namespace {

// Enough for a large map at once; the system grants as much of it as net.core.rmem_max allows.
constexpr int kReceiveBytes = 4 << 20;

template <typename T>
bool set_option(int fd, int level, int name, const T& value) {
  return ::setsockopt(fd, level, name, &value, sizeof value) == 0;
}

tl::unexpected<std::string> cannot(const firmware::LcmUrl& url, const char* what, int error) {
  std::string message = std::string("cannot ") + what + " " + url.text + ": " + std::strerror(error);
  if (error == ENODEV || error == ENETUNREACH) {
    message += "; no route for multicast, add one with: ip route add 224.0.0.0/4 dev IFACE";
  }
  return tl::unexpected(std::move(message));
}

}  // namespace

tl::expected<LcmReceiver, std::string> LcmReceiver::open(const firmware::LcmUrl& url) {
  if (url.transport != firmware::LcmTransport::Multicast) {
    return tl::unexpected(url.text + " has nothing to listen to: give a URL like udpm://239.255.76.67:7667");
  }
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) {
    return cannot(url, "open a socket for", errno);
  }
  LcmReceiver receiver(fd);
  set_option(fd, SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
  // Bound to the group, not to any address, so that nothing but the group is heard.
  const bool shared =
      set_option(fd, SOL_SOCKET, SO_REUSEADDR, 1) && set_option(fd, SOL_SOCKET, SO_REUSEPORT, 1);
  if (!shared || ::bind(fd, reinterpret_cast<const sockaddr*>(&url.group), sizeof url.group) != 0) {
    return cannot(url, "listen to", errno);
  }
  const ip_mreq membership{url.group.sin_addr, {htonl(INADDR_ANY)}};
  if (!set_option(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership)) {
    return cannot(url, "join the group of", errno);
  }
  return receiver;
}

LcmReceiver::LcmReceiver(LcmReceiver&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      datagram_(std::move(other.datagram_)),
      reassembler_(std::move(other.reassembler_)),
      refused_(other.refused_) {
}

LcmReceiver::~LcmReceiver() {
  if (fd_ >= 0) {
    ::close(fd_);
  }
}

std::optional<LcmMessageView> LcmReceiver::next() {
  while (true) {
    sockaddr_in sender{};
    socklen_t length = sizeof sender;
    const ssize_t size = ::recvfrom(fd_, datagram_->data(), datagram_->size(), 0,
                                    reinterpret_cast<sockaddr*>(&sender), &length);
    if (size < 0) {
      return std::nullopt;
    }
    const auto packet = parse_lcm_packet({datagram_->data(), static_cast<std::size_t>(size)});
    if (!packet) {
      ++refused_;
      continue;
    }
    const std::uint64_t from = (std::uint64_t{sender.sin_addr.s_addr} << 16U) | sender.sin_port;
    if (const auto message = reassembler_.push(from, *packet)) {
      return message;
    }
  }
}

}  // namespace slamsensor::tools
