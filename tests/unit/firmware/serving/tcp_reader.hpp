#pragma once

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <netinet/in.h>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

namespace slamsensor::tests {

/// A client of a TCP port of this machine.
class TcpReader {
 public:
  enum class Family : std::uint8_t { V4, V6 };

  explicit TcpReader(std::uint16_t port, Family family = Family::V4, int receive_buffer = 0) {
    fd_ = ::socket(family == Family::V4 ? AF_INET : AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (receive_buffer > 0) {
      ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    }
    sockaddr_in v4{};
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port);
    v4.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    sockaddr_in6 v6{};
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(port);
    v6.sin6_addr = in6addr_loopback;
    const int result = family == Family::V4
                           ? ::connect(fd_, reinterpret_cast<const sockaddr*>(&v4), sizeof v4)
                           : ::connect(fd_, reinterpret_cast<const sockaddr*>(&v6), sizeof v6);
    if (fd_ < 0 || result != 0) {
      throw std::runtime_error(std::string("connect: ") + std::strerror(errno));
    }
  }
  TcpReader(const TcpReader&) = delete;
  TcpReader& operator=(const TcpReader&) = delete;
  ~TcpReader() { close(); }

  void close() {
    if (fd_ >= 0) {
      ::close(fd_);
      fd_ = -1;
    }
  }
  /// Closes with a reset, as a machine that has been restarted answers.
  void reset() {
    const linger at_once{1, 0};
    ::setsockopt(fd_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    close();
  }
  void hush() { ::shutdown(fd_, SHUT_WR); }
  void write(const std::string& text) {
    if (::send(fd_, text.data(), text.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(text.size())) {
      throw std::runtime_error("send");
    }
  }

  /// What has arrived; waits for the first byte for at most `patience_ms`.
  std::string read(int patience_ms = 2000) {
    std::string text;
    std::array<char, 65536> chunk{};
    pollfd state{fd_, POLLIN, 0};
    while (::poll(&state, 1, text.empty() ? patience_ms : 0) > 0) {
      const ssize_t count = ::recv(fd_, chunk.data(), chunk.size(), MSG_DONTWAIT);
      if (count <= 0) {
        is_closed_ = true;
        break;
      }
      text.append(chunk.data(), static_cast<std::size_t>(count));
    }
    return text;
  }
  /// Whether read() found the connection at its end.
  [[nodiscard]] bool is_closed() const { return is_closed_; }

 private:
  int fd_ = -1;
  bool is_closed_ = false;
};

}  // namespace slamsensor::tests
