#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <sys/socket.h>

namespace slamsensor::firmware {

/// A numeric IPv4 or IPv6 address with a port, to listen on.
class TcpAddress {
 public:
  /// As the kernel takes it.
  struct Raw {
    sockaddr_storage storage{};
    socklen_t size = 0;
  };

  /// "127.0.0.1", "0.0.0.0", "::1", "::" or "fe80::1%eth0"; none when `address` is no such thing or `port` is
  /// not within 1 .. 65535 (0: any free port).
  [[nodiscard]] static std::optional<TcpAddress> parse(const std::string& address, std::uint32_t port);

  /// For bind(). The interface that an address names is looked up now: it may come later than the program.
  /// None while there is no such interface. Allocates nothing.
  [[nodiscard]] std::optional<Raw> raw() const noexcept;

  /// "127.0.0.1:10110", "[::1]:10110".
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  TcpAddress() = default;

  Raw raw_;
  std::string interface_;
  std::string text_;
};

}  // namespace slamsensor::firmware
