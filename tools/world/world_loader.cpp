#include "tools/world/world_loader.hpp"

#include "tools/world/section_reader.hpp"
#include "tools/world/stems_csv.hpp"
#include "tools/world/world_fields.hpp"

#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

tl::expected<WorldConfig, WorldError> read_config(const toml::table& file, std::string_view name) {
  WorldConfig config;
  SectionReader reader(name);
  const std::vector<Section> sections = sections_of(config);
  const auto keys_of = [](auto& item) { return section_of(item); };
  for (const auto& [key, node] : file) {
    const bool known = reader.read_known(sections, key.str(), node) ||
                       reader.read_list("wall", key.str(), node, config.walls, keys_of) ||
                       reader.read_list("mover", key.str(), node, config.movers, keys_of) ||
                       reader.read_list("stand", key.str(), node, config.stands, keys_of);
    if (!known) {
      reader.refuse_unknown(key);
    }
    if (reader.problem()) {
      return tl::unexpected(*reader.problem());
    }
  }
  return config;
}

}  // namespace

tl::expected<WorldConfig, WorldError> parse_world(std::string_view toml, std::string_view name,
                                                  const std::filesystem::path& folder) {
  const auto file = parse_toml(toml, name);
  if (!file) {
    return tl::unexpected(file.error());
  }
  auto config = read_config(*file, name);
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
  const auto text = read_text(path, "world file");
  if (!text) {
    return tl::unexpected(text.error());
  }
  return parse_world(*text, path.string(), path.parent_path());
}

}  // namespace slamsensor::tools
