#include "tools/world/world_fields.hpp"

#include "tools/world/rangefinder.hpp"

#include <cmath>
#include <numbers>

namespace slamsensor::tools {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kFar_m = 1e5;
constexpr double kDensityMax_per_ha = 20'000.0;
constexpr double kSizeMin_m = 0.01;

void add_interval(Section& section, const std::string& name, const std::string& unit, Interval& interval,
                  double min, double max) {
  section.fields.push_back({name + "_min_" + unit, &interval.min, min, max});
  section.fields.push_back({name + "_max_" + unit, &interval.max, min, max});
  section.intervals.emplace_back(name, &interval);
}

Section area_section(AreaConfig& area) {
  return {"area",
          {{"x_min_m", &area.x_min_m, -kFar_m, kFar_m},
           {"x_max_m", &area.x_max_m, -kFar_m, kFar_m},
           {"y_min_m", &area.y_min_m, -kFar_m, kFar_m},
           {"y_max_m", &area.y_max_m, -kFar_m, kFar_m},
           {"clearance_m", &area.clearance_m, 0.0, 100.0}},
          {}};
}

Section ground_section(GroundConfig& ground) {
  Section section{"ground",
                  {{"amplitude_m", &ground.amplitude_m, 0.0, 50.0},
                   {"waves", &ground.waves, 0.0, 16.0},
                   {"slope_x", &ground.slope_x, -1.0, 1.0},
                   {"slope_y", &ground.slope_y, -1.0, 1.0}},
                  {}};
  add_interval(section, "wavelength", "m", ground.wavelength_m, 1.0, kFar_m);
  return section;
}

Section trees_section(TreeConfig& trees) {
  Section section{"trees",
                  {{"density_per_ha", &trees.density_per_ha, 0.0, kDensityMax_per_ha},
                   {"spacing_m", &trees.spacing_m, 0.0, 1000.0},
                   {"crown_base_share", &trees.crown_base_share, 0.0, 0.95},
                   {"crown_stops_per_m", &trees.crown_stops_per_m, 0.0, 1000.0},
                   {"stems_csv", &trees.stems_csv}},
                  {}};
  add_interval(section, "radius", "m", trees.radius_m, kSizeMin_m, 10.0);
  add_interval(section, "height", "m", trees.height_m, 0.1, 150.0);
  add_interval(section, "crown_radius", "m", trees.crown_radius_m, 0.0, 30.0);
  return section;
}

Section rows_section(RowsConfig& rows) {
  return {"rows",
          {{"spacing_m", &rows.spacing_m, 0.0, 1000.0},
           {"step_m", &rows.step_m, 0.2, 1000.0},
           {"jitter_m", &rows.jitter_m, 0.0, 100.0},
           {"heading_deg", &rows.heading_rad, -360.0, 360.0, kDegree}},
          {}};
}

/// Bushes, rocks and posts share most of their keys.
template <typename Kind>
Section kind_section(const std::string& name, Kind& kind) {
  Section section{name,
                  {{"density_per_ha", &kind.density_per_ha, 0.0, kDensityMax_per_ha},
                   {"spacing_m", &kind.spacing_m, 0.0, 1000.0}},
                  {}};
  add_interval(section, "radius", "m", kind.radius_m, kSizeMin_m, 20.0);
  add_interval(section, "height", "m", kind.height_m, kSizeMin_m, 50.0);
  return section;
}

Section bushes_section(BushConfig& bushes) {
  Section section = kind_section("bushes", bushes);
  section.fields.push_back({"stops_per_m", &bushes.stops_per_m, 0.0, 1000.0});
  return section;
}

Section crowd_section(const std::string& name, CrowdConfig& crowd) {
  Section section{
      name, {{"count", &crowd.count, 0.0, 1000.0}, {"circle_share", &crowd.circle_share, 0.0, 1.0}}, {}};
  add_interval(section, "speed", "mps", crowd.speed_mps, 0.0, 100.0);
  add_interval(section, "path", "m", crowd.path_m, 0.5, 10'000.0);
  return section;
}

Section bodies_section(BodyConfig& bodies) {
  return {"bodies",
          {{"person_radius_m", &bodies.person_radius_m, kSizeMin_m, 5.0},
           {"person_height_m", &bodies.person_height_m, 0.1, 10.0},
           {"car_length_m", &bodies.car_length_m, 0.1, 50.0},
           {"car_width_m", &bodies.car_width_m, 0.1, 20.0},
           {"car_height_m", &bodies.car_height_m, 0.1, 20.0}},
          {}};
}

Section rangefinder_section(RangefinderConfig& finder) {
  return {"rangefinder",
          {{"noise_sigma_m", &finder.noise_sigma_m, 0.0, 10.0},
           {"resolution_m", &finder.resolution_m, 0.0, 10.0},
           {"range_min_m", &finder.range_min_m, 0.0, 1000.0},
           {"range_max_m", &finder.range_max_m, 1.0, 5000.0},
           {"divergence_deg", &finder.divergence_rad, 0.0, 20.0, kDegree},
           {"sub_rays", &finder.sub_rays, 1.0, kSubRaysMax},
           {"mixed_share", &finder.mixed_share, 0.0, 1.0},
           {"mixed_gap_m", &finder.mixed_gap_m, 0.0, 100.0},
           {"drop_out_share", &finder.drop_out_share, 0.0, 1.0}},
          {}};
}

}  // namespace

std::vector<Section> sections_of(WorldConfig& config) {
  constexpr double kSeedMax = 0x1.0p63;  // TOML integers are signed
  return {{"", {{"seed", &config.seed, 0.0, kSeedMax}}, {}},
          area_section(config.area),
          ground_section(config.ground),
          trees_section(config.trees),
          rows_section(config.rows),
          bushes_section(config.bushes),
          kind_section("rocks", config.rocks),
          kind_section("posts", config.posts),
          crowd_section("people", config.people),
          crowd_section("cars", config.cars),
          bodies_section(config.bodies),
          rangefinder_section(config.rangefinder)};
}

Section section_of(WallConfig& wall) {
  return {"wall",
          {{"x1_m", &wall.x1_m, -kFar_m, kFar_m},
           {"y1_m", &wall.y1_m, -kFar_m, kFar_m},
           {"x2_m", &wall.x2_m, -kFar_m, kFar_m},
           {"y2_m", &wall.y2_m, -kFar_m, kFar_m},
           {"height_m", &wall.height_m, kSizeMin_m, 200.0}},
          {}};
}

Section section_of(MoverConfig& mover) {
  return {"mover",
          {{"kind", choice_of(mover.kind, {"person", "car"})},
           {"x1_m", &mover.x1_m, -kFar_m, kFar_m},
           {"y1_m", &mover.y1_m, -kFar_m, kFar_m},
           {"x2_m", &mover.x2_m, -kFar_m, kFar_m},
           {"y2_m", &mover.y2_m, -kFar_m, kFar_m},
           {"circle_radius_m", &mover.circle_radius_m, 0.0, 10'000.0},
           {"speed_mps", &mover.speed_mps, -100.0, 100.0},
           {"offset_m", &mover.offset_m, -kFar_m, kFar_m}},
          {}};
}

Section section_of(StandConfig& stand) {
  return {"stand",
          {{"x_m", &stand.pose_W.x_m, -kFar_m, kFar_m},
           {"y_m", &stand.pose_W.y_m, -kFar_m, kFar_m},
           {"heading_deg", &stand.pose_W.heading_rad, -360.0, 360.0, kDegree}},
          {}};
}

}  // namespace slamsensor::tools
