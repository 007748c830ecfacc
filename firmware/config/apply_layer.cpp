#include "firmware/config/load_config.hpp"
#include "firmware/config/suggestion.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <tuple>
#include <utility>

namespace slamsensor::firmware {
namespace {

/// `text` as it can stand in a message of one line: cut, and without control characters.
std::string printable(std::string_view text) {
  constexpr std::size_t kShownMax = 64;
  std::string shown(text.substr(0, kShownMax));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; },
      '?');
  return text.size() > kShownMax ? shown + "..." : shown;
}

/// What was written, for a message.
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
      return "(an array)";
    default:
      return "(a date or time)";
  }
}

/// Stores a value of the file in the config. Each returns what is wrong with it, or nothing and has stored
/// it.
struct Store {
  const toml::node& node;
  Config& config;
  using Fault = std::optional<std::string>;

  Fault operator()(const RealSetting& s) const {
    const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value) {
      return "is not a number";
    }
    if (!std::isfinite(*value)) {
      return "is not a finite number";
    }
    if (*value < s.min || *value > s.max) {
      return "is out of range";
    }
    *s.member.write(config) = *value * s.scale;
    return std::nullopt;
  }

  Fault operator()(const IntegerSetting& s) const {
    const toml::value<std::int64_t>* const value = node.as_integer();
    if (value == nullptr) {
      return "is not a whole number";
    }
    if (value->get() < std::int64_t{s.min} || value->get() > std::int64_t{s.max}) {
      return "is out of range";
    }
    *s.member.write(config) = static_cast<std::uint32_t>(value->get());
    return std::nullopt;
  }

  Fault operator()(const BooleanSetting& s) const {
    if (!node.is_boolean()) {
      return "is neither true nor false";
    }
    *s.member.write(config) = node.as_boolean()->get();
    return std::nullopt;
  }

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

  Fault operator()(const TextSetting& s) const {
    const auto index = position(s.names);
    if (!index) {
      return index.error();
    }
    *s.member.write(config) = s.names[*index];
    return std::nullopt;
  }

  Fault operator()(const ChoiceSetting& s) const {
    const auto index = position(s.names);
    if (!index) {
      return index.error();
    }
    s.write(config, *index);
    return std::nullopt;
  }
};

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
      } else if (section != nullptr) {
        refuse(node.source(), key.str(),
               "value " + written_text(node) + " stands where a section is expected; write [" +
                   std::string(section->name) + "] on a line of its own and its keys below");
      } else {
        refuse_unknown(key.source(), key.str(), node.is_table() || node.is_array_of_tables());
      }
    }
  }

  /// The mistakes, in the order of the lines.
  std::vector<ConfigError> take_errors() {
    std::stable_sort(errors_.begin(), errors_.end(), [](const ConfigError& a, const ConfigError& b) {
      return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
    });
    if (errors_.size() > kConfigErrorsMax) {
      const std::size_t more = errors_.size() - kConfigErrorsMax;
      errors_.resize(kConfigErrorsMax);
      errors_.push_back(
          {{name_, 0, 0}, "", std::to_string(more) + " more mistakes; correct those above first"});
    }
    return std::move(errors_);
  }

 private:
  void apply_section(const Section& section, const toml::table& table) {
    for (const auto& [key, node] : table) {
      const std::string path = std::string(section.name) + '.' + std::string(key.str());
      if (const std::optional<std::size_t> index = find_setting(path)) {
        apply_value(*index, node);
      } else {
        refuse_unknown(key.source(), path, false);
      }
    }
    if (section.optional) {
      require_all(section, table);
    }
  }

  void apply_value(std::size_t index, const toml::node& node) {
    const Setting& setting = settings()[index];
    if (const std::optional<std::string> fault = std::visit(Store{node, onto_.config}, setting.kind)) {
      refuse(node.source(), setting.path,
             "value " + written_text(node) + ' ' + *fault + "; allowed: " + allowed_text(setting) + "; " +
                 advice(setting));
    } else {
      onto_.origins[index] = origin_at(node.source());
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
};

}  // namespace

std::vector<ConfigError> apply_layer(LoadedConfig& onto, std::string_view text, std::string_view name) {
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    const Origin place{std::string(name), error.source().begin.line, error.source().begin.column};
    return {{place, "", "not TOML: " + printable(error.description()) + "; correct this line"}};
  }
  Layer layer(onto, name);
  layer.apply(root);
  return layer.take_errors();
}

}  // namespace slamsensor::firmware
