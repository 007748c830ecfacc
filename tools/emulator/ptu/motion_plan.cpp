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

}  // namespace slamsensor::tools
