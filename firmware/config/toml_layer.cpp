// A layer of the configuration: a TOML document onto the values of a Config.
#include "firmware/config/load_config.hpp"
#include "firmware/config/setting.hpp"

#include <tl/expected.hpp>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

namespace slamsensor::firmware {
namespace {

/// What was written, for a message of one line.
std::string written_text(const toml::node& node);

using Fault = std::optional<std::string>;

/// What is wrong with a real number for [min, max]. Not finite is only what `max` itself is.
Fault real_fault(const std::optional<double>& value, double min, double max) {
  if (!value) {
    return "is not a number";
  }
  if (!std::isfinite(*value) && *value != max) {
    return "is not a finite number";
  }
  if (*value < min || *value > max) {
    return "is out of range";
  }
  return std::nullopt;
}

std::optional<double> number(const toml::node& node) {
  return node.is_number() ? node.value<double>() : std::nullopt;
}

std::string item_text(std::size_t place) {
  return "item " + std::to_string(place + 1) + ' ';
}

/// Stores a value of the file in the config. Each returns what is wrong with it, or nothing and has stored
/// it.
struct Store {
  const toml::node& node;
  Config& config;

  Fault operator()(const RealSetting& s) const {
    const std::optional<double> value = number(node);
    Fault fault = real_fault(value, s.min, s.max);
    if (!fault) {
      *s.member.write(config) = *value * s.scale;
    }
    return fault;
  }

  Fault operator()(const DurationSetting& s) const {
    const std::optional<double> value = number(node);
    Fault fault = real_fault(value, s.min_s, s.max_s);
    if (!fault) {
      *s.member.write(config) = hal::from_seconds(*value);
    }
    return fault;
  }

  Fault operator()(const IntegerSetting& s) const {
    const toml::value<std::int64_t>* const value = node.as_integer();
    if (value == nullptr) {
      return "is not a whole number";
    }
    if (value->get() < s.min || value->get() > s.max) {
      return "is out of range";
    }
    if (!s.only.empty() && std::find(s.only.begin(), s.only.end(), value->get()) == s.only.end()) {
      return "is not one of the numbers";
    }
    s.access.write(config, value->get());
    return std::nullopt;
  }

  Fault operator()(const BooleanSetting& s) const {
    if (!node.is_boolean()) {
      return "is neither true nor false";
    }
    *s.member.write(config) = node.as_boolean()->get();
    return std::nullopt;
  }

  Fault operator()(const ChoiceSetting& s) const {
    const auto index = position(s.names);
    if (!index) {
      return index.error();
    }
    s.access.write(config, *index);
    return std::nullopt;
  }

  Fault operator()(const TextSetting& s) const {
    const auto index = position(s.names);
    if (!index) {
      return index.error();
    }
    *s.member.write(config) = s.names[*index];
    return std::nullopt;
  }

  Fault operator()(const FreeTextSetting& s) const {
    if (!node.is_string()) {
      return "is not a text in quotes";
    }
    const std::string& text = node.as_string()->get();
    if (!s.rule->accepts(text)) {
      return "is not allowed here";
    }
    s.access.write(config, text);
    return std::nullopt;
  }

  Fault operator()(const IntegerListSetting& s) const {
    std::vector<std::uint32_t> values;
    Fault fault = for_items(s.items, [&](const toml::node& item) -> Fault {
      const toml::value<std::int64_t>* const value = item.as_integer();
      if (value == nullptr) {
        return "is not a whole number";
      }
      if (value->get() < std::int64_t{s.min} || value->get() > std::int64_t{s.max}) {
        return "is out of range";
      }
      values.push_back(static_cast<std::uint32_t>(value->get()));
      return std::nullopt;
    });
    if (!fault) {
      *s.member.write(config) = std::move(values);
    }
    return fault;
  }

  Fault operator()(const TextListSetting& s) const {
    std::vector<std::string> values;
    Fault fault = for_items(s.items, [&](const toml::node& item) -> Fault {
      if (!item.is_string()) {
        return "is not a text in quotes";
      }
      if (!s.rule->accepts(item.as_string()->get())) {
        return written_text(item) + " is not allowed here";
      }
      values.push_back(item.as_string()->get());
      return std::nullopt;
    });
    if (!fault) {
      s.access.write(config, values);
    }
    return fault;
  }

 private:
  /// The position of the written text among `names`.
  [[nodiscard]] tl::expected<std::size_t, std::string> position(
      std::span<const std::string_view> names) const {
    if (!node.is_string()) {
      return tl::unexpected<std::string>("is not a text in quotes");
    }
    const auto found = std::find(names.begin(), names.end(), std::string_view(node.as_string()->get()));
    if (found == names.end()) {
      return tl::unexpected<std::string>("is not one of the names");
    }
    return static_cast<std::size_t>(found - names.begin());
  }

  /// Takes each item of the list; the first fault there is.
  template <typename Take>
  [[nodiscard]] Fault for_items(const ItemCount& allowed, const Take& take) const {
    const toml::array* const list = node.as_array();
    if (list == nullptr) {
      return "is not a list in square brackets";
    }
    if (list->size() < allowed.min || list->size() > allowed.max) {
      return "has " + std::to_string(list->size()) + " items";
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
      if (const Fault fault = take(*list->get(i))) {
        return "has a mistake: " + item_text(i) + *fault;
      }
    }
    return std::nullopt;
  }
};

/// The first items of a list.
std::string written_list(const toml::array& list) {
  constexpr std::size_t kShownMax = 8;
  std::string text = "[";
  for (std::size_t i = 0; i < std::min(list.size(), kShownMax); ++i) {
    const toml::node& item = *list.get(i);
    text += (i == 0 ? "" : ", ") + (item.is_array() ? "(an array)" : written_text(item));
  }
  return printable(text + (list.size() > kShownMax ? ", ...]" : "]"));
}

/// Stores what stands in the file as the value of `setting`; or returns what is wrong with it ("is out of
/// range"), and `config` is as before.
std::optional<std::string> store_value(const Setting& setting, const toml::node& node, Config& config) {
  return std::visit(Store{node, config}, setting.kind);
}

std::string written_text(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return '"' + printable(node.as_string()->get()) + '"';
    case toml::node_type::integer:
      return std::to_string(node.as_integer()->get());
    case toml::node_type::floating_point:
      return real_text(node.as_floating_point()->get());
    case toml::node_type::boolean:
      return node.as_boolean()->get() ? "true" : "false";
    case toml::node_type::table:
      return "(a table)";
    case toml::node_type::array:
      return written_list(*node.as_array());
    default:
      return "(a date or time)";
  }
}

constexpr std::size_t kKeyPartsMax = 64;

/// Walks a TOML text without parsing it: strings and comments are passed over as a whole.
class TomlWalk {
 public:
  explicit TomlWalk(std::string_view text) : rest_(text) {}

  /// The next character outside of strings and comments; nothing at the end.
  std::optional<char> next() {
    while (!rest_.empty()) {
      const char c = rest_.front();
      if (c == '#') {
        pass(std::min(rest_.find('\n'), rest_.size()));
      } else if (c == '"' || c == '\'') {
        pass_string(c);
      } else {
        pass(1);
        return c;
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::uint32_t line() const { return line_; }

 private:
  void pass(std::size_t count) {
    line_ += static_cast<std::uint32_t>(
        std::count(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(count), '\n'));
    rest_.remove_prefix(count);
  }

  /// A string of one line ends with its line at the latest, one in three quotes with three quotes.
  void pass_string(char quote) {
    const std::string three(3, quote);
    const bool is_long = rest_.starts_with(three);
    const std::string_view end = is_long ? std::string_view(three) : std::string_view(three).substr(0, 1);
    pass(end.size());
    while (!rest_.empty() && !rest_.starts_with(end) && (is_long || rest_.front() != '\n')) {
      const bool is_escape = quote == '"' && rest_.front() == '\\' && rest_.size() > 1;
      pass(is_escape ? 2 : 1);
    }
    if (rest_.starts_with(end)) {
      pass(end.size());
    }
  }

  std::string_view rest_;
  std::uint32_t line_ = 1;
};

constexpr std::size_t kReasonMax = 200;  // bytes of what the parser says
constexpr std::string_view kPreset = "point_laser.preset";

/// Gives the point laser the values of its preset, but those of its keys that some layer has written.
void lay_over_preset(LoadedConfig& loaded) {
  Config fresh;
  fresh.head.point_laser = preset_config(loaded.config.head.point_laser_preset);
  for (std::size_t i = 0; i < settings().size(); ++i) {
    const Setting& setting = settings()[i];
    if (setting.section() == "point_laser" && !loaded.origins[i].is_default()) {
      copy_setting(setting, loaded.config, fresh);
    }
  }
  loaded.config.head.point_laser = fresh.head.point_laser;
}

struct SyntaxFault {
  std::uint32_t line;
  std::uint32_t column;
  std::string message;
};

tl::expected<toml::table, SyntaxFault> parsed(std::string_view text) {
  if (const auto line = too_deep_line(text)) {
    return tl::unexpected(SyntaxFault{*line, 1, "a key has more parts than any setting"});
  }
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    const toml::source_position& place = error.source().begin;
    return tl::unexpected(SyntaxFault{place.line, place.column, printable(error.description(), kReasonMax)});
  }
}

/// What to do about a refused value.
std::string advice(const Setting& setting) {
  static const Config kDefaults;
  const std::optional<std::string> standard = value_text(setting, kDefaults);
  return standard ? "write one of these, or delete the line for the default " + *standard
                  : "write one of these";
}

/// One layer being applied: the document, the config it goes onto, and the mistakes so far.
class Layer {
 public:
  Layer(LoadedConfig& onto, std::string_view name) : onto_(onto), name_(name) {}

  void apply(const toml::table& root) {
    for (const auto& [key, node] : root) {
      const Section* const section = find_section(key.str());
      if (section != nullptr && node.is_table()) {
        apply_section(*section, *node.as_table());
      } else if (section == nullptr && node.is_table() && is_retired_section(key.str())) {
        apply_keys(key.str(), *node.as_table());
      } else if (section != nullptr) {
        refuse(node.source(), key.str(),
               "value " + written_text(node) + " stands where a section is expected; write [" +
                   std::string(section->name) + "] on a line of its own and its keys below");
      } else {
        refuse_unknown(key.source(), key.str(), node.is_table() || node.is_array_of_tables());
      }
    }
    if (has_preset_) {
      lay_over_preset(onto_);
    }
  }

  /// The mistakes, in the order of the lines.
  std::vector<ConfigError> take_errors() {
    sort_by_place(errors_);
    if (errors_.size() > kConfigErrorsMax) {
      const std::size_t more = errors_.size() - kConfigErrorsMax;
      errors_.resize(kConfigErrorsMax);
      errors_.push_back(
          {{name_, 0, 0}, "", std::to_string(more) + " more mistakes; correct those above first"});
    }
    return std::move(errors_);
  }

  /// A line for each retired key, in the order of the lines.
  std::vector<ConfigError> take_warnings() {
    sort_by_place(warnings_);
    return std::move(warnings_);
  }

 private:
  static void sort_by_place(std::vector<ConfigError>& remarks) {
    std::stable_sort(remarks.begin(), remarks.end(), [](const ConfigError& a, const ConfigError& b) {
      return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
    });
  }

  void apply_section(const Section& section, const toml::table& table) {
    apply_keys(section.name, table);
    if (section.is_optional()) {
      require_all(section, table);
    }
  }

  void apply_keys(std::string_view section, const toml::table& table) {
    for (const auto& [key, node] : table) {
      const std::string path = std::string(section) + '.' + std::string(key.str());
      if (const std::optional<std::size_t> index = find_setting(path)) {
        apply_value(*index, node);
      } else if (is_retired(path)) {
        warn(key.source(), path, "has no effect any more; remove it");
      } else {
        refuse_unknown(key.source(), path, false);
      }
    }
  }

  void apply_value(std::size_t index, const toml::node& node) {
    const Setting& setting = settings()[index];
    const std::optional<std::string> fault = store_value(setting, node, onto_.config);
    if (fault && is_retired(std::string(setting.path) + " = " + written_text(node))) {
      warn(node.source(), setting.path, "value " + written_text(node) + " has no effect any more; remove it");
    } else if (fault) {
      refuse(node.source(), setting.path,
             "value " + written_text(node) + ' ' + *fault + "; allowed: " + allowed_text(setting) + "; " +
                 advice(setting));
    } else {
      onto_.origins[index] = origin_at(node.source());
      has_preset_ = has_preset_ || setting.path == kPreset;
    }
  }

  /// An optional section has no defaults: each of its keys is in this layer or in one before.
  void require_all(const Section& section, const toml::table& table) {
    for (std::size_t i = 0; i < settings().size(); ++i) {
      const Setting& setting = settings()[i];
      if (setting.section() == section.name && onto_.origins[i].is_default() &&
          !table.contains(setting.key())) {
        refuse(table.source(), setting.path,
               "is missing; the keys of [" + std::string(section.name) +
                   "] are given together: add it (allowed: " + allowed_text(setting) +
                   "), or delete the section");
      }
    }
  }

  void refuse_unknown(const toml::source_region& place, std::string_view path, bool is_section) {
    const std::string nearest = is_section ? suggest_section(path) : suggest_key(path);
    refuse(place, path,
           std::string(is_section ? "unknown section; " : "unknown key; ") +
               (nearest.empty()
                    ? "'slamsensor check-config' lists all that exist"
                    : "did you mean " + nearest + "? 'slamsensor check-config' lists all that exist"));
    errors_.back().is_unknown = true;
  }

  void warn(const toml::source_region& place, std::string_view key, std::string message) {
    warnings_.push_back({origin_at(place), std::string(key), std::move(message)});
  }

  void refuse(const toml::source_region& place, std::string_view key, std::string message) {
    errors_.push_back({origin_at(place), printable(key), std::move(message)});
  }

  [[nodiscard]] Origin origin_at(const toml::source_region& place) const {
    return {name_, place.begin.line, place.begin.column};
  }

  LoadedConfig& onto_;
  std::string name_;
  std::vector<ConfigError> errors_;
  std::vector<ConfigError> warnings_;
  bool has_preset_ = false;  // this layer chooses a point laser
};

}  // namespace

std::optional<std::uint32_t> too_deep_line(std::string_view text) {
  constexpr std::string_view kEndsKey = "=,[]{}\n";
  TomlWalk walk(text);
  std::size_t parts = 1;
  while (const auto c = walk.next()) {
    parts = kEndsKey.find(*c) != std::string_view::npos ? 1 : parts + (*c == '.' ? 1 : 0);
    if (parts > kKeyPartsMax) {
      return walk.line();
    }
  }
  return std::nullopt;
}

std::string syntax_fault(std::string_view text) {
  const auto root = parsed(text);
  return root ? "" : root.error().message;
}

std::vector<ConfigError> apply_layer(LoadedConfig& onto, std::string_view text, std::string_view name) {
  const auto root = parsed(text);
  if (!root) {
    const SyntaxFault& fault = root.error();
    return {{{std::string(name), fault.line, fault.column},
             "",
             "not TOML: " + fault.message + "; correct this line"}};
  }
  Layer layer(onto, name);
  layer.apply(*root);
  append(onto.warnings, layer.take_warnings());
  return layer.take_errors();
}

}  // namespace slamsensor::firmware
