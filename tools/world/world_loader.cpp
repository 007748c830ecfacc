#include "tools/world/world_loader.hpp"

#include "tools/world/stems_csv.hpp"
#include "tools/world/world_fields.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

namespace slamsensor::tools {
namespace {

/// Takes one parsed file apart, table by table, and stops at the first thing that is not right.
class Reader {
 public:
  explicit Reader(std::string_view name) : name_(name) {}

  tl::expected<WorldConfig, WorldError> read(const toml::table& file) {
    WorldConfig config;
    const std::vector<Section> sections = sections_of(config);
    for (const auto& [key, node] : file) {
      const bool known = read_known(sections, key.str(), node) ||
                         read_list("wall", key.str(), node, config.walls) ||
                         read_list("mover", key.str(), node, config.movers) ||
                         read_list("stand", key.str(), node, config.stands);
      if (!known && !problem_) {
        refuse(key.source(),
               "unknown key '" + std::string(key.str()) + "'; remove it or correct its spelling");
      }
      if (problem_) {
        return tl::unexpected(*problem_);
      }
    }
    return config;
  }

 private:
  void refuse(const toml::source_region& where, const std::string& what) {
    problem_ = WorldError{name_ + ":" + std::to_string(where.begin.line) + ":" +
                          std::to_string(where.begin.column) + ": " + what};
  }

  bool read_known(const std::vector<Section>& sections, std::string_view key, const toml::node& node) {
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

  template <typename Item>
  bool read_list(std::string_view name, std::string_view key, const toml::node& node,
                 std::vector<Item>& items) {
    if (key != name) {
      return false;
    }
    const toml::array* const list = node.as_array();
    if (list == nullptr) {
      refuse(node.source(), std::string(name) + " is a list: write [[" + std::string(name) + "]]");
      return true;
    }
    for (const toml::node& item : *list) {
      read_section(section_of(items.emplace_back()), item);
      if (problem_) {
        break;
      }
    }
    return true;
  }

  static const Field* find_field(const Section& section, std::string_view key) {
    const auto found = std::find_if(section.fields.begin(), section.fields.end(),
                                    [key](const Field& field) { return field.key == key; });
    return found == section.fields.end() ? nullptr : &*found;
  }

  void read_section(const Section& section, const toml::node& node) {
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
    for (const auto& [name, interval] : section.intervals) {
      if (interval->min > interval->max) {
        refuse(table->source(),
               "[" + section.name + "] " + name + ": the least exceeds the greatest; set both");
      }
    }
  }

  void read_field(const Section& section, const Field& field, const toml::node& node) {
    std::visit([&](auto* value) { read_value(section, field, node, *value); }, field.value);
  }

  bool in_range(const Section& section, const Field& field, const toml::node& node, double number) {
    if (number >= field.min && number <= field.max) {
      return true;
    }
    refuse(node.source(), out_of_range(section, field, number));
    return false;
  }

  void read_value(const Section& section, const Field& field, const toml::node& node, double& value) {
    const std::optional<double> number = node.is_number() ? node.value<double>() : std::nullopt;
    if (!number) {
      refuse(node.source(), field.key + " is a number");
    } else if (in_range(section, field, node, *number)) {
      value = *number * field.scale;
    }
  }

  template <std::unsigned_integral Count>
  void read_value(const Section& section, const Field& field, const toml::node& node, Count& value) {
    const std::optional<std::int64_t> number = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
    if (!number) {
      refuse(node.source(), field.key + " is a whole number");
    } else if (in_range(section, field, node, static_cast<double>(*number))) {
      value = static_cast<Count>(*number);
    }
  }

  void read_value(const Section&, const Field& field, const toml::node& node, std::string& value) {
    const std::optional<std::string> text = node.is_string() ? node.value<std::string>() : std::nullopt;
    if (!text) {
      refuse(node.source(), field.key + " is a text in quotes");
    } else {
      value = *text;
    }
  }

  void read_value(const Section&, const Field& field, const toml::node& node, MoverKind& value) {
    const std::optional<std::string> text = node.value<std::string>();
    if (text != "person" && text != "car") {
      refuse(node.source(), field.key + " is \"person\" or \"car\"");
    } else {
      value = *text == "person" ? MoverKind::Person : MoverKind::Car;
    }
  }

  std::string name_;
  std::optional<WorldError> problem_;
};

tl::expected<toml::table, WorldError> parse_toml(std::string_view text, std::string_view name) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    const toml::source_position where = error.source().begin;
    return tl::unexpected(WorldError{std::string(name) + ":" + std::to_string(where.line) + ":" +
                                     std::to_string(where.column) + ": " + std::string(error.description())});
  }
}

}  // namespace

tl::expected<WorldConfig, WorldError> parse_world(std::string_view toml, std::string_view name,
                                                  const std::filesystem::path& folder) {
  const auto file = parse_toml(toml, name);
  if (!file) {
    return tl::unexpected(file.error());
  }
  auto config = Reader(name).read(*file);
  if (config && !config->trees.stems_csv.empty()) {
    auto stems = load_stems(folder / config->trees.stems_csv);
    if (!stems) {
      return tl::unexpected(std::move(stems.error()));
    }
    config->stems = std::move(*stems);
  }
  if (config) {
    if (auto problem = find_problem(*config)) {
      return tl::unexpected(WorldError{std::string(name) + ": " + problem->message});
    }
  }
  return config;
}

tl::expected<WorldConfig, WorldError> load_world(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return tl::unexpected(
        WorldError{path.string() + ": cannot be opened; give the path of a world file (TOML)"});
  }
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return parse_world(text, path.string(), path.parent_path());
}

}  // namespace slamsensor::tools
