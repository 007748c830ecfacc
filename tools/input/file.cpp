#include "tools/input/file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <system_error>

namespace slamsensor::tools {

tl::expected<std::string, InputError> read_file(const std::filesystem::path& path, std::size_t bytes_max) {
  const std::string name = path.string();
  std::error_code error;
  // A pipe or a terminal would block here, and a device may never end.
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    return refuse(name, "does not exist; check the path");
  }
  if (!std::filesystem::status_known(status)) {
    return refuse(name, "cannot be opened: " + error.message());
  }
  if (!std::filesystem::is_regular_file(status)) {
    return refuse(name, "is not a regular file; give the name of a file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) {
    return refuse(name, "its size cannot be read: " + error.message());
  }
  if (bytes_max >= kFileBytesMax && size > kFileBytesMax) {
    return refuse(name, "has " + std::to_string(size) + " bytes, at most " + std::to_string(kFileBytesMax) +
                            " are read; split it");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return refuse(name, std::string("cannot be opened: ") + std::strerror(errno));
  }
  std::string bytes(static_cast<std::size_t>(std::min<std::uintmax_t>(size, bytes_max)), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (file.bad()) {
    return refuse(name, std::string("cannot be read: ") + std::strerror(errno));
  }
  bytes.resize(static_cast<std::size_t>(file.gcount()));  // it may have been cut since its size was asked for
  return bytes;
}

}  // namespace slamsensor::tools
