#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

namespace slamsensor::firmware {

/// An open file, closed at the end of its life.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  /// Takes over `fd`; a negative one is none.
  explicit FileDescriptor(int fd) noexcept : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    if (this != &other) {
      reset();
      fd_ = std::exchange(other.fd_, -1);
    }
    return *this;
  }
  ~FileDescriptor() { reset(); }

  [[nodiscard]] int get() const noexcept { return fd_; }
  [[nodiscard]] explicit operator bool() const noexcept { return fd_ >= 0; }

  void reset() noexcept {
    if (fd_ >= 0) {
      ::close(std::exchange(fd_, -1));
    }
  }

 private:
  int fd_ = -1;
};

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
[[nodiscard]] inline std::optional<UnixAddress> unix_address(std::string_view name) noexcept {
  if (name.empty() || name == "@" || name.size() > kUnixPathMax || name.find('\0') != name.npos) {
    return std::nullopt;
  }
  UnixAddress address;
  address.bytes.sun_family = AF_UNIX;
  std::copy(name.begin(), name.end(), address.bytes.sun_path);
  const bool is_abstract = name.front() == '@';
  if (is_abstract) {
    address.bytes.sun_path[0] = '\0';
  }
  // An abstract name ends where the size says, a path with its zero.
  address.size =
      static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size() + (is_abstract ? 0 : 1));
  return address;
}

}  // namespace slamsensor::firmware
