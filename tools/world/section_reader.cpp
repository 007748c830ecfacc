#include "tools/world/section_reader.hpp"

#include "firmware/config/load_config.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <type_traits>

namespace slamsensor::tools {
namespace {

const Field* find_field(const Section& section, std::string_view key) {
  const auto found = std::find_if(section.fields.begin(), section.fields.end(),
                                  [key](const Field& field) { return field.key == key; });
  return found == section.fields.end() ? nullptr : &*found;
}

/// "a", "b" or "c", each in quotes.
std::string list_of_words(const std::vector<std::string_view>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += i == 0 ? "" : i + 1 == words.size() ? " or " : ", ";
    text.append("\"").append(words[i]).append("\"");
  }
  return text;
}

}  // namespace

tl::expected<std::string, WorldError> read_text(const std::filesystem::path& path, std::string_view what) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return tl::unexpected(WorldError{path.string() + ": cannot be opened; give the path of a " +
                                     std::string(what) + " (TOML)"});
  }
  return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

tl::expected<toml::table, WorldError> parse_toml(std::string_view text, std::string_view name) {
  if (const auto line = firmware::too_deep_line(text)) {
    return tl::unexpected(WorldError{std::string(name) + ":" + std::to_string(*line) +
                                     ": a key has more parts than any setting; correct this line"});
  }
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    const toml::source_position where = error.source().begin;
    return tl::unexpected(WorldError{std::string(name) + ":" + std::to_string(where.line) + ":" +
                                     std::to_string(where.column) + ": " + std::string(error.description())});
  }
}

void SectionReader::refuse(const toml::source_region& where, const std::string& what) {
  problem_ = WorldError{name_ + ":" + std::to_string(where.begin.line) + ":" +
                        std::to_string(where.begin.column) + ": " + what};
}

void SectionReader::refuse_unknown(const toml::key& key) {
  refuse(key.source(), "unknown key '" + std::string(key.str()) + "'; remove it or correct its spelling");
}

bool SectionReader::read_known(const std::vector<Section>& sections, std::string_view key,
                               const toml::node& node) {
  for (const Section& section : sections) {
    if (section.name == key && !section.name.empty()) {
      read_section(section, node);
      return true;
    }
    const Field* const field = section.name.empty() ? find_field(section, key) : nullptr;
    if (field != nullptr) {
      read_field(section, *field, node);
      return true;
    }
  }
  return false;
}

const toml::array* SectionReader::list_of(std::string_view name, const toml::node& node) {
  const toml::array* const list = node.as_array();
  if (list == nullptr) {
    refuse(node.source(), std::string(name) + " is a list: write [[" + std::string(name) + "]]");
  }
  return list;
}

void SectionReader::read_section(const Section& section, const toml::node& node) {
  const toml::table* const table = node.as_table();
  if (table == nullptr) {
    refuse(node.source(), section.name + " is a table: write [" + section.name + "]");
    return;
  }
  for (const auto& [key, value] : *table) {
    const Field* const field = find_field(section, key.str());
    if (field == nullptr) {
      refuse(key.source(), "unknown key '" + std::string(key.str()) + "' in [" + section.name +
                               "]; remove it or correct its spelling");
    } else {
      read_field(section, *field, value);
    }
    if (problem_) {
      return;
    }
  }
  check_section(section, *table);
}

void SectionReader::check_section(const Section& section, const toml::table& table) {
  for (const std::string& key : section.required) {
    if (!table.contains(key)) {
      refuse(table.source(), "[" + section.name + "] needs the key '" + key + "'");
      return;
    }
  }
  for (const auto& [name, interval] : section.intervals) {
    if (interval->min > interval->max) {
      refuse(table.source(), "[" + section.name + "] " + name + ": the least exceeds the greatest; set both");
    }
  }
  const std::string wrong = section.check ? section.check() : std::string();
  if (!wrong.empty()) {
    refuse(table.source(), "[" + section.name + "] " + wrong);
  }
}

void SectionReader::read_field(const Section& section, const Field& field, const toml::node& node) {
  std::visit(
      [&](const auto& value) {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Choice>) {
          read_choice(field, node, value);
        } else {
          read_value(section, field, node, *value);
        }
      },
      field.value);
}

bool SectionReader::in_range(const Section& section, const Field& field, const toml::node& node,
                             double number) {
  if (number >= field.min && number <= field.max) {
    return true;
  }
  refuse(node.source(), out_of_range(section, field, number));
  return false;
}

void SectionReader::read_value(const Section& section, const Field& field, const toml::node& node,
                               double& value) {
  const std::optional<double> number = node.is_number() ? node.value<double>() : std::nullopt;
  if (!number) {
    refuse(node.source(), field.key + " is a number");
  } else if (in_range(section, field, node, *number)) {
    value = *number * field.scale;
  }
}

template <std::unsigned_integral Count>
void SectionReader::read_value(const Section& section, const Field& field, const toml::node& node,
                               Count& value) {
  const std::optional<std::int64_t> number = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
  if (!number) {
    refuse(node.source(), field.key + " is a whole number");
  } else if (in_range(section, field, node, static_cast<double>(*number))) {
    value = static_cast<Count>(*number);
  }
}

void SectionReader::read_value(const Section&, const Field& field, const toml::node& node,
                               std::string& value) {
  const std::optional<std::string> text = node.is_string() ? node.value<std::string>() : std::nullopt;
  if (!text) {
    refuse(node.source(), field.key + " is a text in quotes");
  } else {
    value = *text;
  }
}

void SectionReader::read_choice(const Field& field, const toml::node& node, const Choice& choice) {
  const std::optional<std::string> text = node.value<std::string>();
  const auto word = text ? std::find(choice.words.begin(), choice.words.end(), *text) : choice.words.end();
  if (word == choice.words.end()) {
    refuse(node.source(), field.key + " is " + list_of_words(choice.words));
  } else {
    choice.set(static_cast<std::size_t>(word - choice.words.begin()));
  }
}

}  // namespace slamsensor::tools
