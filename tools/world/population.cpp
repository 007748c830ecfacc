#include "tools/world/population.hpp"

#include "tools/world/random.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace slamsensor::tools {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kCellMin_m = 4.0;
constexpr double kCellsPerSide = 512.0;

double cell_size_m(const AreaConfig& area) noexcept {
  return std::max({kCellMin_m, (area.x_max_m - area.x_min_m) / kCellsPerSide,
                   (area.y_max_m - area.y_min_m) / kCellsPerSide});
}

std::size_t cell_count(double length_m, double cell_m) noexcept {
  return static_cast<std::size_t>(std::floor(length_m / cell_m)) + 1;
}

// What lies outside the area is kept in the cells along its edge.
std::size_t clamped_cell(double offset_m, double cell_m, std::size_t count) noexcept {
  const double cell = std::clamp(std::floor(offset_m / cell_m), 0.0, static_cast<double>(count - 1));
  return static_cast<std::size_t>(cell);
}

}  // namespace

Footprints::Footprints(const AreaConfig& area)
    : area_(area),
      cell_m_(cell_size_m(area)),
      columns_(cell_count(area.x_max_m - area.x_min_m, cell_m_)),
      rows_(cell_count(area.y_max_m - area.y_min_m, cell_m_)),
      first_(columns_ * rows_, kNone) {
}

std::size_t Footprints::column(double x_m) const noexcept {
  return clamped_cell(x_m - area_.x_min_m, cell_m_, columns_);
}

std::size_t Footprints::row(double y_m) const noexcept {
  return clamped_cell(y_m - area_.y_min_m, cell_m_, rows_);
}

void Footprints::add_circle(const core::Point2& centre_W, double radius_m) {
  std::uint32_t& first = first_[row(centre_W.y()) * columns_ + column(centre_W.x())];
  circles_.push_back({centre_W, radius_m, first});
  first = static_cast<std::uint32_t>(circles_.size() - 1);
  radius_max_m_ = std::max(radius_max_m_, radius_m);
}

void Footprints::add_wall(const WallConfig& wall) {
  walls_.push_back(wall);
}

bool Footprints::is_clear(const core::Point2& centre_W, double reach_m) const noexcept {
  for (const WallConfig& wall : walls_) {
    if (distance_to_wall_m(centre_W, wall) < reach_m) {
      return false;
    }
  }
  const double search_m = reach_m + radius_max_m_;
  const std::size_t column_end = column(centre_W.x() + search_m);
  const std::size_t row_end = row(centre_W.y() + search_m);
  for (std::size_t r = row(centre_W.y() - search_m); r <= row_end; ++r) {
    for (std::size_t c = column(centre_W.x() - search_m); c <= column_end; ++c) {
      for (std::uint32_t i = first_[r * columns_ + c]; i != kNone; i = circles_[i].next) {
        const double gap_m = reach_m + circles_[i].radius_m;
        if ((circles_[i].centre_W - centre_W).squaredNorm() < gap_m * gap_m) {
          return false;
        }
      }
    }
  }
  return true;
}

double distance_to_wall_m(const core::Point2& p_W, const WallConfig& wall) noexcept {
  const core::Point2 from(wall.x1_m, wall.y1_m);
  const core::Point2 along = core::Point2(wall.x2_m, wall.y2_m) - from;
  const double length_2 = along.squaredNorm();
  const double share = length_2 > 0.0 ? std::clamp((p_W - from).dot(along) / length_2, 0.0, 1.0) : 0.0;
  return (p_W - from - share * along).norm();
}

namespace {

// `value` brought into [0, period).
double wrapped(double value, double period) noexcept {
  return value - period * std::floor(value / period);
}

MoverPlace place_on_circle(const MoverConfig& path, double way_m) noexcept {
  const double angle_rad = way_m / path.circle_radius_m;
  const Eigen::Vector2d out(std::cos(angle_rad), std::sin(angle_rad));
  const double turn = path.speed_mps < 0.0 ? -1.0 : 1.0;
  return {core::Point2(path.x1_m, path.y1_m) + path.circle_radius_m * out, {-turn * out.y(), turn * out.x()}};
}

}  // namespace

double path_length_m(const MoverConfig& path) noexcept {
  return path.circle_radius_m > 0.0 ? 2.0 * std::numbers::pi * path.circle_radius_m
                                    : std::hypot(path.x2_m - path.x1_m, path.y2_m - path.y1_m);
}

MoverPlace place_on_path(const MoverConfig& path, double way_m) noexcept {
  if (path.circle_radius_m > 0.0) {
    return place_on_circle(path, way_m);
  }
  const core::Point2 from(path.x1_m, path.y1_m);
  const double length_m = path_length_m(path);
  if (length_m <= 0.0) {
    return {from, Eigen::Vector2d::UnitX()};  // it stands still
  }
  const Eigen::Vector2d forward = (core::Point2(path.x2_m, path.y2_m) - from) / length_m;
  const double gone_m = wrapped(way_m, 2.0 * length_m);
  if (gone_m <= length_m) {
    return {from + gone_m * forward, forward};
  }
  return {from + (2.0 * length_m - gone_m) * forward, -forward};
}

MoverPlace place_at(const MoverConfig& mover, double time_s) noexcept {
  return place_on_path(mover, mover.offset_m + mover.speed_mps * time_s);
}

Movers::Movers(const std::vector<MoverConfig>& movers, const BodyConfig& bodies) : bodies_(bodies) {
  const double person_m = bodies.person_radius_m;
  const double car_m = 0.5 * std::hypot(bodies.car_length_m, bodies.car_width_m);
  for (const MoverConfig& mover : movers) {
    const double body_m = mover.kind == MoverKind::Person ? person_m : car_m;
    const core::Point2 from(mover.x1_m, mover.y1_m);
    const core::Point2 to(mover.x2_m, mover.y2_m);
    const bool round = mover.circle_radius_m > 0.0;
    const core::Point2 centre_W = round ? from : core::Point2(0.5 * (from + to));
    const double reach_m = round ? mover.circle_radius_m : 0.5 * (to - from).norm();
    items_.push_back({mover, centre_W, reach_m + body_m});
  }
}

Chord Movers::body_chord(const Ray& ray, const Item& item, double time_s,
                         const Ground& ground) const noexcept {
  const MoverPlace place = place_at(item.config, time_s);
  const double foot_m = ground.height_m(place.position_W.x(), place.position_W.y());
  if (item.config.kind == MoverKind::Person) {
    return cylinder_chord(ray, place.position_W.x(), place.position_W.y(), bodies_.person_radius_m, foot_m,
                          foot_m + bodies_.person_height_m);
  }
  const double half_height_m = 0.5 * bodies_.car_height_m;
  return box_chord(ray, {{place.position_W.x(), place.position_W.y(), foot_m + half_height_m},
                         place.forward_W,
                         {0.5 * bodies_.car_length_m, 0.5 * bodies_.car_width_m, half_height_m}});
}

Movers::Hit Movers::first_hit(const Ray& ray, double limit_m, double time_s,
                              const Ground& ground) const noexcept {
  Hit first;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const Item& item = items_[i];
    const double nearest_m = std::min(limit_m, first.distance_m);
    const Chord bound = cylinder_chord(ray, item.bound_centre_W.x(), item.bound_centre_W.y(),
                                       item.bound_radius_m, -kMiss, kMiss);
    if (bound.empty() || bound.in_m > nearest_m) {
      continue;
    }
    const Chord body = body_chord(ray, item, time_s, ground);
    if (!body.empty() && body.in_m < nearest_m) {
      const Surface surface = item.config.kind == MoverKind::Person ? Surface::Person : Surface::Car;
      first = {body.in_m, surface, static_cast<std::uint32_t>(i)};
    }
  }
  return first;
}

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
