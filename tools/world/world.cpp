#include "tools/world/world.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slamsensor::tools {

BeamPattern::BeamPattern(const RangefinderConfig& config) noexcept
    : count(std::clamp(config.sub_rays, 1U, kSubRaysMax)) {
  constexpr double kGoldenAngle_rad = 2.399963229728653;
  const double half_width = std::tan(0.5 * config.divergence_rad);
  for (std::uint32_t i = 1; i < count; ++i) {
    const double radius = half_width * std::sqrt(static_cast<double>(i) / (count - 1));
    lean[i] = {radius * std::cos(i * kGoldenAngle_rad), radius * std::sin(i * kGoldenAngle_rad)};
  }
}

double combine_sub_rays(const RangefinderConfig& config, std::span<const double> distances_m,
                        Random& rng) noexcept {
  const double mean_m =
      std::accumulate(distances_m.begin(), distances_m.end(), 0.0) / static_cast<double>(distances_m.size());
  const auto [near, far] = std::minmax_element(distances_m.begin(), distances_m.end());
  if (*far - *near <= config.mixed_gap_m || draw_unit(rng) < config.mixed_share) {
    return mean_m;
  }
  return distances_m[static_cast<std::size_t>(draw_unit(rng) * static_cast<double>(distances_m.size()))];
}

double disturb(const RangefinderConfig& config, double distance_m, Random& rng) noexcept {
  double range_m = distance_m;
  if (config.noise_sigma_m > 0.0) {
    range_m += config.noise_sigma_m * draw_normal(rng);
  }
  if (config.resolution_m > 0.0) {
    range_m = config.resolution_m * std::floor(range_m / config.resolution_m + 0.5);
  }
  const bool measurable =
      distance_m >= config.range_min_m && distance_m <= config.range_max_m && range_m >= 0.0;
  return measurable && range_m <= config.range_max_m ? range_m : core::Reading::kNoReturn;
}

namespace {

constexpr std::uint64_t kGroundStream = 1;
constexpr double kRoot_m =
    1.0;  // stems, posts and walls reach this far down, so that no slope shows a gap under them
constexpr double kBushSunk_share = 0.1;

void append_tree(std::vector<Shape>& shapes, const Object& tree, std::uint32_t index,
                 const TreeConfig& config) {
  const double foot_m = tree.ground_m;
  shapes.push_back({ShapeForm::Cylinder, Surface::Stem, index, tree.x_m, tree.y_m, foot_m - kRoot_m,
                    foot_m + tree.height_m, tree.radius_m, 0.0, 0.0, 0.0});
  if (config.crown_stops_per_m > 0.0 && tree.crown_radius_m > 0.0) {
    shapes.push_back({ShapeForm::Spheroid, Surface::Crown, index, tree.x_m, tree.y_m,
                      foot_m + tree.crown_base_m, foot_m + tree.height_m, tree.crown_radius_m, 0.0, 0.0,
                      config.crown_stops_per_m});
  }
}

void append_object(std::vector<Shape>& shapes, const Object& o, std::uint32_t index,
                   const WorldConfig& config) {
  const double top_m = o.ground_m + o.height_m;
  if (o.kind == Surface::Stem) {
    append_tree(shapes, o, index, config.trees);
  } else if (o.kind == Surface::Post) {
    shapes.push_back({ShapeForm::Cylinder, Surface::Post, index, o.x_m, o.y_m, o.ground_m - kRoot_m, top_m,
                      o.radius_m, 0.0, 0.0, 0.0});
  } else if (o.kind == Surface::Rock) {
    shapes.push_back({ShapeForm::Spheroid, Surface::Rock, index, o.x_m, o.y_m, o.ground_m - o.height_m, top_m,
                      o.radius_m, 0.0, 0.0, 0.0});
  } else {
    shapes.push_back({ShapeForm::Spheroid, Surface::Bush, index, o.x_m, o.y_m,
                      o.ground_m - kBushSunk_share * o.height_m, top_m, o.radius_m, 0.0, 0.0,
                      config.bushes.stops_per_m});
  }
}

Shape wall_shape(const WallConfig& wall, std::uint32_t index, const Ground& ground) {
  constexpr int kSamples = 32;
  double low_m = kMiss;
  double high_m = -kMiss;
  for (int i = 0; i <= kSamples; ++i) {
    const double share = static_cast<double>(i) / kSamples;
    const double height_m = ground.height_m(wall.x1_m + share * (wall.x2_m - wall.x1_m),
                                            wall.y1_m + share * (wall.y2_m - wall.y1_m));
    low_m = std::min(low_m, height_m);
    high_m = std::max(high_m, height_m);
  }
  return {ShapeForm::Wall,
          Surface::Wall,
          index,
          wall.x1_m,
          wall.y1_m,
          low_m - kRoot_m,
          high_m + wall.height_m,
          0.0,
          wall.x2_m - wall.x1_m,
          wall.y2_m - wall.y1_m,
          0.0};
}

std::vector<Shape> shapes_of(const WorldConfig& config, const Population& population, const Ground& ground) {
  std::vector<Shape> shapes;
  for (std::size_t i = 0; i < population.objects.size(); ++i) {
    append_object(shapes, population.objects[i], static_cast<std::uint32_t>(i), config);
  }
  for (std::size_t i = 0; i < config.walls.size(); ++i) {
    shapes.push_back(wall_shape(config.walls[i], static_cast<std::uint32_t>(i), ground));
  }
  return shapes;
}

/// The sub-ray that leans from `axis_W` by the tangents `lean` to the side and up.
Eigen::Vector3d leaning(const Eigen::Vector3d& axis_W, const std::array<double, 2>& lean) noexcept {
  const Eigen::Vector3d reference =
      std::abs(axis_W.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d side = reference.cross(axis_W).normalized();
  const Eigen::Vector3d up = axis_W.cross(side);
  return (axis_W + lean[0] * side + lean[1] * up).normalized();
}

}  // namespace

World::World(const WorldConfig& config)
    : config_(config),
      ground_(config.ground, mix_seed(config.seed, kGroundStream)),
      population_(populate(config_, ground_)),
      shapes_(shapes_of(config_, population_, ground_)),
      movers_(population_.movers, config.bodies),
      beam_(config.rangefinder) {
}

tl::expected<World, WorldError> World::create(const WorldConfig& config) {
  if (auto problem = find_problem(config)) {
    return tl::unexpected(std::move(*problem));
  }
  return World(config);
}

Hit World::trace(const Ray& ray, double time_s, double limit_m, std::uint64_t ray_key) const noexcept {
  // The ground is the dearest to search: what stands before it first, with a cheap bound instead.
  const double reach_m = std::min(limit_m, ground_.distance_bound_m(ray));
  Hit nearest = shapes_.first_hit(ray, reach_m, ray_key);
  const Movers::Hit moving = movers_.first_hit(ray, std::min(reach_m, nearest.distance_m), time_s, ground_);
  if (moving.surface != Surface::None) {
    nearest = {moving.distance_m, moving.surface, moving.mover};
  }
  const double ground_m = ground_.distance_m(ray, std::min(limit_m, nearest.distance_m));
  return ground_m < std::min(limit_m, nearest.distance_m) ? Hit{ground_m, Surface::Ground, 0} : nearest;
}

Range World::cast(const Eigen::Vector3d& origin_W, const Eigen::Vector3d& direction_W, double time_s,
                  Random& rng) const noexcept {
  const RangefinderConfig& finder = config_.rangefinder;
  const std::uint64_t ray_key = rng();
  const bool dropped = draw_unit(rng) < finder.drop_out_share;
  const Hit axis = trace({origin_W, direction_W}, time_s, finder.range_max_m, ray_key);
  Range result{core::Reading::kNoReturn, axis.surface, axis.index};
  std::array<double, kSubRaysMax> found_m{axis.distance_m};
  std::size_t found = axis.surface != Surface::None ? 1 : 0;
  for (std::uint32_t i = 1; i < beam_.count; ++i) {
    const Ray sub_ray{origin_W, leaning(direction_W, beam_.lean[i])};
    const Hit hit = trace(sub_ray, time_s, finder.range_max_m, mix_seed(ray_key, i));
    if (hit.surface != Surface::None) {
      found_m[found++] = hit.distance_m;
    }
  }
  if (!dropped && found > 0) {
    result.range_m = disturb(finder, combine_sub_rays(finder, {found_m.data(), found}, rng), rng);
  }
  return result;
}

}  // namespace slamsensor::tools
