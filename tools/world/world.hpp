#pragma once

#include "core/reading.hpp"
#include "tools/world/ground.hpp"
#include "tools/world/population.hpp"
#include "tools/world/random.hpp"
#include "tools/world/shapes.hpp"
#include "tools/world/world_config.hpp"

#include <Eigen/Core>
#include <tl/expected.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace slamsensor::tools {

inline constexpr std::uint32_t kSubRaysMax = 16;

/// What the rangefinder says of one shot, and, for the tests, what it was that its beam's axis met.
struct Range {
  double range_m = core::Reading::kNoReturn;
  Surface surface = Surface::None;  ///< the truth, also when there is no return
  std::uint32_t index = 0;          ///< of the object, wall or mover

  [[nodiscard]] bool has_return() const noexcept { return range_m >= 0.0; }
};

/// Tangents by which the sub-rays lean away from the beam's axis, to the side and up. The first is the axis;
/// the others fill the cone of `divergence_rad` evenly (a sunflower).
struct BeamPattern {
  explicit BeamPattern(const RangefinderConfig& config) noexcept;

  std::array<std::array<double, 2>, kSubRaysMax> lean{};
  std::uint32_t count = 1;
};

/// One distance out of those that the sub-rays found (m, only the ones that found something; not empty):
/// their mean when they agree within `mixed_gap_m`; else, by chance, the mean of all of them, which may be
/// between two things (a mixed pixel), or the distance of one.
[[nodiscard]] double combine_sub_rays(const RangefinderConfig& config, std::span<const double> distances_m,
                                      Random& rng) noexcept;

/// The reading for a true distance: noise, quantisation, limits. core::Reading::kNoReturn outside the limits.
[[nodiscard]] double disturb(const RangefinderConfig& config, double distance_m, Random& rng) noexcept;

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
