#pragma once

#include <cstdlib>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <optional>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

namespace slamsensor::tests {

/// Runs `ip link` with `arguments`, as root.
inline void ip_link(const std::string& arguments) {
  const std::string command = "ip link " + arguments;
  if (std::system(command.c_str()) != 0) {
    throw std::runtime_error("failed: " + command);
  }
}

/// The other node of the bus: a socket that shares no code with hal's.
class RawCan {
 public:
  explicit RawCan(const std::string& interface) {
    constexpr int kOn = 1;
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    if (fd_ < 0 || address.can_ifindex == 0 ||
        ::setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &kOn, sizeof kOn) != 0 ||
        ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("no raw socket on " + interface);
    }
  }
  RawCan(const RawCan&) = delete;
  RawCan& operator=(const RawCan&) = delete;
  ~RawCan() { ::close(fd_); }

  /// The first attempt may report that the interface was down in the meantime.
  template <typename Frame>
  void send(const Frame& frame) {
    constexpr auto kWhole = static_cast<ssize_t>(sizeof frame);
    if (::write(fd_, &frame, sizeof frame) != kWhole && ::write(fd_, &frame, sizeof frame) != kWhole) {
      throw std::runtime_error("the bus does not take the frame");
    }
  }

  /// The oldest classical frame that waits; errors of an interface that was down are passed over.
  [[nodiscard]] std::optional<can_frame> receive() {
    can_frame frame{};
    for (int i = 0; i < 3; ++i) {
      if (::read(fd_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame)) {
        return frame;
      }
    }
    return std::nullopt;
  }

 private:
  int fd_ = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
};

}  // namespace slamsensor::tests
