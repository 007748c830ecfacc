#include "tools/input/scan_names.hpp"

#include "tools/input/scan_source.hpp"

#include <algorithm>
#include <chrono>
#include <compare>
#include <iterator>
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

bool has_digits_of_seconds(const std::string& run) {
  return run.size() == kSecondsDigitsMin || run.size() == kSecondsDigitsMin + 1;
}

// The stamp of which run i is the seconds and run i + 1 the fraction.
std::optional<NameStamp> parted_stamp(const NameParts& parts, std::size_t i) {
  if (i + 1 >= parts.runs.size() || !has_digits_of_seconds(parts.runs[i])) {
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

// The one run of a name that may be seconds since 1970 whose fraction, .0, was left out.
std::optional<NameStamp> seconds_alone(const NameParts& parts) {
  const auto first = std::find_if(parts.runs.begin(), parts.runs.end(), has_digits_of_seconds);
  const bool is_one =
      first != parts.runs.end() && std::none_of(first + 1, parts.runs.end(), has_digits_of_seconds);
  return is_one ? std::optional(NameStamp{*first, "", false, false}) : std::nullopt;
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
    if (stamp) {
      found = std::move(stamp);
    }
  }
  found = found ? found : seconds_alone(parts);
  const bool fits = found && parse_integer(found->seconds).value_or(kScanNumberMax) < kScanNumberMax;
  return fits ? found : std::nullopt;
}

/// Recorders that print seconds and nanoseconds as two whole numbers leave out leading zeros; others leave
/// out trailing ones. Fractions of one length are decimal.
StampFraction fraction_kind(const std::vector<NameStamp>& stamps) {
  if (std::any_of(stamps.begin(), stamps.end(), [](const NameStamp& s) { return s.is_count; })) {
    return StampFraction::UnpaddedNanoseconds;
  }
  if (std::any_of(stamps.begin(), stamps.end(), [](const NameStamp& s) { return s.fraction.empty(); })) {
    return StampFraction::Decimal;
  }
  bool same_length = true;
  bool ends_in_zero = false;
  bool starts_with_zero = false;
  bool has_nine = false;
  for (const NameStamp& stamp : stamps) {
    const std::string& fraction = stamp.fraction;
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

// The scans numbered from 0 in the order of their times, which all differ; `rule` says where these are from.
ScanLabels by_time(const std::vector<nanoseconds>& times, const std::string& rule) {
  ScanLabels result;
  result.labels.resize(times.size());
  const std::vector<std::size_t> order = order_of(times);
  for (std::size_t i = 0; i < order.size(); ++i) {
    result.labels[order[i]] = {static_cast<std::int64_t>(i), times[order[i]]};
  }
  result.rule = rule + ", " + shown_time(times[order.front()]) + " to " + shown_time(times[order.back()]) +
                " s, numbered from 0";
  return result;
}

tl::expected<ScanLabels, InputError> by_stamps(std::span<const Path> files,
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
  return by_time(times,
                 std::string("by the time stamp in the names") +
                     (kind == StampFraction::UnpaddedNanoseconds ? " (seconds and whole nanoseconds)" : ""));
}

// The times of all names, when each has one and no two are the same.
template <typename TimeOf>
std::optional<std::vector<nanoseconds>> different_times(const std::vector<NameParts>& parts,
                                                        TimeOf time_of_name) {
  std::vector<nanoseconds> times;
  for (const NameParts& name : parts) {
    const std::optional<nanoseconds> time = time_of_name(name);
    if (!time) {
      return std::nullopt;
    }
    times.push_back(*time);
  }
  return same_keys(times) ? std::nullopt : std::optional(std::move(times));
}

// SECONDS.FRACTION of a clock that began at 0, when names are nothing else and alike. Fractions of several
// lengths are a counter's when one ends in 0, as 10 does: decimals of several lengths have lost their zeros.
std::optional<ScanLabels> by_decimal_seconds(const std::vector<NameParts>& parts) {
  bool same_length = true;
  bool ends_in_zero = false;
  for (const NameParts& name : parts) {
    const bool is_decimal = name.words == parts.front().words && name.runs.size() == 2 &&
                            name.words[1] == "." && name.runs[0].size() <= kSecondsDigitsMin;
    if (!is_decimal) {
      return std::nullopt;
    }
    const std::string& fraction = name.runs[1];
    same_length = same_length && fraction.size() == parts.front().runs[1].size();
    ends_in_zero = ends_in_zero || (fraction.size() > 1 && fraction.back() == '0');
  }
  if (!same_length && ends_in_zero) {
    return std::nullopt;
  }
  const auto times = different_times(parts, [](const NameParts& name) {
    return std::optional(
        time_of({name.runs[0], name.runs[1].substr(0, kFractionDigits)}, StampFraction::Decimal));
  });
  return times ? std::optional(by_time(*times, "by the decimal seconds in the names")) : std::nullopt;
}

constexpr std::int64_t kYearMin = 1970;
constexpr std::int64_t kYearMax = 2254;  // whose seconds are below kScanNumberMax

// The part of `digits` from `begin` on as a number; -1 when it is none.
std::int64_t number_at(std::string_view digits, std::size_t begin, std::size_t count) {
  return parse_integer(digits.substr(begin, count)).value_or(-1);
}

// The time that YYYYMMDDHHMMSS and the digits of a fraction behind it are in UTC.
std::optional<nanoseconds> calendar_time(std::string_view digits) {
  const std::int64_t year = number_at(digits, 0, 4);
  const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(year)),
                                         std::chrono::month(static_cast<unsigned>(number_at(digits, 4, 2))),
                                         std::chrono::day(static_cast<unsigned>(number_at(digits, 6, 2))));
  const std::int64_t hour = number_at(digits, 8, 2);
  const std::int64_t minute = number_at(digits, 10, 2);
  const std::int64_t second = number_at(digits, 12, 2);
  constexpr std::int64_t kLeapSecond = 60;
  if (year < kYearMin || year > kYearMax || !date.ok() || hour > 23 || minute > 59 || second > kLeapSecond) {
    return std::nullopt;
  }
  std::string fraction(digits.substr(14, kFractionDigits));
  fraction.resize(kFractionDigits, '0');
  return std::chrono::sys_days(date).time_since_epoch() + std::chrono::hours(hour) +
         std::chrono::minutes(minute) + std::chrono::seconds(second) +
         nanoseconds(parse_integer(fraction).value_or(0));
}

// Whether `word` may stand behind so many digits of YYYYMMDDHHMMSS.
bool may_part_calendar(const std::string& word, std::size_t digits) {
  constexpr std::size_t kDateDigits = 8;
  return digits == kDateDigits
             ? word == "T" || word == "t" || word == "_" || word == "__" || word == "-" || word == " "
             : word == "-" || word == "_" || word == "." || word == ":";
}

// The time of the date and time of day that begin with run `i`.
std::optional<nanoseconds> calendar_time_at(const NameParts& parts, std::size_t i) {
  constexpr std::size_t kWhole = 14;
  std::string digits = parts.runs[i];
  while (digits.size() < kWhole) {
    const bool ends_in_field = digits.size() >= 4 && digits.size() % 2 == 0;
    if (!ends_in_field || ++i == parts.runs.size() || !may_part_calendar(parts.words[i], digits.size())) {
      return std::nullopt;
    }
    digits += parts.runs[i];
  }
  const auto is_subsecond = [](std::size_t count) { return count == 3 || count == 6 || count == 9; };
  if (digits.size() > kWhole) {
    return is_subsecond(digits.size() - kWhole) ? calendar_time(digits) : std::nullopt;
  }
  if (i + 1 < parts.runs.size()) {
    const std::string& between = parts.words[i + 1];
    const std::string& fraction = parts.runs[i + 1];
    const bool is_decimal = between == "." || between == ",";
    const bool is_count = (between == "_" || between == "-") && is_subsecond(fraction.size());
    digits += is_decimal || is_count ? fraction : "";
  }
  return calendar_time(digits);
}

// A date and time of day in a name.
std::optional<nanoseconds> calendar_time_of(const NameParts& parts) {
  for (std::size_t i = 0; i < parts.runs.size(); ++i) {
    if (const auto time = calendar_time_at(parts, i)) {
      return time;
    }
  }
  return std::nullopt;
}

// A date whose year comes last, of which nobody knows whether the day or the month comes first.
std::optional<std::string> date_with_year_last(const NameParts& parts) {
  for (std::size_t i = 0; i + 2 < parts.runs.size(); ++i) {
    const std::string& word = parts.words[i + 1];
    const std::int64_t first = parse_integer(parts.runs[i]).value_or(0);
    const std::int64_t second = parse_integer(parts.runs[i + 1]).value_or(0);
    const std::int64_t year = parse_integer(parts.runs[i + 2]).value_or(0);
    const bool is_parted = word == parts.words[i + 2] && (word == "-" || word == "." || word == "_");
    const bool is_date = parts.runs[i].size() == 2 && parts.runs[i + 1].size() == 2 && first >= 1 &&
                         first <= 31 && second >= 1 && second <= 31 && year >= kYearMin && year <= kYearMax;
    if (is_parted && is_date) {
      return parts.runs[i] + word + parts.runs[i + 1] + word + parts.runs[i + 2];
    }
  }
  return std::nullopt;
}

// A file whose date cannot be compared with those of the others; nothing when all have one date, or none.
std::optional<std::size_t> with_unclear_date(const std::vector<NameParts>& parts) {
  const auto first = date_with_year_last(parts.front());
  for (std::size_t i = 1; first && i < parts.size(); ++i) {
    const auto date = date_with_year_last(parts[i]);
    if (date && date != first) {
      return i;
    }
  }
  return std::nullopt;
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

// By the stamps of seconds since 1970; nothing when no name has one for sure.
std::optional<tl::expected<ScanLabels, InputError>> by_stamps_in(std::span<const Path> files,
                                                                 const std::vector<NameParts>& parts) {
  std::vector<std::optional<NameStamp>> found;
  std::transform(parts.begin(), parts.end(), std::back_inserter(found), stamp_of);
  const auto sure = std::find_if(found.begin(), found.end(), [](const auto& s) { return s && s->is_sure; });
  if (sure == found.end()) {
    return std::nullopt;
  }
  std::vector<NameStamp> stamps;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const bool is_stamp =
        found[i] && (!found[i]->fraction.empty() || found[i]->seconds.size() == (*sure)->seconds.size());
    if (!is_stamp) {
      return refuse(
          files[i].string(),
          "has no time stamp in its name, as other scans have; replay the ones apart from the others");
    }
    stamps.push_back(*found[i]);
  }
  return by_stamps(files, stamps);
}

}  // namespace

tl::expected<ScanLabels, InputError> label_scans(std::span<const Path> files) {
  if (files.empty()) {
    return ScanLabels{};
  }
  std::vector<NameParts> parts;
  std::transform(files.begin(), files.end(), std::back_inserter(parts),
                 [](const Path& file) { return parts_of(file.stem().string()); });
  if (auto stamped = by_stamps_in(files, parts)) {
    return std::move(*stamped);
  }
  if (const auto times = different_times(parts, calendar_time_of)) {
    return by_time(*times, "by the date and time in the names (taken for UTC)");
  }
  if (files.size() == 1) {
    return alone(files.front(), parts.front());
  }
  if (const auto unclear = with_unclear_date(parts)) {
    return refuse(files[*unclear].string(),
                  "has the date " + *date_with_year_last(parts[*unclear]) +
                      " in its name, in which the day or the month may come first, and other scans have "
                      "another date; rename them to YEAR-MONTH-DAY");
  }
  if (auto decimal = by_decimal_seconds(parts)) {
    return std::move(*decimal);
  }
  const bool are_alike = std::all_of(parts.begin(), parts.end(),
                                     [&](const NameParts& p) { return p.words == parts.front().words; });
  return are_alike ? by_differing_numbers(files, parts) : by_last_number(files, parts);
}

}  // namespace slamsensor::tools
