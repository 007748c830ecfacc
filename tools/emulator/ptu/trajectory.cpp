#include "tools/emulator/ptu/trajectory.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr double kNear = 1e-6;  // positions; far above rounding, far below a step

// When a motion that begins at `speed` has gone `way`; both signed the same, and it does get there.
double time_to(double way, double speed, double acceleration) {
  const double root = std::sqrt(std::max(speed * speed + 2.0 * acceleration * way, 0.0));
  const double sum = speed + std::copysign(root, way);
  return std::abs(sum) > 0.0 ? 2.0 * way / sum : 0.0;
}

}  // namespace

Trajectory::Trajectory(double position) {
  pieces_.push_back({.position = position});
}

const Trajectory::Piece& Trajectory::piece(hal::Stamp at) const {
  const auto later = std::upper_bound(pieces_.begin() + 1, pieces_.end(), at,
                                      [](hal::Stamp time, const Piece& p) { return time < p.start; });
  return *std::prev(later);
}

double Trajectory::position(hal::Stamp at) const {
  const Piece& p = piece(at);
  if (p.speed == 0.0 && p.acceleration == 0.0) {
    return p.position;
  }
  const double t = hal::to_seconds(std::max(at - p.start, hal::Stamp::zero()));
  return p.position + (p.speed + 0.5 * p.acceleration * t) * t;
}

double Trajectory::speed(hal::Stamp at) const {
  const Piece& p = piece(at);
  return p.acceleration == 0.0 ? p.speed : p.speed + p.acceleration * hal::to_seconds(at - p.start);
}

void Trajectory::cut(hal::Stamp at) {
  while (!pieces_.empty() && pieces_.back().start >= at) {
    pieces_.pop_back();
  }
}

void Trajectory::rest(hal::Stamp at, double position, double slip) {
  cut(at);
  pieces_.push_back({at, position, 0.0, 0.0, slip});
}

void Trajectory::follow(hal::Stamp at, const MotionPlan& plan) {
  Piece next{at, position(at), 0.0, 0.0, slip(at)};
  cut(at);
  double elapsed_s = 0.0;
  for (const MotionLeg& leg : plan.legs) {
    next.speed = leg.speed;
    next.acceleration = leg.acceleration;
    pieces_.push_back(next);
    next.position += (leg.speed + 0.5 * leg.acceleration * leg.duration_s) * leg.duration_s;
    elapsed_s += leg.duration_s;
    next.start = at + hal::from_seconds(elapsed_s);
  }
  pieces_.push_back({next.start, plan.end, 0.0, 0.0, next.slip});
}

void Trajectory::miss(hal::Stamp at, double steps) {
  Piece now = piece(at);
  now.position = position(at);
  now.speed = speed(at);
  now.start = at;
  const auto later =
      std::find_if(pieces_.begin(), pieces_.end(), [&](const Piece& p) { return p.start > at; });
  const auto begin = pieces_.insert(later, now);
  std::for_each(begin, pieces_.end(), [&](Piece& p) { p.slip += steps; });
}

void Trajectory::forget(hal::Stamp before) {
  while (pieces_.size() > 1 && pieces_[1].start <= before) {
    pieces_.pop_front();
  }
}

hal::Stamp Trajectory::leaves(hal::Stamp from, double low, double high) const {
  for (std::size_t i = 0; i + 1 < pieces_.size(); ++i) {
    const Piece& p = pieces_[i];
    const hal::Stamp end = pieces_[i + 1].start;
    if (end <= from || (p.speed == 0.0 && p.acceleration == 0.0)) {
      continue;
    }
    const double t = hal::to_seconds(end - p.start);
    const double reached = p.position + p.slip + (p.speed + 0.5 * p.acceleration * t) * t;
    if (reached >= low - kNear && reached <= high + kNear) {
      continue;
    }
    const double way = (reached > high ? high : low) - p.position - p.slip;
    const bool is_beyond = way * (reached - p.position - p.slip) <= 0.0;
    const double when_s = is_beyond ? 0.0 : time_to(way, p.speed, p.acceleration);
    return std::max(from, p.start + hal::from_seconds(when_s));
  }
  return hal::kNever;
}

}  // namespace slamsensor::tools
