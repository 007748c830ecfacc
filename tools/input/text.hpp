#pragma once

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::tools {

/// Why an input was refused: what, where (file, line or byte) and what to do, in one line.
struct InputError {
  std::string message;
};

/// A refusal that says `what` about `name` as a whole: "NAME: WHAT".
[[nodiscard]] tl::unexpected<InputError> refuse(std::string_view name, std::string_view what);

/// A refusal that says `what` about one line (counted from 1): "NAME:LINE: WHAT".
[[nodiscard]] tl::unexpected<InputError> refuse_line(std::string_view name, std::size_t line,
                                                     std::string_view what);

/// An error when the file that begins with `start` is UTF-16, as spreadsheets and Windows write it on
/// request.
[[nodiscard]] tl::expected<void, InputError> check_encoding(std::string_view start, std::string_view name);

/// `text` as a message may show it: in quotes, control and non-ASCII bytes as '?', cut after 40 characters.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// `value` as a message shows it: up to six significant digits, no trailing zeros ("10000", "0.5").
[[nodiscard]] std::string shown(double value);

/// Larger files are refused before anything is allocated for them.
inline constexpr std::size_t kFileBytesMax = std::size_t{2} << 30;

/// The bytes of a regular file, at most the first `bytes_max`. An error when it does not exist, is not a
/// regular file, cannot be read, or (when asked for all of it) is larger than kFileBytesMax.
[[nodiscard]] tl::expected<std::string, InputError> read_file(const std::filesystem::path& path,
                                                              std::size_t bytes_max = kFileBytesMax);

/// The number that `text` is, all of it: decimal point whatever the locale, an exponent and a leading '+'
/// allowed. May be NaN or infinite when it is written so; nothing when it is not a number or does not fit a
/// double.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// The decimal integer that `text` is, all of it; nothing when it is not one or does not fit.
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view text);

/// `text` without spaces and tabs (and a carriage return) at both ends.
[[nodiscard]] std::string_view trim(std::string_view text);

/// Whether two texts are the same but for upper and lower case of ASCII.
[[nodiscard]] bool same_but_for_case(std::string_view a, std::string_view b);

/// Takes the first word off `rest` (words are parted by spaces and tabs); empty when there is none.
[[nodiscard]] std::string_view take_word(std::string_view& rest);

/// Walks the lines of a text that must outlive it. Passes over a byte order mark, blank lines and lines that
/// start with
/// '#'; both line ends are understood.
class LineReader {
 public:
  /// `first_line` is the number of the text's first line.
  explicit LineReader(std::string_view text, std::size_t first_line = 1);

  /// Moves on to the next line; false at the end of the text.
  [[nodiscard]] bool next();

  [[nodiscard]] std::string_view line() const { return line_; }              ///< trimmed, never empty
  [[nodiscard]] std::string_view whole_line() const { return whole_line_; }  ///< `line()` with its blanks
  [[nodiscard]] std::size_t number() const { return number_; }               ///< of `line()`
  [[nodiscard]] std::size_t consumed_bytes() const {
    return at_;
  }                                                    ///< of the text, up to the start of the next line
  [[nodiscard]] bool ended() const { return ended_; }  ///< `line()` had a line end

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t number_;
  std::string_view line_;
  std::string_view whole_line_;
  bool ended_ = false;
};

}  // namespace slamsensor::tools
