#include "firmware/supervision/file_descriptor.hpp"

#include <algorithm>
#include <cstddef>

namespace slamsensor::firmware {

std::optional<UnixAddress> unix_address(std::string_view name) noexcept {
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
