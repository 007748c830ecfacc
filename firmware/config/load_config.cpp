#include "firmware/config/load_config.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr std::size_t kFileBytesMax = std::size_t{1} << 20;

/// The whole file, or why not.
tl::expected<std::string, std::string> file_text(const std::filesystem::path& path) {
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) {
    return tl::unexpected<std::string>("is a folder; name the file in it");
  }
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    return tl::unexpected("cannot be opened: " + std::string(std::strerror(errno)) +
                          "; check the name and the permissions");
  }
  std::string text(kFileBytesMax + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad()) {
    return tl::unexpected("cannot be read: " + std::string(std::strerror(errno)));
  }
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kFileBytesMax) {
    return tl::unexpected<std::string>("is larger than 1 MiB; this is not a configuration file");
  }
  return text;
}

}  // namespace

const Origin& LoadedConfig::origin(std::string_view path) const {
  static const Origin kDefault;
  const std::optional<std::size_t> index = find_setting(path);
  return index ? origins[*index] : kDefault;
}

tl::expected<LoadedConfig, std::vector<ConfigError>> load_config_text(std::string_view text,
                                                                      std::string_view name) {
  LoadedConfig loaded;
  std::vector<ConfigError> errors = apply_layer(loaded, text, name);
  for (ConfigError& error : check_config(loaded, errors)) {
    errors.push_back(std::move(error));
  }
  if (!errors.empty()) {
    return tl::unexpected(std::move(errors));
  }
  return loaded;
}

tl::expected<LoadedConfig, std::vector<ConfigError>> load_config(const std::filesystem::path& path) {
  const tl::expected<std::string, std::string> text = file_text(path);
  if (!text) {
    return tl::unexpected(std::vector<ConfigError>{{{path.string(), 0, 0}, "", text.error()}});
  }
  return load_config_text(*text, path.string());
}

}  // namespace slamsensor::firmware
