#include "tools/world/world_fields.hpp"

#include <cmath>

namespace slamsensor::tools {
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
  WorldConfig copy = config;  // the fields point to what may be written
  std::vector<Section> sections = sections_of(copy);
  for (WallConfig& wall : copy.walls) {
    sections.push_back(section_of(wall));
  }
  for (MoverConfig& mover : copy.movers) {
    sections.push_back(section_of(mover));
  }
  for (StandConfig& stand : copy.stands) {
    sections.push_back(section_of(stand));
  }
  for (const Section& section : sections) {
    if (auto problem = find_problem(section)) {
      return problem;
    }
  }
  for (const core::Point2& stem_W : copy.stems) {
    if (!(stem_W.cwiseAbs().maxCoeff() <= kReach_m) || !stem_W.allFinite()) {
      return WorldError{"a stem is not within 100 km of the origin; subtract an offset from its coordinates"};
    }
  }
  return find_area_problem(copy);
}

}  // namespace slamsensor::tools
