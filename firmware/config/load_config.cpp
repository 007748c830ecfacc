#include "firmware/config/load_config.hpp"

#include "firmware/supervision/file_descriptor.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <iterator>
#include <optional>
#include <sys/stat.h>
#include <system_error>
#include <type_traits>
#include <utility>
#include <variant>

namespace slamsensor::firmware {

std::string Origin::short_text() const {
  if (is_default()) {
    return "default";
  }
  return line == 0 ? file : file + ':' + std::to_string(line);
}

std::string ConfigError::text() const {
  std::string line = place.is_default() ? "configuration" : place.file;
  if (place.line != 0) {
    line += ':' + std::to_string(place.line) + ':' + std::to_string(place.column);
  }
  return line + ": " + (key.empty() ? "" : key + ": ") + message;
}

std::string printable(std::string_view text, std::size_t size_max) {
  std::size_t size = std::min(text.size(), size_max);
  while (size < text.size() && size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) {
    --size;  // not within a character of UTF-8
  }
  std::string shown(text.substr(0, size));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; },
      '?');
  return text.size() > size ? shown + "..." : shown;
}

void append(std::vector<ConfigError>& errors, std::vector<ConfigError> more) {
  errors.insert(errors.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::string error_lines(const std::vector<ConfigError>& errors) {
  std::string lines;
  for (const ConfigError& error : errors) {
    lines += error.text() + '\n';
  }
  return lines;
}

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

/// `loaded` when neither its layers nor the rules between keys had a mistake.
tl::expected<LoadedConfig, std::vector<ConfigError>> checked(const LoadedConfig& loaded,
                                                             std::vector<ConfigError> errors) {
  append(errors, check_config(loaded, errors));
  if (!errors.empty()) {
    return tl::unexpected(std::move(errors));
  }
  return loaded;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

bool is_quoted(std::string_view value) {
  return value.starts_with('"') || value.starts_with('\'');
}

std::string text_value(std::string_view value) {
  return is_quoted(value) ? std::string(value) : quoted_text(value);
}

/// "RMC, GGA" as ["RMC", "GGA"].
std::string text_list_value(std::string_view value) {
  if (value.starts_with('[')) {
    return std::string(value);
  }
  std::string list = "[";
  while (!trimmed(value).empty()) {
    const std::size_t comma = std::min(value.find(','), value.size());
    list += (list.size() == 1 ? "" : ", ") + text_value(trimmed(value.substr(0, comma)));
    value.remove_prefix(std::min(comma + 1, value.size()));
  }
  return list + ']';
}

/// A word by which nothing but a text can be meant.
bool is_bare_word(std::string_view value) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
  return !value.empty() && value != "true" && value != "false" && value != "inf" && value != "nan" &&
         value.find_first_not_of(kLetters) == std::string_view::npos;
}

/// The value as TOML writes it for the kind of `setting`.
std::string toml_value(const Setting& setting, std::string_view value) {
  return std::visit(
      [&](const auto& kind) -> std::string {
        using Kind = std::remove_cvref_t<decltype(kind)>;
        if constexpr (std::is_same_v<Kind, TextListSetting>) {
          return text_list_value(value);
        } else if constexpr (std::is_same_v<Kind, IntegerListSetting>) {
          return value.starts_with('[') ? std::string(value) : '[' + std::string(value) + ']';
        } else if constexpr (std::is_same_v<Kind, FreeTextSetting>) {
          return text_value(value);
        } else {
          return is_bare_word(value) ? quoted_text(value) : std::string(value);
        }
      },
      setting.kind);
}

/// What keeps the assignment from being one line of TOML, or nothing.
std::string_view line_fault(const Assignment& assignment) {
  constexpr std::string_view kKeyCharacters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
  if (assignment.key.empty() || assignment.key.find_first_not_of(kKeyCharacters) != std::string::npos) {
    return "is no key; a key is written as section.key";
  }
  if (assignment.value.find_first_of("\r\n") != std::string::npos) {
    return "has a value of more than one line; write line ends as \\n in quotes";
  }
  return {};
}

/// Makes the places in the layer `name` such as have no lines.
void forget_lines(LoadedConfig& loaded, std::vector<ConfigError>& errors, std::string_view name) {
  for (Origin& origin : loaded.origins) {
    if (origin.file == name) {
      origin.line = origin.column = 0;
    }
  }
  for (ConfigError& error : errors) {
    error.place.line = error.place.column = 0;
  }
  for (ConfigError& warning : loaded.warnings) {
    if (warning.place.file == name) {
      warning.place.line = warning.place.column = 0;
    }
  }
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

tl::expected<std::vector<std::filesystem::path>, ConfigError> drop_in_files(
    const std::filesystem::path& path) {
  const std::filesystem::path folder = path.string() + ".d";
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

std::vector<ConfigError> apply_files(LoadedConfig& onto, const std::filesystem::path& path) {
  std::vector<ConfigError> errors = apply_file(onto, path);
  const auto drop_ins = drop_in_files(path);
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

tl::expected<Assignment, std::string> parse_assignment(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos || trimmed(text.substr(0, equals)).empty()) {
    return tl::unexpected<std::string>("no key and value; write KEY=VALUE, for example nmea.rate_hz=5");
  }
  return Assignment{std::string(trimmed(text.substr(0, equals))),
                    std::string(trimmed(text.substr(equals + 1)))};
}

std::vector<ConfigError> apply_assignments(LoadedConfig& onto, const std::vector<Assignment>& assignments,
                                           std::string_view name) {
  std::vector<ConfigError> errors;
  std::string document;
  for (auto one = assignments.begin(); one != assignments.end(); ++one) {
    if (std::any_of(one + 1, assignments.end(), [&](const Assignment& a) { return a.key == one->key; })) {
      continue;
    }
    if (const std::string_view fault = line_fault(*one); !fault.empty()) {
      errors.push_back({{std::string(name), 0, 0}, printable(one->key), std::string(fault)});
      continue;
    }
    const std::optional<std::size_t> index = find_setting(one->key);
    const std::string line = one->key + " = " +
                             (index ? toml_value(settings()[*index], one->value) : text_value(one->value)) +
                             '\n';
    // Alone first: one that is no TOML must not hide the others.
    if (const std::string fault = syntax_fault(line); !fault.empty()) {
      errors.push_back({{std::string(name), 0, 0},
                        one->key,
                        "value " + printable(one->value) + " is not TOML: " + fault +
                            (index ? "; allowed: " + allowed_text(settings()[*index]) : "")});
    } else {
      document += line;
    }
  }
  append(errors, apply_layer(onto, document, name));
  forget_lines(onto, errors, name);
  return errors;
}

}  // namespace slamsensor::firmware
