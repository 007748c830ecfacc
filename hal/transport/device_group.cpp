#include "hal/transport/device_group.hpp"

#include <array>
#include <charconv>
#include <fcntl.h>
#include <string_view>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

namespace slamsensor::hal {
namespace {

/// Fills `text` as far as the file goes.
std::string_view read_start(const char* path, std::array<char, 8192>& text) noexcept {
  const int fd = ::open(path, O_RDONLY | O_CLOEXEC);
  std::size_t size = 0;
  for (ssize_t count = 1; fd >= 0 && count > 0 && size < text.size();
       size += static_cast<std::size_t>(count)) {
    count = ::read(fd, text.data() + size, text.size() - size);
    count = count < 0 ? 0 : count;
  }
  if (fd >= 0) {
    ::close(fd);
  }
  return {text.data(), size};
}

/// The name in a line "188 ttyUSB", when its number is `major`.
std::string_view name_in(std::string_view line, unsigned major) noexcept {
  const std::size_t begin = line.find_first_not_of(' ');
  line.remove_prefix(begin == std::string_view::npos ? line.size() : begin);
  unsigned number = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  const auto digits = static_cast<std::size_t>(end - line.data());
  return error == std::errc() && number == major && digits < line.size() ? line.substr(digits + 1)
                                                                         : std::string_view();
}

}  // namespace

DeviceGroup device_group(const char* path) noexcept {
  struct stat status {};
  if (::stat(path, &status) != 0 || !S_ISCHR(status.st_mode)) {
    return {};
  }
  std::array<char, 8192> text{};
  std::string_view rest = read_start("/proc/devices", text);
  rest = rest.substr(0, rest.find("Block devices"));
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    if (const std::string_view name = name_in(rest.substr(0, end), major(status.st_rdev)); !name.empty()) {
      return DeviceGroup(name);
    }
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  }
  return {};
}

}  // namespace slamsensor::hal
