#pragma once

#include <tl/expected.hpp>

#include <charconv>
#include <concepts>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace slamsensor::tools {

/// `value` with exactly `decimals` digits (0..17) after the point is appended, whatever the locale; a value
/// that rounds to zero carries no sign.
void append_fixed(std::string& out, double value, int decimals);

/// The shortest decimal text that reads back as `value` is appended, never with an exponent: 7 is "7".
void append_shortest(std::string& out, double value);

/// `value` with at most `digits` significant digits (1..17) is appended, with an exponent where that is
/// shorter.
void append_general(std::string& out, double value, int digits);

/// `value` is appended in decimal.
template <std::integral T>
void append_integer(std::string& out, T value) {
  char text[24];
  out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

/// As `append_fixed`, to a string of its own.
[[nodiscard]] std::string fixed_text(double value, int decimals);

/// Why an output could not be written: path, the system's reason and what to do, in one line.
struct OutputError {
  std::string message;
};

/// An error when one of `outputs` is another of them or one of `inputs`, by whatever name or link, or a map
/// of the sensor, which neither a text nor a recording may replace. Empty paths stand for what was not asked
/// for.
[[nodiscard]] tl::expected<void, OutputError> check_outputs(std::span<const std::filesystem::path> outputs,
                                                            std::span<const std::filesystem::path> inputs);

/// `path` holds exactly `bytes`, on the disk, or still holds what it held before and an error is returned:
/// the bytes go to a new file in the same folder, which takes the name only when all of it is written and
/// closed without error. A map of the sensor is replaced by a map alone, and nothing else takes the name of
/// one (NAME.slammap). A symbolic link is followed. A path that is no regular file (a pipe, a device) is
/// written to directly.
[[nodiscard]] tl::expected<void, OutputError> write_file(const std::filesystem::path& path,
                                                         std::string_view bytes);

}  // namespace slamsensor::tools
