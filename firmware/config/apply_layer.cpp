#include "firmware/config/load_config.hpp"
#include "firmware/config/store_value.hpp"
#include "firmware/config/suggestion.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

namespace slamsensor::firmware {
namespace {

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
    if (section.is_optional()) {
      require_all(section, table);
    }
  }

  void apply_value(std::size_t index, const toml::node& node) {
    const Setting& setting = settings()[index];
    if (const std::optional<std::string> fault = store_value(setting, node, onto_.config)) {
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
  bool has_preset_ = false;  // this layer chooses a point laser
};

}  // namespace

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
  return layer.take_errors();
}

}  // namespace slamsensor::firmware
