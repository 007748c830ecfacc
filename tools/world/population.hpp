#pragma once

#include "tools/world/ground.hpp"
#include "tools/world/shapes.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <vector>

namespace slamsensor::tools {

/// Circles and segments on the ground, kept in a grid so that "is there room here" costs the same in a full
/// world.
class Footprints {
 public:
  explicit Footprints(const AreaConfig& area);

  void add_circle(const core::Point2& centre_W, double radius_m);
  void add_wall(const WallConfig& wall);

  /// True when nothing is nearer to `centre_W` than `reach_m`, measured from the rim of each circle. On a
  /// wall, and inside a circle, the distance is zero or less.
  [[nodiscard]] bool is_clear(const core::Point2& centre_W, double reach_m) const noexcept;

 private:
  struct Circle {
    core::Point2 centre_W;
    double radius_m;
    std::uint32_t next;  // in the same cell
  };

  [[nodiscard]] std::size_t column(double x_m) const noexcept;
  [[nodiscard]] std::size_t row(double y_m) const noexcept;

  AreaConfig area_;
  double cell_m_;
  std::size_t columns_;
  std::size_t rows_;
  double radius_max_m_ = 0.0;
  std::vector<std::uint32_t> first_;  // per cell
  std::vector<Circle> circles_;
  std::vector<WallConfig> walls_;
};

/// Distance from `p_W` to the segment under `wall`, m.
[[nodiscard]] double distance_to_wall_m(const core::Point2& p_W, const WallConfig& wall) noexcept;

/// Where a mover is and which way it goes, in W.
struct MoverPlace {
  core::Point2 position_W;
  Eigen::Vector2d forward_W;  ///< unit vector
};

/// Length of the way after which `path` repeats itself or turns back, m: the straight line or the
/// circumference.
[[nodiscard]] double path_length_m(const MoverConfig& path) noexcept;

/// The place after `way_m` of `path`. Straight paths are walked to and fro.
[[nodiscard]] MoverPlace place_on_path(const MoverConfig& path, double way_m) noexcept;

/// The place of `mover` at `time_s`.
[[nodiscard]] MoverPlace place_at(const MoverConfig& mover, double time_s) noexcept;

/// Everything that moves. Immutable: where things are is a function of the time.
class Movers {
 public:
  struct Hit {
    double distance_m = kMiss;
    Surface surface = Surface::None;
    std::uint32_t mover = 0;  ///< index into the movers given at construction
  };

  Movers(const std::vector<MoverConfig>& movers, const BodyConfig& bodies);

  /// The first mover that `ray` meets before `limit_m` at `time_s`, or a Hit without a surface.
  [[nodiscard]] Hit first_hit(const Ray& ray, double limit_m, double time_s,
                              const Ground& ground) const noexcept;

 private:
  struct Item {
    MoverConfig config;
    core::Point2 bound_centre_W;  // the body never leaves this circle
    double bound_radius_m;
  };

  [[nodiscard]] Chord body_chord(const Ray& ray, const Item& item, double time_s,
                                 const Ground& ground) const noexcept;

  std::vector<Item> items_;
  BodyConfig bodies_;
};

/// What stands in a world, and what did not find room.
struct Population {
  std::vector<Object> objects;      ///< given stems, rows, trees, rocks, bushes, posts, in this order
  std::vector<MoverConfig> movers;  ///< the given ones, then those drawn by chance
  Footprints footprints;
  std::uint32_t unplaced = 0;  ///< objects and movers that chance found no place for
};

/// Fills the area of `config` (which is valid): random objects keep `area.clearance_m` between footprints and
/// the spacing of their kind between centres, and stay off walls. Given stems and rows are taken as they are,
/// but those outside the area are left out. Each kind has its own random stream. Dart throwing with a bounded
/// number of darts.
[[nodiscard]] Population populate(const WorldConfig& config, const Ground& ground);

}  // namespace slamsensor::tools
