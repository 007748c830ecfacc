#include "firmware/config/setting.hpp"

#include "firmware/config/rows/setting_rows.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

namespace slamsensor::firmware {
namespace {

/// In the order of the file.
const std::vector<SettingRows>& rows() {
  static const std::vector<SettingRows> kRows = {head_rows(), rangefinder_rows(), method_rows(),
                                                 daemon_rows()};
  return kRows;
}

template <typename T, typename Rows>
std::vector<T> joined(Rows SettingRows::*part) {
  std::vector<T> all;
  for (const SettingRows& group : rows()) {
    all.insert(all.end(), (group.*part).begin(), (group.*part).end());
  }
  return all;
}

/// Copies the value of one setting.
struct Copy {
  const Config& from;
  Config& to;

  template <typename T>
  void operator()(const Member<T>& member) const {
    if (const T* const value = member.read(from)) {
      *member.write(to) = *value;
    }
  }
  template <typename T>
  void operator()(const Access<T>& access) const {
    if (const std::optional<T> value = access.read(from)) {
      access.write(to, *value);
    }
  }
};

/// `value` rounded to `digits` significant decimal digits.
double rounded(double value, int digits) {
  std::array<char, 64> buffer{};
  char* const begin = buffer.data();
  const auto end =
      std::to_chars(begin, begin + buffer.size(), value, std::chars_format::scientific, digits - 1);
  double result = 0.0;
  std::from_chars(begin, end.ptr, result);
  return result;
}

/// The decimal next to `exact` with the fewest digits that `reads_back`. Where none does, `exact`.
template <typename ReadsBack>
double shortest(double exact, const ReadsBack& reads_back) {
  for (int digits = 1; digits <= 17; ++digits) {
    const double candidate = rounded(exact, digits);
    if (reads_back(candidate)) {
      return candidate;
    }
  }
  return exact;
}

double written_value(double stored, double scale) {
  return shortest(stored / scale, [&](double value) { return value * scale == stored; });
}

double written_seconds(hal::Stamp stored) {
  return shortest(hal::to_seconds(stored), [&](double value) { return hal::from_seconds(value) == stored; });
}

std::string integer_text(const IntegerSetting& setting, std::int64_t value) {
  if (setting.base == NumberBase::Decimal || value < 0) {
    return std::to_string(value);
  }
  std::array<char, 24> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, 16);
  std::transform(digits.data(), end.ptr, digits.data(),
                 [](char c) { return c >= 'a' ? static_cast<char>(c - 'a' + 'A') : c; });
  return "0x" + std::string(digits.data(), end.ptr);
}

template <typename Items, typename Text>
std::string list_text(const Items& items, const Text& text) {
  std::string list = "[";
  for (const auto& item : items) {
    list += (list.size() == 1 ? "" : ", ") + text(item);
  }
  return list + ']';
}

std::string count_text(const ItemCount& items) {
  return items.min == items.max ? std::to_string(items.min)
                                : std::to_string(items.min) + " to " + std::to_string(items.max);
}

std::string with_unit(std::string text, std::string_view unit) {
  return unit.empty() ? text : text + ' ' + std::string(unit);
}

std::string alternatives(std::span<const std::string_view> names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + quoted_text(names[i]);
  }
  return text;
}

struct ValueText {
  const Config& config;
  using Value = std::optional<std::string>;

  Value operator()(const RealSetting& s) const {
    const double* const value = s.member.read(config);
    return value == nullptr ? Value() : real_text(written_value(*value, s.scale));
  }
  Value operator()(const DurationSetting& s) const {
    const hal::Stamp* const value = s.member.read(config);
    return value == nullptr ? Value() : real_text(written_seconds(*value));
  }
  Value operator()(const IntegerSetting& s) const {
    const std::optional<std::int64_t> value = s.access.read(config);
    return value ? integer_text(s, *value) : Value();
  }
  Value operator()(const BooleanSetting& s) const {
    const bool* const value = s.member.read(config);
    return value == nullptr ? Value() : *value ? "true" : "false";
  }
  Value operator()(const ChoiceSetting& s) const {
    const std::optional<std::size_t> choice = s.access.read(config);
    return choice && *choice < s.names.size() ? quoted_text(s.names[*choice]) : Value();
  }
  Value operator()(const TextSetting& s) const {
    const std::string* const value = s.member.read(config);
    return value == nullptr ? Value() : quoted_text(*value);
  }
  Value operator()(const FreeTextSetting& s) const {
    const std::optional<std::string> value = s.access.read(config);
    return value ? quoted_text(*value) : Value();
  }
  Value operator()(const IntegerListSetting& s) const {
    const auto* const values = s.member.read(config);
    return values == nullptr ? Value()
                             : list_text(*values, [](std::uint32_t value) { return std::to_string(value); });
  }
  Value operator()(const TextListSetting& s) const {
    const auto values = s.access.read(config);
    return values ? list_text(*values, quoted_text) : Value();
  }
};

struct AllowedText {
  std::string_view unit;

  std::string operator()(const RealSetting& s) const {
    return with_unit(real_text(s.min) + " .. " + real_text(s.max), unit);
  }
  std::string operator()(const DurationSetting& s) const {
    return with_unit(real_text(s.min_s) + " .. " + real_text(s.max_s), unit);
  }
  std::string operator()(const IntegerSetting& s) const {
    std::string text;
    for (std::size_t i = 0; i < s.only.size(); ++i) {
      text += (i == 0 ? "" : i + 1 == s.only.size() ? " or " : ", ") + std::to_string(s.only[i]);
    }
    return with_unit(text.empty() ? integer_text(s, s.min) + " .. " + integer_text(s, s.max) : text, unit);
  }
  std::string operator()(const BooleanSetting&) const { return "true or false"; }
  std::string operator()(const ChoiceSetting& s) const { return alternatives(s.names); }
  std::string operator()(const TextSetting& s) const { return alternatives(s.names); }
  std::string operator()(const FreeTextSetting& s) const { return std::string(s.rule->words); }
  std::string operator()(const IntegerListSetting& s) const {
    return "a list of " + count_text(s.items) + " out of " +
           with_unit(std::to_string(s.min) + " .. " + std::to_string(s.max), unit);
  }
  std::string operator()(const TextListSetting& s) const {
    return "a list of " + count_text(s.items) + ", each " + std::string(s.rule->words);
  }
};

constexpr std::size_t kWordMax = 64;  // longer words are no slip of the hand, and the distance is quadratic

/// The nearest names, as long as they are few.
struct Nearest {
  std::vector<std::string_view> names;
  std::size_t distance = kWordMax;

  void offer(std::string_view candidate, std::size_t candidate_distance) {
    if (candidate_distance < distance) {
      names.clear();
      distance = candidate_distance;
    }
    if (candidate_distance == distance) {
      names.push_back(candidate);
    }
  }
  [[nodiscard]] std::string within(std::size_t limit) const {
    constexpr std::size_t kNamesMax = 4;
    std::string text;
    if (distance <= limit && names.size() <= kNamesMax) {
      for (std::size_t i = 0; i < names.size(); ++i) {
        text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + std::string(names[i]);
      }
    }
    return text;
  }
};

std::string lowered(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return lower;
}

std::size_t limit_for(std::string_view word) {
  return std::max<std::size_t>(2, word.size() / 3);
}

/// How far `written` is from the key `key`. A key written without its unit ("tilt_min") is one step away.
std::size_t key_distance(std::string_view written, std::string_view key) {
  constexpr std::size_t kUnitMax = 6;  // "_deg_s"
  if (written.size() >= 3 && key.starts_with(written) && key.size() - written.size() <= kUnitMax &&
      key.substr(written.size()).starts_with('_')) {
    return 1;
  }
  return edit_distance(written, key);
}

}  // namespace

std::span<const Section> sections() {
  static const std::vector<Section> kSections = joined<Section>(&SettingRows::sections);
  return kSections;
}

std::span<const Setting> settings() {
  static const std::vector<Setting> kSettings = joined<Setting>(&SettingRows::settings);
  return kSettings;
}

std::optional<std::size_t> find_setting(std::string_view path) {
  const std::span<const Setting> all = settings();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Setting& setting) { return setting.path == path; });
  if (found == all.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - all.begin());
}

const Section* find_section(std::string_view name) {
  const std::span<const Section> all = sections();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Section& section) { return section.name == name; });
  return found == all.end() ? nullptr : &*found;
}

void copy_setting(const Setting& setting, const Config& from, Config& to) {
  std::visit(
      [&](const auto& kind) {
        if constexpr (requires { kind.member; }) {
          Copy{from, to}(kind.member);
        } else {
          Copy{from, to}(kind.access);
        }
      },
      setting.kind);
}

std::string real_text(double value) {
  const double magnitude = std::abs(value);
  const bool plain = magnitude == 0.0 || (magnitude >= 1e-5 && magnitude < 1e15);
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 plain ? std::chars_format::fixed : std::chars_format::scientific);
  std::string text(buffer.data(), end.ptr);
  if (text.find_first_of(".en") == std::string::npos) {
    text += ".0";
  }
  return text;
}

std::string quoted_text(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (c == '\r' || c == '\n' || c == '\t') {
      quoted += {'\\', c == '\r' ? 'r' : c == '\n' ? 'n' : 't'};
    } else if (code < 0x20 || code == 0x7F) {
      quoted += {'\\', 'u', '0', '0', kDigits[code >> 4U], kDigits[code & 15U]};
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::optional<std::string> value_text(const Setting& setting, const Config& config) {
  return std::visit(ValueText{config}, setting.kind);
}

std::string allowed_text(const Setting& setting) {
  return std::visit(AllowedText{setting.unit}, setting.kind);
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    last[j] = j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replace});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

std::string suggest_section(std::string_view path) {
  if (path.size() > kWordMax) {
    return {};
  }
  const std::string written = lowered(path);
  Nearest nearest;
  for (const Section& section : sections()) {
    nearest.offer(section.name, edit_distance(written, section.name));
  }
  return nearest.within(limit_for(path));
}

std::string suggest_key(std::string_view path) {
  if (path.size() > kWordMax) {
    return {};
  }
  const std::string written = lowered(path);
  const std::string_view whole = written;
  const std::size_t dot = whole.find('.');
  const std::string_view section = dot == std::string_view::npos ? std::string_view() : whole.substr(0, dot);
  const std::string_view key = dot == std::string_view::npos ? whole : whole.substr(dot + 1);
  Nearest nearest;
  for (const Setting& setting : settings()) {
    // A key of another section must fit better than one of the section that was written.
    const std::size_t elsewhere = setting.section() == section ? 0 : 1;
    nearest.offer(setting.path, key_distance(key, setting.key()) + elsewhere);
  }
  return nearest.within(limit_for(key));
}

}  // namespace slamsensor::firmware
