#pragma once

#include <tl/expected.hpp>

#include <cstddef>
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

}  // namespace slamsensor::tools
