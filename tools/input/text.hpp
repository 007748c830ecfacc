#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::tools {

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
