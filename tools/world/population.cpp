#include "tools/world/population.hpp"

#include "tools/world/movers.hpp"
#include "tools/world/random.hpp"

#include <cmath>
#include <numbers>

namespace slamsensor::tools {
namespace {

// Random streams of a world's seed. Values are part of the promise that a seed keeps its world.
enum Stream : std::uint64_t { kGivenStems = 10, kRows, kTrees, kRocks, kBushes, kPosts, kPeople, kCars };

constexpr std::uint32_t kDartsPerObject = 60;
constexpr std::uint32_t kPathsPerMover = 200;
constexpr double kPathSample_m = 0.25;

class Populator {
 public:
  Populator(const WorldConfig& config, const Ground& ground)
      : config_(config), ground_(ground), population_{{}, config.movers, Footprints(config.area), 0} {
    for (const WallConfig& wall : config.walls) {
      population_.footprints.add_wall(wall);
    }
  }

  Random random(Stream stream) const { return Random(mix_seed(config_.seed, stream)); }

  void add(Object object, const core::Point2& centre_W) {
    object.x_m = centre_W.x();
    object.y_m = centre_W.y();
    object.ground_m = ground_.height_m(object.x_m, object.y_m);
    population_.footprints.add_circle(centre_W, object.radius_m);
    population_.objects.push_back(object);
  }

  void add_if_inside(const Object& object, const core::Point2& centre_W) {
    if (config_.area.contains(centre_W.x(), centre_W.y())) {
      add(object, centre_W);
    }
  }

  /// Throws darts for objects that `make(rng)` draws until `density_per_ha` is reached or the darts are used
  /// up.
  template <typename Make>
  void scatter(Random rng, double density_per_ha, double spacing_m, const Make& make) {
    const AreaConfig& area = config_.area;
    Footprints same_kind(area);
    const auto count = static_cast<std::uint32_t>(std::lround(density_per_ha * area.hectares()));
    for (std::uint32_t i = 0; i < count; ++i) {
      const Object object = make(rng);
      bool placed = false;
      for (std::uint32_t dart = 0; dart < kDartsPerObject && !placed; ++dart) {
        const double x_m = draw_uniform(rng, area.x_min_m, area.x_max_m);
        const core::Point2 centre_W(x_m, draw_uniform(rng, area.y_min_m, area.y_max_m));
        placed = same_kind.is_clear(centre_W, spacing_m) &&
                 population_.footprints.is_clear(centre_W, object.radius_m + area.clearance_m);
        if (placed) {
          same_kind.add_circle(centre_W, 0.0);
          add(object, centre_W);
        }
      }
      population_.unplaced += placed ? 0 : 1;
    }
  }

  void add_movers(Random rng, const CrowdConfig& crowd, MoverKind kind, double body_radius_m) {
    for (std::uint32_t i = 0; i < crowd.count; ++i) {
      bool placed = false;
      for (std::uint32_t attempt = 0; attempt < kPathsPerMover && !placed; ++attempt) {
        const MoverConfig mover = draw_path(rng, crowd, kind);
        placed = path_is_clear(mover, body_radius_m);
        if (placed) {
          population_.movers.push_back(mover);
        }
      }
      population_.unplaced += placed ? 0 : 1;
    }
  }

  Population take() { return std::move(population_); }

 private:
  MoverConfig draw_path(Random& rng, const CrowdConfig& crowd, MoverKind kind) const {
    const AreaConfig& area = config_.area;
    MoverConfig mover;
    mover.kind = kind;
    mover.x1_m = draw_uniform(rng, area.x_min_m, area.x_max_m);
    mover.y1_m = draw_uniform(rng, area.y_min_m, area.y_max_m);
    const bool round = draw_unit(rng) < crowd.circle_share;
    const double bearing_rad = draw_uniform(rng, 0.0, 2.0 * std::numbers::pi);
    const double length_m = draw_uniform(rng, crowd.path_m.min, crowd.path_m.max);
    mover.speed_mps = draw_uniform(rng, crowd.speed_mps.min, crowd.speed_mps.max);
    mover.offset_m = draw_uniform(rng, 0.0, 2.0 * length_m);
    mover.x2_m = mover.x1_m + length_m * std::cos(bearing_rad);
    mover.y2_m = mover.y1_m + length_m * std::sin(bearing_rad);
    mover.circle_radius_m = round ? length_m / (2.0 * std::numbers::pi) : 0.0;
    return mover;
  }

  bool path_is_clear(const MoverConfig& path, double body_radius_m) const {
    const double length_m = path_length_m(path);
    const auto samples = static_cast<std::uint32_t>(length_m / kPathSample_m) + 1;
    for (std::uint32_t i = 0; i <= samples; ++i) {
      const core::Point2 p_W = place_on_path(path, length_m * i / samples).position_W;
      if (!config_.area.contains(p_W.x(), p_W.y()) || !population_.footprints.is_clear(p_W, body_radius_m)) {
        return false;
      }
    }
    return true;
  }

  const WorldConfig& config_;
  const Ground& ground_;
  Population population_;
};

double draw(Random& rng, const Interval& interval) {
  return draw_uniform(rng, interval.min, interval.max);
}

Object make_tree(Random& rng, const TreeConfig& trees) {
  Object tree;
  tree.kind = Surface::Stem;
  tree.radius_m = draw(rng, trees.radius_m);
  tree.height_m = draw(rng, trees.height_m);
  tree.crown_radius_m = draw(rng, trees.crown_radius_m);
  tree.crown_base_m = trees.crown_base_share * tree.height_m;
  return tree;
}

/// For bushes, rocks and posts, whose settings share their names.
template <typename Kind>
auto maker(Surface surface, const Kind& kind) {
  return [surface, &kind](Random& rng) {
    Object object;
    object.kind = surface;
    object.radius_m = draw(rng, kind.radius_m);
    object.height_m = draw(rng, kind.height_m);
    return object;
  };
}

void add_rows(Populator& populator, const WorldConfig& config) {
  const RowsConfig& rows = config.rows;
  if (rows.spacing_m <= 0.0) {
    return;
  }
  const AreaConfig& area = config.area;
  const core::Pose2 T_W_R{0.5 * (area.x_min_m + area.x_max_m), 0.5 * (area.y_min_m + area.y_max_m),
                          rows.heading_rad};
  const double reach_m = 0.5 * std::hypot(area.x_max_m - area.x_min_m, area.y_max_m - area.y_min_m);
  const auto along = static_cast<std::int32_t>(reach_m / rows.step_m);
  const auto across = static_cast<std::int32_t>(reach_m / rows.spacing_m);
  Random rng = populator.random(kRows);
  for (std::int32_t j = -across; j <= across; ++j) {
    for (std::int32_t i = -along; i <= along; ++i) {
      const Object tree = make_tree(rng, config.trees);
      const double dx_m = draw_uniform(rng, -rows.jitter_m, rows.jitter_m);
      const double dy_m = draw_uniform(rng, -rows.jitter_m, rows.jitter_m);
      populator.add_if_inside(tree, T_W_R * core::Point2(i * rows.step_m + dx_m, j * rows.spacing_m + dy_m));
    }
  }
}

}  // namespace

Population populate(const WorldConfig& config, const Ground& ground) {
  Populator populator(config, ground);
  const auto make_any_tree = [&config](Random& rng) { return make_tree(rng, config.trees); };
  Random given = populator.random(kGivenStems);
  for (const core::Point2& stem_W : config.stems) {
    populator.add_if_inside(make_any_tree(given), stem_W);
  }
  add_rows(populator, config);
  populator.scatter(populator.random(kTrees), config.trees.density_per_ha, config.trees.spacing_m,
                    make_any_tree);
  populator.scatter(populator.random(kRocks), config.rocks.density_per_ha, config.rocks.spacing_m,
                    maker(Surface::Rock, config.rocks));
  populator.scatter(populator.random(kBushes), config.bushes.density_per_ha, config.bushes.spacing_m,
                    maker(Surface::Bush, config.bushes));
  populator.scatter(populator.random(kPosts), config.posts.density_per_ha, config.posts.spacing_m,
                    maker(Surface::Post, config.posts));
  const double car_reach_m = 0.5 * std::hypot(config.bodies.car_length_m, config.bodies.car_width_m);
  populator.add_movers(populator.random(kPeople), config.people, MoverKind::Person,
                       config.bodies.person_radius_m);
  populator.add_movers(populator.random(kCars), config.cars, MoverKind::Car, car_reach_m);
  return populator.take();
}

}  // namespace slamsensor::tools
