#include "tools/world/movers.hpp"

#include <cmath>
#include <numbers>

namespace slamsensor::tools {
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

}  // namespace slamsensor::tools
