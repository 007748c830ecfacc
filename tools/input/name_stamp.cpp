#include "tools/input/name_stamp.hpp"

#include "tools/input/input_scan.hpp"
#include "tools/input/text.hpp"

#include <utility>

namespace slamsensor::tools {
namespace {

using std::chrono::nanoseconds;

constexpr std::size_t kSecondsDigitsMin = 9;  // of a time since 1970; fewer are a counter or a date
constexpr std::size_t kFractionDigits = 9;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// A run that counts milliseconds, microseconds or nanoseconds since 1970.
std::optional<NameStamp> whole_stamp(const std::string& run) {
  constexpr std::size_t kSecondsDigits = 10;  // from 2001 to 2286
  const bool is_stamp = run.size() == 13 || run.size() == 16 || run.size() == 19;
  if (!is_stamp || run.front() == '0') {
    return std::nullopt;
  }
  return NameStamp{run.substr(0, kSecondsDigits), run.substr(kSecondsDigits)};
}

// The stamp of which run i is the seconds and run i + 1 the fraction.
std::optional<NameStamp> parted_stamp(const NameParts& parts, std::size_t i) {
  if (i + 1 >= parts.runs.size() || parts.runs[i].size() < kSecondsDigitsMin ||
      parts.runs[i].size() > kSecondsDigitsMin + 1) {
    return std::nullopt;
  }
  const std::string& between = parts.words[i + 1];
  const std::string& fraction = parts.runs[i + 1];
  if (between == ".") {
    return NameStamp{parts.runs[i], fraction.substr(0, kFractionDigits)};
  }
  if ((between != "_" && between != "-") || fraction.size() > kFractionDigits) {
    return std::nullopt;
  }
  return NameStamp{parts.runs[i], fraction, true, fraction.size() == kFractionDigits};
}

}  // namespace

NameParts parts_of(const std::filesystem::path& file) {
  NameParts parts{{""}, {}};
  bool in_run = false;
  for (const char c : file.stem().string()) {
    if (!is_digit(c)) {
      if (in_run) parts.words.emplace_back();
      parts.words.back() += c;
    } else {
      if (!in_run) parts.runs.emplace_back();
      parts.runs.back() += c;
    }
    in_run = is_digit(c);
  }
  if (in_run) {
    parts.words.emplace_back();
  }
  return parts;
}

std::optional<NameStamp> stamp_of(const NameParts& parts) {
  std::optional<NameStamp> found;
  for (std::size_t i = 0; i < parts.runs.size(); ++i) {
    auto stamp = whole_stamp(parts.runs[i]);
    if (auto parted = parted_stamp(parts, i)) {
      stamp = std::move(parted);
      ++i;
    }
    if (stamp && found) {
      return std::nullopt;
    }
    found = stamp ? std::move(stamp) : std::move(found);
  }
  const bool fits = found && parse_integer(found->seconds).value_or(kScanNumberMax) < kScanNumberMax;
  return fits ? found : std::nullopt;
}

StampFraction fraction_kind(const std::vector<NameStamp>& stamps) {
  bool same_length = true;
  bool ends_in_zero = false;
  bool starts_with_zero = false;
  bool has_nine = false;
  for (const NameStamp& stamp : stamps) {
    const std::string& fraction = stamp.fraction;
    if (stamp.is_count) {
      return StampFraction::UnpaddedNanoseconds;
    }
    same_length = same_length && fraction.size() == stamps.front().fraction.size();
    const bool is_lone_digit = fraction.size() == 1;
    ends_in_zero = ends_in_zero || (!is_lone_digit && fraction.back() == '0');
    starts_with_zero = starts_with_zero || (!is_lone_digit && fraction.front() == '0');
    has_nine = has_nine || fraction.size() == kFractionDigits;
  }
  const bool unpadded = !same_length && has_nine && ends_in_zero && !starts_with_zero;
  return unpadded ? StampFraction::UnpaddedNanoseconds : StampFraction::Decimal;
}

nanoseconds time_of(const NameStamp& stamp, StampFraction kind) {
  std::string digits = stamp.fraction;
  if (kind == StampFraction::Decimal) {
    digits.resize(kFractionDigits, '0');
  }
  return std::chrono::seconds(parse_integer(stamp.seconds).value_or(0)) +
         nanoseconds(parse_integer(digits).value_or(0));
}

std::string shown_time(nanoseconds time) {
  std::string digits = std::to_string(time.count() % 1'000'000'000);
  return std::to_string(time.count() / 1'000'000'000) + "." +
         std::string(kFractionDigits - digits.size(), '0') + digits;
}

}  // namespace slamsensor::tools
