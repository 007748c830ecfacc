#include "hal/pantilt/pan_tilt.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::hal {

MotionProfile::MotionProfile(double start_rad, double target_rad, double speed_radps,
                             const AxisDynamics& dynamics) noexcept
    : start_rad_(start_rad),
      length_rad_(std::abs(target_rad - start_rad)),
      sign_(target_rad < start_rad ? -1.0 : 1.0),
      base_radps_(std::min(speed_radps, dynamics.base_speed_radps)),
      cruise_radps_(speed_radps),
      acceleration_radps2_(dynamics.acceleration_radps2) {
  if (!(length_rad_ > 0.0) || !(speed_radps > 0.0)) {
    length_rad_ = 0.0;
    return;
  }
  if (speed_radps <= dynamics.base_speed_radps || !(acceleration_radps2_ > 0.0)) {
    // Without a ramp there is no way to more than the base speed; a unit that reports no base speed cruises
    // at once.
    cruise_radps_ = dynamics.base_speed_radps > 0.0 ? base_radps_ : speed_radps;
    base_radps_ = cruise_radps_;
    cruise_s_ = length_rad_ / cruise_radps_;
    return;
  }
  // v^2 = base^2 + 2 a s: speed reached after half the way, if the way is too short for the speed asked for.
  const double peak_radps = std::sqrt(base_radps_ * base_radps_ + acceleration_radps2_ * length_rad_);
  cruise_radps_ = std::min(speed_radps, peak_radps);
  ramp_s_ = (cruise_radps_ - base_radps_) / acceleration_radps2_;
  const double ramp_rad = 0.5 * (base_radps_ + cruise_radps_) * ramp_s_;
  cruise_s_ = std::max(0.0, length_rad_ - 2.0 * ramp_rad) / cruise_radps_;
}

double MotionProfile::position_rad(double elapsed_s) const noexcept {
  const double total_s = duration_s();
  if (!(elapsed_s > 0.0)) {
    return start_rad_;
  }
  if (elapsed_s >= total_s) {
    return target_rad();
  }
  double way_rad = 0.0;
  if (elapsed_s < ramp_s_) {
    way_rad = ramped_rad(elapsed_s);
  } else if (elapsed_s <= ramp_s_ + cruise_s_) {
    way_rad = ramped_rad(ramp_s_) + cruise_radps_ * (elapsed_s - ramp_s_);
  } else {
    way_rad = length_rad_ - ramped_rad(total_s - elapsed_s);
  }
  return start_rad_ + sign_ * way_rad;
}

double MotionProfile::speed_radps(double elapsed_s) const noexcept {
  const double total_s = duration_s();
  if (elapsed_s < 0.0 || elapsed_s >= total_s) {
    return 0.0;
  }
  const double ramped_s = std::min({ramp_s_, elapsed_s, total_s - elapsed_s});
  return sign_ * (base_radps_ + acceleration_radps2_ * ramped_s);
}

double MotionProfile::elapsed_s(double position_rad) const noexcept {
  const double way_rad = sign_ * (position_rad - start_rad_);
  if (!(way_rad > 0.0)) {
    return 0.0;
  }
  if (way_rad >= length_rad_) {
    return duration_s();
  }
  const double ramp_rad = ramped_rad(ramp_s_);
  if (way_rad < ramp_rad) {
    return ramp_of_s(way_rad);
  }
  if (way_rad > length_rad_ - ramp_rad) {
    return duration_s() - ramp_of_s(length_rad_ - way_rad);
  }
  return ramp_s_ + (way_rad - ramp_rad) / cruise_radps_;
}

/// The way after `ramp_s` of speeding up.
double MotionProfile::ramped_rad(double ramp_s) const noexcept {
  return base_radps_ * ramp_s + 0.5 * acceleration_radps2_ * ramp_s * ramp_s;
}

/// The inverse of ramped_rad(), in the form that keeps its digits for a short way; `way_rad` is positive.
double MotionProfile::ramp_of_s(double way_rad) const noexcept {
  const double reached_radps = std::sqrt(base_radps_ * base_radps_ + 2.0 * acceleration_radps2_ * way_rad);
  return 2.0 * way_rad / (base_radps_ + reached_radps);
}

}  // namespace slamsensor::hal
