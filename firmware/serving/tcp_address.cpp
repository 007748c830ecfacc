#include "firmware/serving/tcp_address.hpp"

#include <arpa/inet.h>
#include <cstring>
#include <net/if.h>
#include <netinet/in.h>

namespace slamsensor::firmware {
namespace {

constexpr std::uint32_t kPortMax = 65535;

template <typename Address>
TcpAddress::Raw to_raw(const Address& address) noexcept {
  TcpAddress::Raw raw;
  std::memcpy(&raw.storage, &address, sizeof address);
  raw.size = sizeof address;
  return raw;
}

}  // namespace

std::optional<TcpAddress> TcpAddress::parse(const std::string& address, std::uint32_t port) {
  if (port > kPortMax) {
    return std::nullopt;
  }
  TcpAddress result;
  sockaddr_in v4{};
  if (::inet_pton(AF_INET, address.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(static_cast<std::uint16_t>(port));
    result.raw_ = to_raw(v4);
    result.text_ = address + ':' + std::to_string(port);
    return result;
  }
  const std::size_t percent = address.find('%');
  sockaddr_in6 v6{};
  if (::inet_pton(AF_INET6, address.substr(0, percent).c_str(), &v6.sin6_addr) != 1) {
    return std::nullopt;
  }
  if (percent != std::string::npos) {
    result.interface_ = address.substr(percent + 1);
    if (result.interface_.empty() || result.interface_.size() >= IFNAMSIZ) {
      return std::nullopt;
    }
  }
  v6.sin6_family = AF_INET6;
  v6.sin6_port = htons(static_cast<std::uint16_t>(port));
  result.raw_ = to_raw(v6);
  result.text_ = '[' + address + "]:" + std::to_string(port);
  return result;
}

std::optional<TcpAddress::Raw> TcpAddress::raw() const noexcept {
  if (interface_.empty()) {
    return raw_;
  }
  sockaddr_in6 v6{};
  std::memcpy(&v6, &raw_.storage, sizeof v6);
  v6.sin6_scope_id = ::if_nametoindex(interface_.c_str());
  if (v6.sin6_scope_id == 0) {
    return std::nullopt;
  }
  return to_raw(v6);
}

}  // namespace slamsensor::firmware
