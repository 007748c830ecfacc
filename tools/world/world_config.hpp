#pragma once

#include "core/geometry/pose2.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// Why a world, a path or a simulation was refused: what, where and what to do, in one line.
struct WorldError {
  std::string message;
};

/// A closed interval that sizes are drawn from, uniformly.
struct Interval {
  double min = 0.0;
  double max = 0.0;
};

/// The rectangle that objects are placed in; the ground goes on beyond it.
struct AreaConfig {
  double x_min_m = -200.0;
  double x_max_m = 200.0;
  double y_min_m = -200.0;
  double y_max_m = 200.0;
  double clearance_m = 0.5;  ///< least gap between the footprints of two objects that were placed by chance

  [[nodiscard]] double hectares() const noexcept { return (x_max_m - x_min_m) * (y_max_m - y_min_m) * 1e-4; }
  [[nodiscard]] bool contains(double x_m, double y_m) const noexcept {
    return x_m >= x_min_m && x_m <= x_max_m && y_m >= y_min_m && y_m <= y_max_m;
  }
};

/// Ground height: a plane through the origin plus a sum of seeded sine waves.
struct GroundConfig {
  double amplitude_m = 0.0;  ///< of all waves together: the ground never leaves the plane by more
  std::uint32_t waves = 4;
  Interval wavelength_m{20.0, 80.0};
  double slope_x = 0.0;  ///< m of height per m along x
  double slope_y = 0.0;
};

/// Trees: a stem is a vertical cylinder, a crown a spheroid around its upper part that stops a ray by chance.
struct TreeConfig {
  double density_per_ha = 0.0;
  double spacing_m = 2.0;  ///< least distance between the centres of two stems that were placed by chance
  Interval radius_m{0.1, 0.3};
  Interval height_m{8.0, 14.0};
  Interval crown_radius_m{1.5, 3.0};
  double crown_base_share = 0.5;   ///< the crown reaches from this share of the height to the top
  double crown_stops_per_m = 0.5;  ///< chance per metre of way that a ray is stopped
  std::string stems_csv;           ///< further stems, columns x,y or x_m,y_m; relative to the world's file
};

/// Trees on a rectangular lattice centred in the area; sizes are those of TreeConfig.
struct RowsConfig {
  double spacing_m = 0.0;  ///< between rows; 0 for none
  double step_m = 4.0;     ///< along a row
  double jitter_m = 0.0;   ///< each stem is off its lattice place by up to this, along both axes
  double heading_rad = 0.0;
};

/// Bushes: dense porous spheroids that stand on the ground.
struct BushConfig {
  double density_per_ha = 0.0;
  double spacing_m = 0.0;
  Interval radius_m{0.4, 1.2};
  Interval height_m{0.5, 2.0};
  double stops_per_m = 8.0;
};

/// Rocks: solid spheroids whose centre is at ground level.
struct RockConfig {
  double density_per_ha = 0.0;
  double spacing_m = 0.0;
  Interval radius_m{0.3, 1.0};
  Interval height_m{0.3, 1.0};  ///< above the ground
};

/// Posts: vertical cylinders with a flat top.
struct PostConfig {
  double density_per_ha = 0.0;
  double spacing_m = 0.0;
  Interval radius_m{0.05, 0.1};
  Interval height_m{1.2, 3.0};
};

/// A vertical rectangle above the segment from (x1, y1) to (x2, y2).
struct WallConfig {
  double x1_m = 0.0;
  double y1_m = 0.0;
  double x2_m = 0.0;
  double y2_m = 0.0;
  double height_m = 2.0;  ///< above the highest ground under it
};

enum class MoverKind : std::uint8_t { Person, Car };

/// A person (vertical cylinder) or a car (box) on a path: to and fro between two points, or round a circle.
struct MoverConfig {
  MoverKind kind = MoverKind::Person;
  double x1_m = 0.0;  ///< start, or the centre of the circle
  double y1_m = 0.0;
  double x2_m = 0.0;  ///< where a straight path turns back; unused on a circle
  double y2_m = 0.0;
  double circle_radius_m = 0.0;  ///< 0 for a straight path
  double speed_mps = 1.3;        ///< on a circle positive is counter-clockwise
  double offset_m = 0.0;         ///< way already gone at time 0
};

/// Movers whose paths are drawn by chance, clear of everything that stands.
struct CrowdConfig {
  std::uint32_t count = 0;
  Interval speed_mps{0.8, 1.6};
  Interval path_m{10.0, 40.0};  ///< length of a straight path, circumference of a round one
  double circle_share = 0.3;    ///< chance that a path is round
};

struct BodyConfig {
  double person_radius_m = 0.25;
  double person_height_m = 1.75;
  double car_length_m = 4.4;
  double car_width_m = 1.8;
  double car_height_m = 1.5;
};

/// What the rangefinder makes of the true distances. Defaults: the paper's MDL LaserAce IM HR.
struct RangefinderConfig {
  double noise_sigma_m = 0.1;
  double resolution_m = 0.1;  ///< readings are multiples of it; 0 for none
  double range_min_m = 0.5;   ///< nearer things give no return
  double range_max_m = 300.0;
  double divergence_rad = 0.003;  ///< full angle of the beam; without effect for one sub-ray
  std::uint32_t sub_rays = 1;     ///< 1 to 16 rays share the beam
  double mixed_share = 0.5;       ///< chance that sub-rays which disagree give a reading between them
  double mixed_gap_m = 0.5;       ///< sub-rays within this agree: the reading is their mean
  double drop_out_share = 0.0;    ///< chance that a reading is lost
};

/// A place the sensor is put at.
struct StandConfig {
  core::Pose2 pose_W;
};

/// All that makes a simulated world. Frame W: x, y horizontal, z up, m. The same values give the same world.
struct WorldConfig {
  std::uint64_t seed = 1;
  AreaConfig area;
  GroundConfig ground;
  TreeConfig trees;
  RowsConfig rows;
  BushConfig bushes;
  RockConfig rocks;
  PostConfig posts;
  CrowdConfig people;
  CrowdConfig cars{0, {3.0, 10.0}, {60.0, 150.0}, 0.5};
  BodyConfig bodies;
  RangefinderConfig rangefinder;
  std::vector<WallConfig> walls;
  std::vector<MoverConfig> movers;
  std::vector<StandConfig> stands;  ///< where the sensor is put, in order; empty: a path is drawn by chance
  std::vector<core::Point2> stems;  ///< trees at given places (m), besides those of the CSV
};

/// Stem positions, m, from a CSV whose first line names its columns, among them x and y, or x_m and y_m; a
/// leading '#' and what follows a name after a space are passed over, other columns are ignored, as are empty
/// lines and later lines that start with '#'. A row without two finite numbers there is refused with its
/// line.
[[nodiscard]] tl::expected<std::vector<core::Point2>, WorldError> load_stems(
    const std::filesystem::path& path);

/// The same from a text; `name` stands for the file in messages.
[[nodiscard]] tl::expected<std::vector<core::Point2>, WorldError> parse_stems(std::string_view csv,
                                                                              std::string_view name);

/// What is wrong with `config`, if anything: a value out of its range, an empty interval or area, too many
/// objects.
[[nodiscard]] std::optional<WorldError> find_problem(const WorldConfig& config);

/// The world that the TOML file `path` describes; what it does not name keeps its default. A key that is not
/// known, has another type or is out of range is refused with file, line and column. The stems of
/// `trees.stems_csv`, relative to the file's folder, are in `stems`.
[[nodiscard]] tl::expected<WorldConfig, WorldError> load_world(const std::filesystem::path& path);

/// The same from a text; `name` stands for the file in messages, and a relative `trees.stems_csv` is looked
/// for in `folder`.
[[nodiscard]] tl::expected<WorldConfig, WorldError> parse_world(std::string_view toml, std::string_view name,
                                                                const std::filesystem::path& folder);

}  // namespace slamsensor::tools
