#pragma once

#include "tools/world/world_config.hpp"

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

}  // namespace slamsensor::tools
