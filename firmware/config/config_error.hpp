#pragma once

#include <cstddef>
#include <cstdint>
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

/// One reason why a configuration is refused.
struct ConfigError {
  Origin place;
  std::string key;      ///< full path; empty when the file itself is at fault
  std::string message;  ///< the value seen, what is allowed, what to do

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

}  // namespace slamsensor::firmware
