#pragma once

#include <optional>
#include <string_view>
#include <sys/socket.h>
#include <sys/un.h>

namespace slamsensor::firmware {

/// Longest path of a local socket that the kernel takes (unix(7)).
inline constexpr std::size_t kUnixPathMax = sizeof(sockaddr_un::sun_path) - 1;

/// The address of a local socket, and how many of its bytes count.
struct UnixAddress {
  sockaddr_un bytes{};
  socklen_t size = 0;

  [[nodiscard]] const sockaddr* get() const noexcept { return reinterpret_cast<const sockaddr*>(&bytes); }
};

/// The address of `name`: a path, or with a leading '@' a name of Linux' abstract space. None when it is
/// empty, longer than kUnixPathMax or holds a zero.
[[nodiscard]] std::optional<UnixAddress> unix_address(std::string_view name) noexcept;

}  // namespace slamsensor::firmware
