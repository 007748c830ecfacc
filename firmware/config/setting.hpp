#pragma once

#include "firmware/config/sensor_config.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace slamsensor::firmware {

/// Where a value of type T lives in a Config. `write` makes an absent optional section first; `read` gives
/// null for it.
template <typename T>
struct Member {
  T* (*write)(Config&);
  const T* (*read)(const Config&);
};

/// The same for a value that is not kept as the type by which the file is read. `read` gives nothing for an
/// absent optional section.
template <typename T>
struct Access {
  void (*write)(Config&, const T&);
  std::optional<T> (*read)(const Config&);
};

/// A real number; the file's value, in the file's unit, lies in [min, max] and is stored times `scale`. Not
/// finite only where `max` is infinite, and then positive.
struct RealSetting {
  Member<double> member;
  double min;
  double max;
  double scale;
};

/// A length of time: seconds in the file, in [min_s, max_s].
struct DurationSetting {
  Member<hal::Stamp> member;
  double min_s;
  double max_s;
};

enum class NumberBase : std::uint8_t { Decimal, Hexadecimal };

/// A whole number in [min, max], and one of `only` unless that is empty.
struct IntegerSetting {
  Access<std::int64_t> access;
  std::int64_t min;
  std::int64_t max;
  std::span<const std::uint32_t> only{};
  NumberBase base = NumberBase::Decimal;  ///< how it is shown
};

struct BooleanSetting {
  Member<bool> member;
};

/// An enumeration whose enumerators count from 0 and are written as `names[enumerator]`.
struct ChoiceSetting {
  Access<std::size_t> access;
  std::span<const std::string_view> names;
};

/// A text that is one of `names`.
struct TextSetting {
  Member<std::string> member;
  std::span<const std::string_view> names;
};

/// What a text must be like.
struct TextRule {
  std::string_view words;  ///< for a person: "an absolute path of at most 160 characters"
  bool (*accepts)(std::string_view);
};

/// Any text that keeps a rule.
struct FreeTextSetting {
  Access<std::string> access;
  const TextRule* rule;
};

/// Bounds of the number of items of a list.
struct ItemCount {
  std::size_t min;
  std::size_t max;
};

/// A list of whole numbers, each in [min, max].
struct IntegerListSetting {
  Member<std::vector<std::uint32_t>> member;
  std::uint32_t min;
  std::uint32_t max;
  ItemCount items;
};

/// A list of texts that each keep a rule.
struct TextListSetting {
  Access<std::vector<std::string>> access;
  const TextRule* rule;
  ItemCount items;
};

/// What it takes that a changed value of a running daemon counts.
enum class Apply : std::uint8_t { Restart, Live };

/// One key of the configuration file. Everything that is known of a key is here and nowhere else.
struct Setting {
  std::string_view path;         ///< "section.key"
  std::string_view unit;         ///< of the value in the file; empty for a pure number
  std::string_view description;  ///< one line
  std::variant<RealSetting, DurationSetting, IntegerSetting, BooleanSetting, ChoiceSetting, TextSetting,
               FreeTextSetting, IntegerListSetting, TextListSetting>
      kind;
  Apply apply = Apply::Restart;

  [[nodiscard]] std::string_view section() const { return path.substr(0, path.find('.')); }
  [[nodiscard]] std::string_view key() const { return path.substr(path.find('.') + 1); }
};

/// A group of keys: a table of the file.
struct Section {
  std::string_view name;
  std::string_view description;
  void (*clear)(Config&) = nullptr;  ///< of an optional section: makes it absent

  /// Absent unless written, and then all its keys are required.
  [[nodiscard]] bool is_optional() const { return clear != nullptr; }
};

/// Every section and every key there is, keys in the order of their sections.
[[nodiscard]] std::span<const Section> sections();
[[nodiscard]] std::span<const Setting> settings();

/// The position of `path` in settings(), or none.
[[nodiscard]] std::optional<std::size_t> find_setting(std::string_view path);
[[nodiscard]] const Section* find_section(std::string_view name);

/// Every key ("section.key") and every value of a key ("section.key = value") that a former version had and
/// this one has not. They are named and have no effect, while any other key or value that is not allowed is a
/// mistake.
[[nodiscard]] std::span<const std::string_view> retired_settings();
[[nodiscard]] bool is_retired(std::string_view setting);
/// Whether some retired key stood in the section `name`.
[[nodiscard]] bool is_retired_section(std::string_view name);

/// Gives `to` the value that `from` has; nothing happens when its section is absent in `from`.
void copy_setting(const Setting& setting, const Config& from, Config& to);

/// The value in force as the file would say it (a text in quotes), or none when its section is absent. A real
/// reads back as the very same stored number whenever some decimal does.
[[nodiscard]] std::optional<std::string> value_text(const Setting& setting, const Config& config);

/// The allowed values and the unit: "1.0 .. 2000.0 m", "true or false", "\"paper\" or \"mean\"".
[[nodiscard]] std::string allowed_text(const Setting& setting);

/// The shortest decimal that reads back as `value`, with a point or an exponent, as TOML writes a real.
[[nodiscard]] std::string real_text(double value);

/// `text` in quotes as TOML writes it, control characters escaped.
[[nodiscard]] std::string quoted_text(std::string_view text);

/// The number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b` (optimal
/// string alignment). Quadratic: for short words.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The section, or the key ("section.key"), that was probably meant by the unknown `path`, whether written in
/// capitals or not: "a" or, when some are as near as each other, "a, b or c"; empty when nothing or too much
/// is near.
[[nodiscard]] std::string suggest_section(std::string_view path);
[[nodiscard]] std::string suggest_key(std::string_view path);

}  // namespace slamsensor::firmware
