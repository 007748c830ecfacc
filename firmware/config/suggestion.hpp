#pragma once

#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// The number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b` (optimal
/// string alignment). Quadratic: for short words.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The section, or the key ("section.key"), that was probably meant by the unknown `path`, whether written in
/// capitals or not: "a" or, when some are as near as each other, "a, b or c"; empty when nothing or too much
/// is near.
[[nodiscard]] std::string suggest_section(std::string_view path);
[[nodiscard]] std::string suggest_key(std::string_view path);

}  // namespace slamsensor::firmware
