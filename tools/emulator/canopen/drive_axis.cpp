#include "tools/emulator/canopen/drive_axis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamsensor::tools {

double DriveSettings::counts_per_rad() const noexcept {
  return direction * static_cast<double>(encoder_counts) * static_cast<double>(gear_turns) /
         (2.0 * std::numbers::pi);
}

CanopenHeadSettings canopen_head_settings() {
  CanopenHeadSettings settings;
  settings.tilt.node_id = 2;
  settings.tilt.serial_number = 2;
  settings.tilt.lower_limit = -53'476;
  settings.tilt.upper_limit = 35'271;
  return settings;
}

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

namespace {

// CiA 402, homing methods.
constexpr long kLowerSwitch = 17;
constexpr long kUpperSwitch = 18;
constexpr long kHere = 37;
constexpr long kHereBefore = 35;  // its number in older editions

}  // namespace

DriveAxis::DriveAxis(const DriveSettings& settings)
    : settings_(settings), motion_(static_cast<double>(settings.start)) {
}

void DriveAxis::follow(Stamp at, const DriveProfile& profile) {
  motion_.follow(at, profile.plan);
  settled_at_ = at + hal::from_seconds(profile.settled_s);
  const auto margin = static_cast<double>(settings_.stop_margin);
  hit_at_ = motion_.leaves(at, static_cast<double>(settings_.lower_limit) - margin,
                           static_cast<double>(settings_.upper_limit) + margin);
}

void DriveAxis::move(Stamp at, double target, const DriveRates& rates) {
  follow(at, plan_profile({position(at), speed(at)}, target, rates));
}

void DriveAxis::run(Stamp at, double bound, const DriveRates& rates) {
  follow(at, plan_run({position(at), speed(at)}, bound, rates));
}

void DriveAxis::stop(Stamp at, double deceleration) {
  follow(at, plan_rest({position(at), speed(at)}, deceleration));
}

void DriveAxis::freeze(Stamp at) {
  motion_.rest(at, position(at), motion_.slip(at));
  settled_at_ = at;
  hit_at_ = hal::kNever;
}

void DriveAxis::set_position(Stamp at, double new_position) {
  motion_.rest(at, new_position, truth(at) - new_position);
  settled_at_ = at;
  hit_at_ = hal::kNever;
}

// Beyond the switch's edge at full speed, then stopped by the ramp, or by the stop if that is nearer.
DriveProfile DriveAxis::to_switch(const StepperState& state, double edge, double direction,
                                  const HomingRates& rates) const {
  const double room = static_cast<double>(settings_.stop_margin - settings_.switch_margin) - 1.0;
  const double overshoot =
      std::min(rates.fast * rates.fast / (2.0 * rates.acceleration), std::max(room, 0.0));
  const double turn = edge + direction * overshoot;
  const double from = direction * state.position >= direction * edge ? state.position : turn;
  return plan_profile(state, from, {rates.fast, rates.acceleration, rates.acceleration});
}

bool DriveAxis::home(Stamp at, long method, const HomingRates& rates) {
  if (method == kHere || method == kHereBefore) {
    stop(at, rates.acceleration);
    return true;
  }
  if (method != kLowerSwitch && method != kUpperSwitch) {
    return false;
  }
  const double direction = method == kLowerSwitch ? -1.0 : 1.0;
  const double limit = static_cast<double>(direction < 0.0 ? settings_.lower_limit : settings_.upper_limit);
  const double edge = limit + direction * static_cast<double>(settings_.switch_margin) - motion_.slip(at);
  const DriveProfile there = to_switch({position(at), speed(at)}, edge, direction, rates);
  const DriveRates slow{rates.slow, rates.acceleration, rates.acceleration};
  follow(at, then(there, plan_profile({there.plan.end, 0.0}, edge, slow)));
  return true;
}

Stamp DriveAxis::gets_away(Stamp at, double window) const {
  const double here = truth(at);
  return motion_.leaves(at, here - window, here + window);
}

}  // namespace slamsensor::tools
