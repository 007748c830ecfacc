#include "tools/emulator/ptu/motion_plan.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

// The way on which |speed| changes from `from` to `to`.
double ramp_way(double from, double to, double acceleration) {
  return std::abs(from * from - to * to) / (2.0 * acceleration);
}

void add_ramp(MotionPlan& plan, double from, double to, double direction, double acceleration) {
  if (from != to) {
    const double change = to > from ? acceleration : -acceleration;
    plan.legs.push_back({(to - from) / change, direction * from, direction * change});
  }
}

void add_cruise(MotionPlan& plan, double way, double speed) {
  if (way > 0.0) {
    plan.legs.push_back({way / std::abs(speed), speed, 0.0});
  }
}

// From `speed` (not negative, in `direction`, slow enough to stop in time) on to rest `way` further.
void add_approach(MotionPlan& plan, double speed, double way, double direction, const StepperRates& rates) {
  const double low = std::min(rates.base, rates.speed);
  double from = std::max(speed, low);
  if (from > rates.speed) {
    const double slow = std::max(rates.speed, rates.base);
    if (from > slow) {
      add_ramp(plan, from, slow, direction, rates.acceleration);
      way -= ramp_way(from, slow, rates.acceleration);
    }
    from = rates.speed;
  }
  const double reachable = std::sqrt((2.0 * rates.acceleration * way + from * from + low * low) / 2.0);
  const double peak = from < rates.speed ? std::max(std::min(rates.speed, reachable), from) : from;
  const double ramps = ramp_way(peak, from, rates.acceleration) + ramp_way(peak, low, rates.acceleration);
  add_ramp(plan, from, peak, direction, rates.acceleration);
  add_cruise(plan, way - ramps, direction * peak);
  add_ramp(plan, peak, low, direction, rates.acceleration);
}

}  // namespace

MotionPlan plan_stop(const StepperState& state, const StepperRates& rates) {
  MotionPlan plan;
  const double direction = state.speed < 0.0 ? -1.0 : 1.0;
  const double speed = std::abs(state.speed);
  const double slow = std::min(speed, rates.base);
  const double stop = state.position + direction * ramp_way(speed, slow, rates.acceleration);
  plan.end = direction * std::ceil(direction * stop - 1e-9);
  if (speed == 0.0) {
    plan.end = std::round(state.position);
    return plan;
  }
  add_ramp(plan, speed, slow, direction, rates.acceleration);
  add_cruise(plan, direction * (plan.end - stop), direction * slow);
  return plan;
}

MotionPlan plan_move(StepperState state, double target, const StepperRates& rates) {
  MotionPlan plan;
  const double ahead = target - state.position;
  const double speed = std::abs(state.speed);
  const double brake = speed > rates.base ? ramp_way(speed, rates.base, rates.acceleration) : 0.0;
  if (state.speed * ahead < 0.0 || brake > std::abs(ahead) + 1e-9) {
    if (brake > 0.0) {
      plan = plan_stop(state, rates);
      state.position = plan.end;
    }
    state.speed = 0.0;
  }
  const double way = target - state.position;
  if (way != 0.0) {
    add_approach(plan, std::abs(state.speed), std::abs(way), way < 0.0 ? -1.0 : 1.0, rates);
  }
  plan.end = target;
  return plan;
}

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
