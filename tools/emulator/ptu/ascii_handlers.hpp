#pragma once

#include "tools/emulator/ptu/ascii_command.hpp"

#include <string_view>

namespace slamsensor::tools {

/// A command on its way through a handler, with the ways to answer it.
struct AsciiCall {
  PtuUnit& unit;
  const AsciiCommand& command;
  Stamp now;

  [[nodiscard]] PtuAnswer ok() const;
  [[nodiscard]] PtuAnswer text(std::string_view words) const;
  [[nodiscard]] PtuAnswer text(std::string_view words, std::string_view terse) const;
  [[nodiscard]] PtuAnswer error(std::string_view words) const;
  [[nodiscard]] PtuAnswer illegal() const;
  [[nodiscard]] PtuAnswer judged(const PtuVerdict& verdict) const;
};

using AsciiHandler = PtuAnswer (*)(const AsciiCall&);

struct AsciiEntry {
  std::string_view letters;
  AsciiHandler handler;
  PtuSeries since = PtuSeries::Dp;  ///< E: not on a D46
};

/// The handler of the command with exactly these letters; nullptr when `series` has none.
[[nodiscard]] AsciiHandler find_handler(std::string_view letters, PtuSeries series);

// The handlers of commands of one axis; those of tilt have the same letters after a T.
[[nodiscard]] AsciiHandler find_axis_handler(std::string_view letters, PtuSeries series);

// Commands of the unit as a whole: modes and motion; memory, network and ports.
[[nodiscard]] AsciiHandler find_mode_handler(std::string_view letters, PtuSeries series);
[[nodiscard]] AsciiHandler find_unit_handler(std::string_view letters, PtuSeries series);

/// The entry for `letters` in `table`, nullptr when there is none for `series`.
template <typename Table>
[[nodiscard]] AsciiHandler find_in(const Table& table, std::string_view letters, PtuSeries series) {
  for (const AsciiEntry& entry : table) {
    if (entry.letters == letters && (entry.since == PtuSeries::Dp || series == PtuSeries::E)) {
      return entry.handler;
    }
  }
  return nullptr;
}

}  // namespace slamsensor::tools
