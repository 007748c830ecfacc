#include "tools/emulator/scenario.hpp"

#include "tools/emulator/fault_fit.hpp"
#include "tools/emulator/scenario_fields.hpp"
#include "tools/world/section_reader.hpp"
#include "tools/world/world_fields.hpp"
#include "tools/world/world_loader.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace slamsensor::tools {
namespace {

/// Reads one scenario file; what others are checked against or start from is read first.
class ScenarioReader {
 public:
  ScenarioReader(std::string_view name, std::filesystem::path folder, std::optional<HeadKind> kind)
      : reader_(name), folder_(std::move(folder)), kind_(kind) {}

  tl::expected<Scenario, WorldError> read(const toml::table& file) {
    read_base(file);
    const std::vector<Section> sections = sections_of(scenario_, extras_);
    for (const std::string_view device : {"ptu", "rangefinder"}) {
      const toml::node* const node = file.get(device);
      if (node != nullptr && !reader_.problem()) {
        reader_.read_known(sections, device, *node);
      }
    }
    for (const auto& [key, node] : file) {
      if (!reader_.problem() && !read_rest(sections, key.str(), node)) {
        reader_.refuse_unknown(key);
      }
    }
    place_stands(file);
    if (reader_.problem()) {
      return tl::unexpected(*reader_.problem());
    }
    return std::move(scenario_);
  }

 private:
  void read_base(const toml::table& file) {
    const std::vector<Section> base = {base_section(scenario_, extras_)};
    for (const auto& [key, node] : file) {
      if (!reader_.problem()) {
        reader_.read_known(base, key.str(), node);
      }
    }
    scenario_.head = head_profile(kind_.value_or(extras_.head));
    if (!reader_.problem()) {
      read_world(*file.get("world"));
    }
  }

  void read_world(const toml::node& node) {
    auto world = load_world(folder_ / extras_.world);
    if (!world) {
      reader_.refuse(node.source(), "world: " + world.error().message);
      return;
    }
    scenario_.world = std::move(*world);
    scenario_.world.seed = extras_.world_seed != 0 ? extras_.world_seed : scenario_.world.seed;
  }

  bool read_rest(const std::vector<Section>& sections, std::string_view key, const toml::node& node) {
    const auto fault = [this](PlannedFault& item) { return fault_section(item, scenario_.head); };
    const auto rate = [this](FaultRate& item) { return rate_section(item, scenario_.head); };
    const auto stand = [](StandConfig& item) { return section_of(item); };
    const std::vector<std::string_view> read = {"world", "world_seed", "head", "seed", "ptu", "rangefinder"};
    return std::find(read.begin(), read.end(), key) != read.end() ||
           reader_.read_known(sections, key, node) ||
           reader_.read_list("stand", key, node, extras_.stands, stand) ||
           reader_.read_list("waypoint", key, node, extras_.waypoints, waypoint_section) ||
           reader_.read_list("kidnap", key, node, scenario_.kidnaps, kidnap_section) ||
           reader_.read_list("fault", key, node, scenario_.faults, fault) ||
           reader_.read_list("fault_rate", key, node, scenario_.rates, rate);
  }

  void place_stands(const toml::table& file) {
    const std::vector<core::Point2>& way = extras_.waypoints;
    if (reader_.problem() || (way.empty() && extras_.stands.empty())) {
      return;
    }
    const bool stays = std::adjacent_find(way.begin(), way.end()) != way.end();
    if (!way.empty() && !extras_.stands.empty()) {
      reader_.refuse(file.get("waypoint")->source(),
                     "[[waypoint]] and [[stand]] both say where the sensor is put; remove one of them");
    } else if (!way.empty() && (way.size() < 2 || stays)) {
      reader_.refuse(file.get("waypoint")->source(),
                     "[[waypoint]]: a path has two or more, and no two after each other at one place");
    } else {
      scenario_.world.stands = way.empty() ? extras_.stands : stands_on_path(way, extras_.path_step_m);
    }
  }

  SectionReader reader_;
  std::filesystem::path folder_;
  std::optional<HeadKind> kind_;
  Scenario scenario_;
  ScenarioExtras extras_;
};

Scenario drive_through(WorldConfig world, std::optional<HeadKind> kind) {
  Scenario scenario;
  scenario.world = std::move(world);
  scenario.head = head_profile(kind.value_or(HeadKind::Paper));
  return scenario;
}

}  // namespace

tl::expected<Scenario, WorldError> parse_scenario(std::string_view toml, std::string_view name,
                                                  const std::filesystem::path& folder,
                                                  std::optional<HeadKind> kind) {
  const auto file = parse_toml(toml, name);
  if (!file) {
    return tl::unexpected(file.error());
  }
  if (!file->contains("world")) {
    return parse_world(toml, name, folder).map([kind](WorldConfig world) {
      return drive_through(std::move(world), kind);
    });
  }
  return ScenarioReader(name, folder, kind).read(*file);
}

tl::expected<Scenario, WorldError> load_scenario(const std::filesystem::path& path,
                                                 std::optional<HeadKind> kind) {
  const auto text = read_text(path, "world or scenario file");
  if (!text) {
    return tl::unexpected(text.error());
  }
  return parse_scenario(*text, path.string(), path.parent_path(), kind);
}

std::optional<WorldError> find_problem(const Scenario& scenario) {
  const auto check = [&](std::string_view device, FaultKind kind) {
    return misfit(scenario.head, device, kind);
  };
  std::string wrong;
  for (const PlannedFault& fault : scenario.faults) {
    wrong = wrong.empty() ? check(fault.device, fault.kind) : wrong;
  }
  for (const FaultRate& rate : scenario.rates) {
    wrong = wrong.empty() ? check(rate.device, rate.kind) : wrong;
    wrong = wrong.empty() && !(rate.mean_gap_s > 0.0) ? "fault rate: mean gap must be above zero" : wrong;
  }
  return wrong.empty() ? std::nullopt : std::optional(WorldError{wrong});
}

}  // namespace slamsensor::tools
