#include "tools/world/world_config.hpp"

#include "core/config.hpp"
#include "tools/world/toml_file.hpp"
#include "tools/world/world.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

namespace slamsensor::tools {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\"";
  const std::size_t first = text.find_first_not_of(kBlank);
  return first == std::string_view::npos ? std::string_view{}
                                         : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// Cuts the part before the next `mark` off `rest`; the whole of it when there is none.
std::string_view take_until(std::string_view& rest, char mark) {
  const std::size_t end = std::min(rest.find(mark), rest.size());
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (!line.empty()) {
    cells.push_back(trimmed(take_until(line, ',')));
  }
  return cells;
}

std::optional<std::size_t> find_column(const std::vector<std::string_view>& cells, std::string_view name) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string_view word = cells[i].substr(0, cells[i].find(' '));
    if (word == name || (word.size() == name.size() + 2 && word.starts_with(name) && word.ends_with("_m"))) {
      return i;
    }
  }
  return std::nullopt;
}

std::optional<double> number_in(const std::vector<std::string_view>& cells, std::size_t column) {
  double number = 0.0;
  if (column >= cells.size()) {
    return std::nullopt;
  }
  const std::string_view cell = cells[column];
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  const bool whole = error == std::errc{} && end == cell.data() + cell.size();
  return whole && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

}  // namespace

tl::expected<std::vector<core::Point2>, WorldError> parse_stems(std::string_view csv, std::string_view name) {
  std::string_view header = trimmed(take_until(csv, '\n'));
  header.remove_prefix(header.starts_with('#') ? 1 : 0);
  const std::vector<std::string_view> names = cells_of(header);
  const auto x = find_column(names, "x");
  const auto y = find_column(names, "y");
  if (!x || !y) {
    return tl::unexpected(
        WorldError{std::string(name) + ":1: the first line must name columns x and y, or x_m and y_m"});
  }
  std::vector<core::Point2> stems;
  for (std::size_t line = 2; !csv.empty(); ++line) {
    const std::string_view row = trimmed(take_until(csv, '\n'));
    if (row.empty() || row.starts_with('#')) {
      continue;
    }
    const std::vector<std::string_view> cells = cells_of(row);
    const auto x_m = number_in(cells, *x);
    const auto y_m = number_in(cells, *y);
    if (!x_m || !y_m) {
      return tl::unexpected(WorldError{std::string(name) + ":" + std::to_string(line) +
                                       ": no number in column x or y; correct or remove the line"});
    }
    stems.emplace_back(*x_m, *y_m);
  }
  return stems;
}

tl::expected<std::vector<core::Point2>, WorldError> load_stems(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return tl::unexpected(WorldError{path.string() +
                                     ": cannot be opened; trees.stems_csv is looked for in the " +
                                     "folder of the world file"});
  }
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return parse_stems(text, path.string());
}

namespace {

using core::kDegree;
constexpr double kFar_m = 1e5;
constexpr double kDensityMax_per_ha = 20'000.0;
constexpr double kSizeMin_m = 0.01;

void read_area(TomlTable& table, AreaConfig& area) {
  table.number("x_min_m", area.x_min_m, -kFar_m, kFar_m)
      .number("x_max_m", area.x_max_m, -kFar_m, kFar_m)
      .number("y_min_m", area.y_min_m, -kFar_m, kFar_m)
      .number("y_max_m", area.y_max_m, -kFar_m, kFar_m)
      .number("clearance_m", area.clearance_m, 0.0, 100.0);
}

void read_ground(TomlTable& table, GroundConfig& ground) {
  table.number("amplitude_m", ground.amplitude_m, 0.0, 50.0)
      .count("waves", ground.waves, 0.0, 16.0)
      .number("slope_x", ground.slope_x, -1.0, 1.0)
      .number("slope_y", ground.slope_y, -1.0, 1.0)
      .interval("wavelength", "m", ground.wavelength_m, 1.0, kFar_m);
}

void read_trees(TomlTable& table, TreeConfig& trees) {
  table.number("density_per_ha", trees.density_per_ha, 0.0, kDensityMax_per_ha)
      .number("spacing_m", trees.spacing_m, 0.0, 1000.0)
      .number("crown_base_share", trees.crown_base_share, 0.0, 0.95)
      .number("crown_stops_per_m", trees.crown_stops_per_m, 0.0, 1000.0)
      .text("stems_csv", trees.stems_csv)
      .interval("radius", "m", trees.radius_m, kSizeMin_m, 10.0)
      .interval("height", "m", trees.height_m, 0.1, 150.0)
      .interval("crown_radius", "m", trees.crown_radius_m, 0.0, 30.0);
}

void read_rows(TomlTable& table, RowsConfig& rows) {
  table.number("spacing_m", rows.spacing_m, 0.0, 1000.0)
      .number("step_m", rows.step_m, 0.2, 1000.0)
      .number("jitter_m", rows.jitter_m, 0.0, 100.0)
      .number("heading_deg", rows.heading_rad, -360.0, 360.0, kDegree);
}

/// Bushes, rocks and posts share most of their keys.
template <typename Kind>
void read_kind(TomlTable& table, Kind& kind) {
  table.number("density_per_ha", kind.density_per_ha, 0.0, kDensityMax_per_ha)
      .number("spacing_m", kind.spacing_m, 0.0, 1000.0)
      .interval("radius", "m", kind.radius_m, kSizeMin_m, 20.0)
      .interval("height", "m", kind.height_m, kSizeMin_m, 50.0);
}

void read_bushes(TomlTable& table, BushConfig& bushes) {
  read_kind(table, bushes);
  table.number("stops_per_m", bushes.stops_per_m, 0.0, 1000.0);
}

void read_crowd(TomlTable& table, CrowdConfig& crowd) {
  table.count("count", crowd.count, 0.0, 1000.0)
      .number("circle_share", crowd.circle_share, 0.0, 1.0)
      .interval("speed", "mps", crowd.speed_mps, 0.0, 100.0)
      .interval("path", "m", crowd.path_m, 0.5, 10'000.0);
}

void read_bodies(TomlTable& table, BodyConfig& bodies) {
  table.number("person_radius_m", bodies.person_radius_m, kSizeMin_m, 5.0)
      .number("person_height_m", bodies.person_height_m, 0.1, 10.0)
      .number("car_length_m", bodies.car_length_m, 0.1, 50.0)
      .number("car_width_m", bodies.car_width_m, 0.1, 20.0)
      .number("car_height_m", bodies.car_height_m, 0.1, 20.0);
}

void read_rangefinder(TomlTable& table, RangefinderConfig& finder) {
  table.number("noise_sigma_m", finder.noise_sigma_m, 0.0, 10.0)
      .number("resolution_m", finder.resolution_m, 0.0, 10.0)
      .number("range_min_m", finder.range_min_m, 0.0, 1000.0)
      .number("range_max_m", finder.range_max_m, 1.0, 5000.0)
      .number("divergence_deg", finder.divergence_rad, 0.0, 20.0, kDegree)
      .count("sub_rays", finder.sub_rays, 1.0, kSubRaysMax)
      .number("mixed_share", finder.mixed_share, 0.0, 1.0)
      .number("mixed_gap_m", finder.mixed_gap_m, 0.0, 100.0)
      .number("drop_out_share", finder.drop_out_share, 0.0, 1.0);
}

void read_wall(TomlTable& table, WallConfig& wall) {
  table.number("x1_m", wall.x1_m, -kFar_m, kFar_m)
      .number("y1_m", wall.y1_m, -kFar_m, kFar_m)
      .number("x2_m", wall.x2_m, -kFar_m, kFar_m)
      .number("y2_m", wall.y2_m, -kFar_m, kFar_m)
      .number("height_m", wall.height_m, kSizeMin_m, 200.0);
}

void read_mover(TomlTable& table, MoverConfig& mover) {
  table.choice("kind", mover.kind, {"person", "car"})
      .number("x1_m", mover.x1_m, -kFar_m, kFar_m)
      .number("y1_m", mover.y1_m, -kFar_m, kFar_m)
      .number("x2_m", mover.x2_m, -kFar_m, kFar_m)
      .number("y2_m", mover.y2_m, -kFar_m, kFar_m)
      .number("circle_radius_m", mover.circle_radius_m, 0.0, 10'000.0)
      .number("speed_mps", mover.speed_mps, -100.0, 100.0)
      .number("offset_m", mover.offset_m, -kFar_m, kFar_m);
}

/// Reads `file` into `config`, and checks what it does not name.
std::optional<WorldError> read_world(TomlFile& file, WorldConfig& config) {
  constexpr double kSeedMax = 0x1.0p63;  // TOML integers are signed
  file.top().count("seed", config.seed, 0.0, kSeedMax);
  file.table("area", config.area, read_area);
  file.table("ground", config.ground, read_ground);
  file.table("trees", config.trees, read_trees);
  file.table("rows", config.rows, read_rows);
  file.table("bushes", config.bushes, read_bushes);
  file.table("rocks", config.rocks, read_kind<RockConfig>);
  file.table("posts", config.posts, read_kind<PostConfig>);
  file.table("people", config.people, read_crowd);
  file.table("cars", config.cars, read_crowd);
  file.table("bodies", config.bodies, read_bodies);
  file.table("rangefinder", config.rangefinder, read_rangefinder);
  file.list("wall", config.walls, read_wall);
  file.list("mover", config.movers, read_mover);
  file.list("stand", config.stands, read_stand);
  return file.finish();
}

}  // namespace

void read_stand(TomlTable& table, StandConfig& stand) {
  table.number("x_m", stand.pose_W.x_m, -kFar_m, kFar_m)
      .number("y_m", stand.pose_W.y_m, -kFar_m, kFar_m)
      .number("heading_deg", stand.pose_W.heading_rad, -360.0, 360.0, kDegree);
}

namespace {

constexpr double kObjectsMax = 1e6;
constexpr double kReach_m = 1e5;

std::optional<WorldError> find_area_problem(const WorldConfig& config) {
  const AreaConfig& area = config.area;
  if (area.x_min_m >= area.x_max_m || area.y_min_m >= area.y_max_m) {
    return WorldError{"area is empty: x_min_m must be below x_max_m, and y_min_m below y_max_m"};
  }
  const RowsConfig& rows = config.rows;
  if (rows.spacing_m > 0.0 && rows.spacing_m < 0.2) {
    return WorldError{"rows.spacing_m = " + text_of(rows.spacing_m) +
                      " is out of range: 0 for no rows, or at least 0.2"};
  }
  const double per_ha = config.trees.density_per_ha + config.bushes.density_per_ha +
                        config.rocks.density_per_ha + config.posts.density_per_ha +
                        (rows.spacing_m > 0.0 ? 1e4 / (rows.spacing_m * rows.step_m) : 0.0);
  const double objects = per_ha * area.hectares() + static_cast<double>(config.stems.size());
  if (objects > kObjectsMax) {
    return WorldError{"the densities ask for " + text_of(std::round(objects)) +
                      " objects, more than 1000000; lower a density_per_ha or shrink the area"};
  }
  return std::nullopt;
}

}  // namespace

std::optional<WorldError> find_problem(const WorldConfig& config) {
  WorldConfig copy = config;  // reading could change it
  TomlFile no_file;
  if (auto problem = read_world(no_file, copy)) {
    return problem;
  }
  for (const core::Point2& stem_W : copy.stems) {
    if (!(stem_W.cwiseAbs().maxCoeff() <= kReach_m) || !stem_W.allFinite()) {
      return WorldError{"a stem is not within 100 km of the origin; subtract an offset from its coordinates"};
    }
  }
  return find_area_problem(copy);
}

tl::expected<WorldConfig, WorldError> parse_world(std::string_view toml, std::string_view name,
                                                  const std::filesystem::path& folder) {
  const auto root = parse_toml(toml, name);
  if (!root) {
    return tl::unexpected(root.error());
  }
  if (root->empty()) {
    return tl::unexpected(
        WorldError{std::string(name) + ": is empty; a world names its trees, see config/worlds"});
  }
  WorldConfig config;
  TomlFile file(*root, name);
  if (auto problem = read_world(file, config)) {
    return tl::unexpected(std::move(*problem));
  }
  if (!config.trees.stems_csv.empty()) {
    auto stems = load_stems(folder / config.trees.stems_csv);
    if (!stems) {
      return tl::unexpected(std::move(stems.error()));
    }
    config.stems = std::move(*stems);
  }
  if (auto problem = find_problem(config)) {
    return tl::unexpected(WorldError{std::string(name) + ": " + problem->message});
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
