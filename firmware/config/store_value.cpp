#include "firmware/config/store_value.hpp"

#include "firmware/config/config_error.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slamsensor::firmware {
namespace {

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

}  // namespace

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

}  // namespace slamsensor::firmware
