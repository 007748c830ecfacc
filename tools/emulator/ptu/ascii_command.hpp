#pragma once

#include "tools/emulator/ptu/ptu_unit.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// A command as typed: its letters in capitals, and what follows them.
struct AsciiCommand {
  std::string letters;
  std::string argument;

  [[nodiscard]] bool is_query() const noexcept { return argument.empty(); }

  /// The argument as a signed decimal number of at most nine digits; nothing when it is none.
  [[nodiscard]] std::optional<long> number() const;

  /// As number(), for numbers with commas between them.
  [[nodiscard]] std::optional<std::vector<long>> numbers() const;
};

/// `text` has no delimiter in it and is not empty.
[[nodiscard]] AsciiCommand parse_ascii(std::string_view text);

/// Obeys `text` (PTU-D46 User's Manual 2.14, "Command reference"; E-Series Command Reference for that series)
/// and says what to answer.
[[nodiscard]] PtuAnswer obey_ascii(PtuUnit& unit, std::string_view text, Stamp now);

}  // namespace slamsensor::tools
