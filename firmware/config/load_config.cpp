#include "firmware/config/load_config.hpp"

#include "firmware/supervision/file_descriptor.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <sys/stat.h>
#include <system_error>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr std::size_t kFileBytesMax = std::size_t{1} << 20;

tl::unexpected<std::string> failure(const char* what, const char* advice) {
  return tl::unexpected(what + (": " + std::string(std::strerror(errno))) + advice);
}

/// Why a file of this kind is not read; empty when it is. A pipe, socket or terminal may have to be waited
/// for.
std::string refused_kind(mode_t mode) {
  if (S_ISDIR(mode)) {
    return "is a folder; name the file in it";
  }
  return S_ISREG(mode) || S_ISCHR(mode) ? "" : "is a pipe or a socket; name a regular file";
}

/// The whole file, or why not. Never waits.
tl::expected<std::string, std::string> file_text(const std::filesystem::path& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  struct stat status {};
  if (!file || ::fstat(file.get(), &status) != 0) {
    return failure("cannot be opened", "; check the name and the permissions");
  }
  if (std::string refused = refused_kind(status.st_mode); !refused.empty()) {
    return tl::unexpected(std::move(refused));
  }
  std::string text(kFileBytesMax + 1, '\0');
  std::size_t filled = 0;
  while (filled < text.size()) {
    const ssize_t count = ::read(file.get(), text.data() + filled, text.size() - filled);
    if (count < 0 && errno != EINTR) {
      return failure("cannot be read", "");
    }
    if (count == 0) {
      break;
    }
    filled += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  text.resize(filled);
  if (text.size() > kFileBytesMax) {
    return tl::unexpected<std::string>("is larger than 1 MiB; this is not a configuration file");
  }
  return text;
}

ConfigError file_error(const std::filesystem::path& path, std::string message) {
  return {{path.string(), 0, 0}, "", std::move(message)};
}

std::vector<ConfigError> apply_file(LoadedConfig& onto, const std::filesystem::path& path) {
  const tl::expected<std::string, std::string> text = file_text(path);
  if (!text) {
    return {file_error(path, text.error())};
  }
  return apply_layer(onto, *text, path.string());
}

/// The files *.toml of `folder` in the order of their names; none when there is no such folder.
tl::expected<std::vector<std::filesystem::path>, ConfigError> drop_in_files(
    const std::filesystem::path& folder) {
  constexpr std::size_t kFilesMax = 100;
  std::vector<std::filesystem::path> files;
  std::error_code code;
  if (!std::filesystem::exists(std::filesystem::symlink_status(folder, code))) {
    return files;
  }
  std::filesystem::directory_iterator entry(folder, code);
  for (; !code && entry != std::filesystem::directory_iterator(); entry.increment(code)) {
    if (entry->path().extension() == ".toml") {
      files.push_back(entry->path());
    }
  }
  if (code) {
    return tl::unexpected(file_error(
        folder, "the drop-in folder cannot be read: " + code.message() + "; check its permissions"));
  }
  if (files.size() > kFilesMax) {
    return tl::unexpected(file_error(folder, "has " + std::to_string(files.size()) +
                                                 " files *.toml; at most " + std::to_string(kFilesMax) +
                                                 " are read; join some"));
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// `loaded` when neither its layers nor the rules between keys had a mistake.
tl::expected<LoadedConfig, std::vector<ConfigError>> checked(const LoadedConfig& loaded,
                                                             std::vector<ConfigError> errors) {
  append(errors, check_config(loaded, errors));
  if (!errors.empty()) {
    return tl::unexpected(std::move(errors));
  }
  return loaded;
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
  return checked(loaded, apply_layer(loaded, text, name));
}

std::vector<ConfigError> apply_files(LoadedConfig& onto, const std::filesystem::path& path) {
  std::vector<ConfigError> errors = apply_file(onto, path);
  const auto drop_ins = drop_in_files(path.string() + ".d");
  if (!drop_ins) {
    errors.push_back(drop_ins.error());
    return errors;
  }
  for (const std::filesystem::path& file : *drop_ins) {
    append(errors, apply_file(onto, file));
  }
  return errors;
}

tl::expected<LoadedConfig, std::vector<ConfigError>> load_config(const std::filesystem::path& path) {
  LoadedConfig loaded;
  return checked(loaded, apply_files(loaded, path));
}

}  // namespace slamsensor::firmware
