#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// A name in its digits and what stands between them: words[0] runs[0] words[1] ... words[n].
struct NameParts {
  std::vector<std::string> words;
  std::vector<std::string> runs;
};

[[nodiscard]] NameParts parts_of(const std::filesystem::path& file);

/// Seconds and the digits of their fraction, as a name gives them.
struct NameStamp {
  std::string seconds;
  std::string fraction;
  bool is_count = false;  ///< the fraction counts nanoseconds: SECONDS_NANOSECONDS
  bool is_sure = true;    ///< else what follows the seconds may be any number; a sure stamp beside it decides
};

/// The one stamp in a name: SECONDS.FRACTION or SECONDS_NANOSECONDS since 1970, or a count of milliseconds,
/// microseconds or nanoseconds; nothing when there is none or more than one.
[[nodiscard]] std::optional<NameStamp> stamp_of(const NameParts& parts);

/// How the digits behind the point are meant.
enum class StampFraction : std::uint8_t { Decimal, UnpaddedNanoseconds };

/// Recorders that print seconds and nanoseconds as two whole numbers leave out leading zeros; others leave
/// out trailing ones. Fractions of one length are decimal.
[[nodiscard]] StampFraction fraction_kind(const std::vector<NameStamp>& stamps);

[[nodiscard]] std::chrono::nanoseconds time_of(const NameStamp& stamp, StampFraction kind);

/// "1600000001.050000000"
[[nodiscard]] std::string shown_time(std::chrono::nanoseconds time);

}  // namespace slamsensor::tools
