#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/config/setting.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

/// Where in which file a value or a mistake stands. Lines and columns count from 1; 0 means the file as a
/// whole, or a layer that has no lines. An empty file name is the built-in default.
struct Origin {
  std::string file;
  std::uint32_t line = 0;
  std::uint32_t column = 0;

  [[nodiscard]] bool is_default() const { return file.empty(); }
  /// "default", "f.toml:12", "control socket" for listings.
  [[nodiscard]] std::string short_text() const;
  friend bool operator==(const Origin&, const Origin&) = default;
};

/// One reason why a configuration is refused, or a remark on one that is accepted.
struct ConfigError {
  Origin place;
  std::string key;          ///< full path; empty when the file itself is at fault
  std::string message;      ///< the value seen, what is allowed, what to do
  bool is_unknown = false;  ///< there is no such key or section in this version

  /// "file:line:column: key: message", without the parts that are not known.
  [[nodiscard]] std::string text() const;
};

/// `text` as it can stand in a message of one line: cut after `size_max` bytes at most, and without control
/// characters.
[[nodiscard]] std::string printable(std::string_view text, std::size_t size_max = 64);

/// Puts `more` behind `errors`.
void append(std::vector<ConfigError>& errors, std::vector<ConfigError> more);

/// One line per error, each ended by a newline.
[[nodiscard]] std::string error_lines(const std::vector<ConfigError>& errors);

/// A configuration in force, and who set each key of settings() (same order). Starts as the built-in
/// defaults.
struct LoadedConfig {
  Config config;
  std::vector<Origin> origins = std::vector<Origin>(settings().size());
  std::vector<ConfigError> warnings{};  ///< a line for each retired setting that was written

  /// Who set the key `path` of the registry; the default for a path that is no key.
  [[nodiscard]] const Origin& origin(std::string_view path) const;
};

/// Reports every mistake of a layer, but at most this many and then one that says so.
inline constexpr std::size_t kConfigErrorsMax = 100;

/// Lays the keys of the TOML document `text` over `onto`, and notes `name` and line as their origin. Returns
/// every mistake in the order of the lines: syntax, unknown section or key, wrong type, not finite, out of
/// range, incomplete optional section. A key that is at fault keeps its former value; all others are in
/// force. A retired setting is no mistake: it is put into the warnings of `onto`. Does not compare keys with
/// each other: check_config does, once all layers are on.
[[nodiscard]] std::vector<ConfigError> apply_layer(LoadedConfig& onto, std::string_view text,
                                                   std::string_view name);

/// The line of `text` where tables are nested deeper than any setting, a key of more than 64 parts; nothing
/// when none is. The parser would take such a text by recursion, until the stack ends: it must not see it.
[[nodiscard]] std::optional<std::uint32_t> too_deep_line(std::string_view text);

/// What is wrong with `text` as TOML, in a line; empty when nothing is.
[[nodiscard]] std::string syntax_fault(std::string_view text);

/// Every rule that two or more keys break together, each at the place of one of them. Rules about a key that
/// `known` already names are left out: its value in force is not the one that was written.
[[nodiscard]] std::vector<ConfigError> check_config(const LoadedConfig& loaded,
                                                    const std::vector<ConfigError>& known = {});

/// The defaults with `text` laid over them, if there is no mistake in it; else all mistakes. `name` stands
/// for the file in messages.
[[nodiscard]] tl::expected<LoadedConfig, std::vector<ConfigError>> load_config_text(std::string_view text,
                                                                                    std::string_view name);

/// The drop-ins of the file `path`: the files *.toml of the folder that is called as the file with ".d"
/// behind it, in the order of their names; none when there is no such folder.
[[nodiscard]] tl::expected<std::vector<std::filesystem::path>, ConfigError> drop_in_files(
    const std::filesystem::path& path);

/// Lays the file `path` over `onto`, and over that its drop-ins. Each has at most 1 MiB. Returns every
/// mistake of all of them, as apply_layer does; a file with a mistake does not keep the others from being
/// read.
[[nodiscard]] std::vector<ConfigError> apply_files(LoadedConfig& onto, const std::filesystem::path& path);

/// The defaults with a file and its drop-in folder laid over them, if there is no mistake in any; else all
/// mistakes.
[[nodiscard]] tl::expected<LoadedConfig, std::vector<ConfigError>> load_config(
    const std::filesystem::path& path);

/// One key with its value, as a person wrote it: TOML, but a text needs no quotes and a list no brackets.
struct Assignment {
  std::string key;
  std::string value;

  friend bool operator==(const Assignment&, const Assignment&) = default;
};

/// "a.b=c" as an assignment; what is wrong with it when there is no equals sign or no key.
[[nodiscard]] tl::expected<Assignment, std::string> parse_assignment(std::string_view text);

/// Lays the assignments over `onto` as one layer called `name`, which has no lines; of two with the same key
/// the later one counts. Returns every mistake, as apply_layer does.
[[nodiscard]] std::vector<ConfigError> apply_assignments(LoadedConfig& onto,
                                                         const std::vector<Assignment>& assignments,
                                                         std::string_view name);

}  // namespace slamsensor::firmware
