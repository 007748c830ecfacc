#pragma once

#include "firmware/config/config.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace slamsensor::firmware {

/// Where a value of type T lives in a Config. `write` makes an absent optional section first; `read` gives
/// null for it.
template <typename T>
struct Member {
  T* (*write)(Config&);
  const T* (*read)(const Config&);
};

/// A real number; the file's value, in the file's unit, lies in [min, max] and is stored times `scale`.
struct RealSetting {
  Member<double> member;
  double min;
  double max;
  double scale;
};

/// A whole number in [min, max].
struct IntegerSetting {
  Member<std::uint32_t> member;
  std::uint32_t min;
  std::uint32_t max;
};

struct BooleanSetting {
  Member<bool> member;
};

/// A text that is one of `names`.
struct TextSetting {
  Member<std::string> member;
  std::span<const std::string_view> names;
};

/// An enumeration whose enumerators count from 0 and are written as `names[enumerator]`.
struct ChoiceSetting {
  void (*write)(Config&, std::size_t);
  std::size_t (*read)(const Config&);
  std::span<const std::string_view> names;
};

/// One key of the configuration file. Everything that is known of a key is here and nowhere else.
struct Setting {
  std::string_view path;         ///< "section.key"
  std::string_view unit;         ///< of the value in the file; empty for a pure number
  std::string_view description;  ///< one line
  std::variant<RealSetting, IntegerSetting, BooleanSetting, TextSetting, ChoiceSetting> kind;

  [[nodiscard]] std::string_view section() const { return path.substr(0, path.find('.')); }
  [[nodiscard]] std::string_view key() const { return path.substr(path.find('.') + 1); }
};

/// A group of keys: a table of the file.
struct Section {
  std::string_view name;
  std::string_view description;
  bool optional;  ///< absent unless written, and then all its keys are required
};

/// Every section and every key there is, keys in the order of their sections.
[[nodiscard]] std::span<const Section> sections();
[[nodiscard]] std::span<const Setting> settings();

/// The position of `path` in settings(), or none.
[[nodiscard]] std::optional<std::size_t> find_setting(std::string_view path);
[[nodiscard]] const Section* find_section(std::string_view name);

/// The value in force as the file would say it (a text in quotes), or none when its section is absent. A real
/// reads back as the very same stored number whenever some decimal does.
[[nodiscard]] std::optional<std::string> value_text(const Setting& setting, const Config& config);

/// The allowed values and the unit: "1.0 .. 2000.0 m", "true or false", "\"paper\" or \"mean\"".
[[nodiscard]] std::string allowed_text(const Setting& setting);

/// The shortest decimal that reads back as `value`, with a point or an exponent, as TOML writes a real.
[[nodiscard]] std::string real_text(double value);

}  // namespace slamsensor::firmware
