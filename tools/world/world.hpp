#pragma once

#include "tools/world/ground.hpp"
#include "tools/world/movers.hpp"
#include "tools/world/population.hpp"
#include "tools/world/rangefinder.hpp"
#include "tools/world/shape_grid.hpp"
#include "tools/world/world_config.hpp"

#include <Eigen/Core>
#include <tl/expected.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace slamsensor::tools {

/// A simulated piece of country that a rangefinder can be pointed at. Immutable after `create`; any number of
/// threads may ask, each with its own Random. Equal configurations are equal worlds. Frame W: x, y
/// horizontal, z up, m.
class World {
 public:
  /// The world of `config`, or the key that is out of its range.
  [[nodiscard]] static tl::expected<World, WorldError> create(const WorldConfig& config);

  /// What the rangefinder at `origin_W`, pointed along the unit vector `direction_W`, reads at `time_s`: the
  /// nearest of ground, objects, walls and movers, through the configured beam, noise, resolution, limits and
  /// drop-outs.
  [[nodiscard]] Range cast(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W, double time_s,
                           Random& rng) const noexcept;

  /// The exact end of an infinitely thin ray, nearer than `limit_m` (below 1e5). `ray_key` decides how far it
  /// gets in porous bodies: equal arguments, equal hits.
  [[nodiscard]] Hit trace(const Ray& ray, double time_s, double limit_m,
                          std::uint64_t ray_key) const noexcept;

  /// Height of the ground, m.
  [[nodiscard]] double ground_height_m(double x_m, double y_m) const noexcept {
    return ground_.height_m(x_m, y_m);
  }

  /// True when no stem, bush, rock, post or wall is nearer to `p_W` than `clearance_m` on the ground. Crowns
  /// and movers do not count.
  [[nodiscard]] bool is_free(const core::Point2& p_W, double clearance_m) const noexcept {
    return population_.footprints.is_clear(p_W, clearance_m);
  }

  [[nodiscard]] const WorldConfig& config() const noexcept { return config_; }
  [[nodiscard]] std::span<const Object> objects() const noexcept { return population_.objects; }
  [[nodiscard]] std::span<const MoverConfig> movers() const noexcept { return population_.movers; }

  /// Objects and movers that the configuration asks for and that found no room.
  [[nodiscard]] std::uint32_t unplaced() const noexcept { return population_.unplaced; }

 private:
  explicit World(const WorldConfig& config);

  WorldConfig config_;
  Ground ground_;
  Population population_;
  ShapeGrid shapes_;
  Movers movers_;
  BeamPattern beam_;
};

}  // namespace slamsensor::tools
