#include "tools/input/scan_names.hpp"

#include "tools/input/scan_source.hpp"

#include <algorithm>
#include <compare>
#include <numeric>
#include <string_view>
#include <utility>

namespace slamsensor::tools {
namespace {

/// A name in its digits and what stands between them: words[0] runs[0] words[1] ... words[n].
struct NameParts {
  std::vector<std::string> words;
  std::vector<std::string> runs;
};

/// Seconds and the digits of their fraction, as a name gives them.
struct NameStamp {
  std::string seconds;
  std::string fraction;
  bool is_count = false;  ///< the fraction counts nanoseconds: SECONDS_NANOSECONDS
  bool is_sure = true;    ///< else what follows the seconds may be any number; a sure stamp beside it decides
};

/// How the digits behind the point are meant.
enum class StampFraction : std::uint8_t { Decimal, UnpaddedNanoseconds };

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

NameParts parts_of(std::string_view name) {
  NameParts parts{{""}, {}};
  bool in_run = false;
  for (const char c : name) {
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

/// The one stamp in a name: SECONDS.FRACTION or SECONDS_NANOSECONDS since 1970, or a count of milliseconds,
/// microseconds or nanoseconds; nothing when there is none or more than one.
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

/// Recorders that print seconds and nanoseconds as two whole numbers leave out leading zeros; others leave
/// out trailing ones. Fractions of one length are decimal.
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

/// "1600000001.050000000"
std::string shown_time(nanoseconds time) {
  std::string digits = std::to_string(time.count() % 1'000'000'000);
  return std::to_string(time.count() / 1'000'000'000) + "." +
         std::string(kFractionDigits - digits.size(), '0') + digits;
}

using Path = std::filesystem::path;
using Numbers = std::vector<std::int64_t>;

template <typename Key>
std::vector<std::size_t> order_of(const std::vector<Key>& keys) {
  std::vector<std::size_t> order(keys.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return keys[a] < keys[b]; });
  return order;
}

// The two files whose keys are the same; nothing when all differ.
template <typename Key>
std::optional<std::pair<std::size_t, std::size_t>> same_keys(const std::vector<Key>& keys) {
  const std::vector<std::size_t> order = order_of(keys);
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (keys[order[i - 1]] == keys[order[i]]) return std::pair(order[i - 1], order[i]);
  }
  return std::nullopt;
}

tl::unexpected<InputError> refuse_same(const Path& second, const Path& first, const std::string& what) {
  return refuse(second.string(),
                "has " + what + ", as has " + first.string() + "; rename one or leave one out");
}

tl::expected<ScanLabels, InputError> by_time(std::span<const Path> files,
                                             const std::vector<NameStamp>& stamps) {
  const StampFraction kind = fraction_kind(stamps);
  std::vector<nanoseconds> times;
  for (const NameStamp& stamp : stamps) {
    times.push_back(time_of(stamp, kind));
  }
  if (const auto same = same_keys(times)) {
    return refuse_same(files[same->second], files[same->first],
                       "the time stamp " + shown_time(times[same->first]));
  }
  ScanLabels result;
  result.labels.resize(files.size());
  const std::vector<std::size_t> order = order_of(times);
  for (std::size_t i = 0; i < order.size(); ++i) {
    result.labels[order[i]] = {static_cast<std::int64_t>(i), times[order[i]]};
  }
  result.rule = std::string("by the time stamp in the names") +
                (kind == StampFraction::UnpaddedNanoseconds ? " (seconds and whole nanoseconds)" : "") +
                ", " + shown_time(times[order.front()]) + " to " + shown_time(times[order.back()]) +
                " s, numbered from 0";
  return result;
}

ScanLabel numbered(std::int64_t number) {
  return {number, std::chrono::seconds(number)};
}

// The number that a run of digits is; nothing when it is too large for a scan.
std::optional<std::int64_t> number_of(const std::string& run) {
  const auto number = parse_integer(run);
  return number && *number <= kScanNumberMax ? number : std::nullopt;
}

// The scans numbered from 0 in the order of their keys, which all differ.
template <typename Key>
ScanLabels in_order_of(const std::vector<Key>& keys, std::string rule) {
  ScanLabels result{std::vector<ScanLabel>(keys.size()), std::move(rule)};
  const std::vector<std::size_t> order = order_of(keys);
  for (std::size_t i = 0; i < order.size(); ++i) {
    result.labels[order[i]] = numbered(static_cast<std::int64_t>(i));
  }
  return result;
}

// A path without its extension as a person sorts it: what stands between the numbers by its letters, the
// numbers by their value, however many digits they have.
struct NameOrder {
  struct Part {
    std::string word;
    std::size_t digits = 0;
    std::string run;
    friend auto operator<=>(const Part&, const Part&) = default;
  };
  std::vector<Part> parts;
  std::string name;  // where the parts are alike: 7 and 007
  friend auto operator<=>(const NameOrder&, const NameOrder&) = default;
};

NameOrder name_order(const Path& file) {
  std::error_code failed;
  Path whole = std::filesystem::weakly_canonical(file, failed);
  whole = failed ? file : whole;
  NameOrder order{{}, whole.replace_extension().string()};
  const NameParts parts = parts_of(order.name);
  for (std::size_t i = 0; i < parts.words.size(); ++i) {
    NameOrder::Part& part = order.parts.emplace_back();
    part.word = parts.words[i];
    if (i < parts.runs.size()) {
      part.run = parts.runs[i].substr(std::min(parts.runs[i].find_first_not_of('0'), parts.runs[i].size()));
      part.digits = part.run.size();
    }
  }
  return order;
}

// Whatever the names are; refused is only what has the name of another: the same scan twice.
tl::expected<ScanLabels, InputError> by_names(std::span<const Path> files) {
  std::vector<NameOrder> keys;
  std::transform(files.begin(), files.end(), std::back_inserter(keys), name_order);
  if (const auto same = same_keys(keys)) {
    return refuse_same(files[same->second], files[same->first], "the same name");
  }
  return in_order_of(
      keys, "by name, numbered from 0, because the numbers in the names do not tell all scans apart");
}

tl::expected<ScanLabels, InputError> by_keys(std::span<const Path> files, const Numbers& keys,
                                             std::string rule) {
  if (same_keys(keys)) {
    return by_names(files);
  }
  ScanLabels result;
  std::transform(keys.begin(), keys.end(), std::back_inserter(result.labels), numbered);
  result.rule = std::move(rule);
  return result;
}

tl::expected<ScanLabels, InputError> by_last_number(std::span<const Path> files,
                                                    const std::vector<NameParts>& parts) {
  Numbers keys;
  for (const NameParts& name : parts) {
    const auto number = name.runs.empty() ? std::optional<std::int64_t>() : number_of(name.runs.back());
    if (!number) {
      return by_names(files);
    }
    keys.push_back(*number);
  }
  return by_keys(files, keys, "by the last number in the names");
}

// Whose numbers differ among names that are otherwise alike: the places of these numbers in a name.
std::vector<std::size_t> differing_runs(const std::vector<NameParts>& parts) {
  std::vector<std::size_t> places;
  for (std::size_t run = 0; run < parts.front().runs.size(); ++run) {
    const bool differs = std::any_of(parts.begin(), parts.end(), [&](const NameParts& p) {
      return parse_integer(p.runs[run]) != parse_integer(parts.front().runs[run]);
    });
    if (differs) places.push_back(run);
  }
  return places;
}

tl::expected<ScanLabels, InputError> by_several_numbers(std::span<const Path> files,
                                                        const std::vector<Numbers>& keys) {
  Numbers first;
  std::transform(keys.begin(), keys.end(), std::back_inserter(first),
                 [](const Numbers& key) { return key.front(); });
  if (!same_keys(first)) {
    return by_keys(files, first, "by the first number that differs in the names");
  }
  if (same_keys(keys)) {
    return by_names(files);
  }
  return in_order_of(keys, "by all numbers in the names, the leftmost first, numbered from 0");
}

// Names that differ in numbers alone.
tl::expected<ScanLabels, InputError> by_differing_numbers(std::span<const Path> files,
                                                          const std::vector<NameParts>& parts) {
  const std::vector<std::size_t> places = differing_runs(parts);
  if (places.empty()) {  // the same names in several folders
    return by_last_number(files, parts);
  }
  std::vector<Numbers> keys;
  for (const NameParts& name : parts) {
    Numbers& key = keys.emplace_back();
    for (const std::size_t place : places) {
      const auto number = number_of(name.runs[place]);
      if (!number) {
        return by_names(files);
      }
      key.push_back(*number);
    }
  }
  if (places.size() > 1) {
    return by_several_numbers(files, keys);
  }
  Numbers only;
  std::transform(keys.begin(), keys.end(), std::back_inserter(only),
                 [](const Numbers& key) { return key.front(); });
  return by_keys(files, only, "by the number in the names");
}

// A file that comes alone: nothing shows which of several numbers counts scans, so it is the longest.
tl::expected<ScanLabels, InputError> alone(const Path& file, const NameParts& parts) {
  if (parts.runs.empty()) {
    return ScanLabels{{ScanLabel{}}, ""};
  }
  const auto longest =
      std::max_element(parts.runs.rbegin(), parts.runs.rend(),
                       [](const std::string& a, const std::string& b) { return a.size() < b.size(); });
  const auto number = number_of(*longest);
  if (!number) {
    return refuse(file.string(),
                  "the number in its name is too large; rename it to end in the scan's number, 0 to " +
                      std::to_string(kScanNumberMax));
  }
  return ScanLabels{{numbered(*number)}, ""};
}

}  // namespace

tl::expected<ScanLabels, InputError> label_scans(std::span<const Path> files) {
  if (files.empty()) {
    return ScanLabels{};
  }
  std::vector<NameParts> parts;
  std::vector<NameStamp> stamps;
  std::optional<std::size_t> without_stamp;
  for (const Path& file : files) {
    parts.push_back(parts_of(file.stem().string()));
    auto stamp = stamp_of(parts.back());
    if (stamp) {
      stamps.push_back(std::move(*stamp));
    } else {
      without_stamp = parts.size() - 1;
    }
  }
  const bool is_sure =
      std::any_of(stamps.begin(), stamps.end(), [](const NameStamp& stamp) { return stamp.is_sure; });
  if (is_sure && !without_stamp) {
    return by_time(files, stamps);
  }
  if (is_sure) {
    return refuse(
        files[*without_stamp].string(),
        "has no time stamp in its name, as other scans have; replay the ones apart from the others");
  }
  if (files.size() == 1) {
    return alone(files.front(), parts.front());
  }
  const bool are_alike = std::all_of(parts.begin(), parts.end(),
                                     [&](const NameParts& p) { return p.words == parts.front().words; });
  return are_alike ? by_differing_numbers(files, parts) : by_last_number(files, parts);
}

}  // namespace slamsensor::tools
