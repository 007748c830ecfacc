#include "tools/emulator/canopen/drive_axis.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

bool is_here(long method) noexcept {
  return method == 35 || method == 37;
}

// -1, +1: which way a method looks first; 0: none.
double first_way(long method) noexcept {
  if (method == 1 || method == 17 || method == 33) {
    return -1.0;
  }
  return method == 2 || method == 18 || method == 34 ? 1.0 : 0.0;
}

// The next place `pitch` apart from `pulse` strictly beyond `from`.
double next_pulse(double from, double direction, double pulse, double pitch) {
  const double turns = direction * (from - pulse) / pitch;
  return pulse + direction * pitch * (std::floor(turns + 1e-9) + 1.0);
}

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
  const double direction = first_way(method);
  if (is_here(method)) {
    stop(at, rates.acceleration);
    return true;
  }
  if (direction == 0.0) {
    return false;
  }
  const double slip = motion_.slip(at);
  const double pitch = static_cast<double>(settings_.encoder_counts);
  const double pulse = static_cast<double>(settings_.index_pulse) - slip;
  const double limit = static_cast<double>(direction < 0.0 ? settings_.lower_limit : settings_.upper_limit);
  const double edge = limit + direction * static_cast<double>(settings_.switch_margin) - slip;
  const DriveRates slow{rates.slow, rates.acceleration, rates.acceleration};
  DriveProfile profile;
  if (method >= 33) {
    profile = plan_rest({position(at), speed(at)}, rates.acceleration);
    const double target = next_pulse(profile.plan.end, direction, pulse, pitch);
    profile = then(profile, plan_profile({profile.plan.end, 0.0}, target, slow));
  } else {
    profile = to_switch({position(at), speed(at)}, edge, direction, rates);
    const double target = method < 17 ? next_pulse(edge, -direction, pulse, pitch) : edge;
    profile = then(profile, plan_profile({profile.plan.end, 0.0}, target, slow));
  }
  follow(at, profile);
  return true;
}

Stamp DriveAxis::gets_away(Stamp at, double window) const {
  const double here = truth(at);
  return motion_.leaves(at, here - window, here + window);
}

}  // namespace slamsensor::tools
