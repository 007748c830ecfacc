#include "tools/emulator/canopen/drive_profile.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

// Adds a leg from `from` to `to` (amounts of speed) in `direction`; returns the way on it.
double add_ramp(MotionPlan& plan, double from, double to, double direction, double rate) {
  if (from == to) {
    return 0.0;
  }
  const double duration_s = std::abs(to - from) / rate;
  plan.legs.push_back({duration_s, direction * from, direction * std::copysign(rate, to - from)});
  return 0.5 * (from + to) * duration_s;
}

double duration_of(const MotionPlan& plan) {
  double sum_s = 0.0;
  for (const MotionLeg& leg : plan.legs) {
    sum_s += leg.duration_s;
  }
  return sum_s;
}

struct Approach {
  DriveProfile profile;
  double cruise_s = 0.0;  // when its highest speed is reached
};

// From `speed` in `direction`, slow enough to stop in time, to rest `way` further.
Approach approach(double speed, double way, double direction, const DriveRates& rates) {
  Approach result;
  MotionPlan& plan = result.profile.plan;
  const double up = rates.acceleration;
  const double down = rates.deceleration;
  double peak = std::sqrt((2.0 * up * down * way + down * speed * speed) / (up + down));
  peak = std::min(peak, rates.speed);
  const double first = add_ramp(plan, speed, peak, direction, peak > speed ? up : down);
  result.cruise_s = duration_of(plan);
  const double cruise = way - first - peak * peak / (2.0 * down);
  if (cruise > 0.0 && peak > 0.0) {
    plan.legs.push_back({cruise / peak, direction * peak, 0.0});
  }
  add_ramp(plan, peak, 0.0, direction, down);
  result.profile.settled_s = duration_of(plan);
  return result;
}

// As plan_profile(); `cruise_s` is of the motion after a turn.
Approach go(StepperState state, double target, const DriveRates& rates) {
  const double ahead = target - state.position;
  const double brake = state.speed * state.speed / (2.0 * rates.deceleration);
  DriveProfile before;
  if (state.speed != 0.0 && (state.speed * ahead <= 0.0 || brake > std::abs(ahead) + 1e-9)) {
    before = plan_rest(state, rates.deceleration);
    state = {before.plan.end, 0.0};
  }
  const double way = target - state.position;
  Approach last;
  if (way != 0.0 && rates.speed > 0.0) {
    last = approach(std::abs(state.speed), std::abs(way), way < 0.0 ? -1.0 : 1.0, rates);
    last.profile.plan.end = target;
  } else {
    last.profile = plan_rest(state, rates.deceleration);
  }
  last.cruise_s += before.settled_s;
  last.profile = then(std::move(before), last.profile);
  return last;
}

}  // namespace

DriveProfile plan_profile(StepperState state, double target, const DriveRates& rates) {
  return go(state, target, rates).profile;
}

DriveProfile plan_run(const StepperState& state, double bound, const DriveRates& rates) {
  Approach run = go(state, bound, rates);
  run.profile.settled_s = run.cruise_s;
  return run.profile;
}

DriveProfile plan_rest(const StepperState& state, double deceleration) {
  DriveProfile profile;
  const double direction = state.speed < 0.0 ? -1.0 : 1.0;
  const double way = add_ramp(profile.plan, std::abs(state.speed), 0.0, direction, deceleration);
  profile.plan.end = state.position + direction * way;
  profile.settled_s = duration_of(profile.plan);
  return profile;
}

DriveProfile then(DriveProfile first, const DriveProfile& second) {
  const double begin_s = duration_of(first.plan);
  first.plan.legs.insert(first.plan.legs.end(), second.plan.legs.begin(), second.plan.legs.end());
  first.plan.end = second.plan.end;
  first.settled_s = begin_s + second.settled_s;
  return first;
}

}  // namespace slamsensor::tools
