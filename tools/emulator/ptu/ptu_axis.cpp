#include "tools/emulator/ptu/ptu_axis.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

// Steps in a half step, the mode that the models' figures are for.
double fineness_of(char step_mode) {
  switch (step_mode) {
    case 'F':
      return 0.5;
    case 'Q':
      return 2.0;
    case 'E':
    case 'A':
      return 4.0;
    default:
      return 1.0;
  }
}

long scaled(long position, double fineness) {
  return std::lround(static_cast<double>(position) * fineness);
}

}  // namespace

PtuAxis::PtuAxis(const PtuAxisModel& model, long hard_margin, long min_offset, long max_offset)
    : model_(model), hard_margin_(hard_margin), min_offset_(min_offset), max_offset_(max_offset) {
  set_step_mode('H');
}

void PtuAxis::set_step_mode(char step_mode) {
  fineness_ = fineness_of(step_mode);
  min_ = scaled(model_.min_position + min_offset_, fineness_);
  max_ = scaled(model_.max_position + max_offset_, fineness_);
}

long PtuAxis::position(Stamp at) const {
  return std::lround(motion_.position(at));
}

double PtuAxis::truth_arcsec(Stamp at, PtuSteps steps) const {
  const double truth = motion_.truth(at);
  return (steps == PtuSteps::Quantised ? std::round(truth) : truth) * resolution_arcsec();
}

Stamp PtuAxis::next_stop_hit(Stamp from) const {
  const double margin = static_cast<double>(hard_margin_) * fineness_;
  return motion_.leaves(from, static_cast<double>(min_) - margin, static_cast<double>(max_) + margin);
}

void PtuAxis::move(Stamp at, long target, const StepperRates& rates) {
  target_ = target;
  const StepperState state{motion_.position(at), motion_.speed(at)};
  motion_.follow(at, plan_move(state, static_cast<double>(target), rates));
}

void PtuAxis::halt(Stamp at, const StepperRates& rates) {
  const MotionPlan plan = plan_stop({motion_.position(at), motion_.speed(at)}, rates);
  target_ = std::lround(plan.end);
  motion_.follow(at, plan);
}

void PtuAxis::freeze(Stamp at) {
  target_ = position(at);
  motion_.rest(at, static_cast<double>(target_), motion_.slip(at));
}

void PtuAxis::miss(Stamp at, double steps) {
  const double margin = static_cast<double>(hard_margin_) * fineness_;
  const double truth = motion_.truth(at);
  const double low = static_cast<double>(min_) - margin;
  const double high = static_cast<double>(max_) + margin;
  motion_.miss(at, std::clamp(truth + steps, std::min(low, truth), std::max(high, truth)) - truth);
}

void PtuAxis::lose_position(Stamp at) {
  target_ = 0;
  motion_.rest(at, 0.0, motion_.truth(at));
}

double PtuAxis::reset_way(Stamp at) const {
  const double low = static_cast<double>(min_);
  const double high = static_cast<double>(max_);
  return std::abs(motion_.truth(at) - low) + (high - low) + high;
}

std::vector<Stamp> PtuAxis::reset(Stamp at, Stamp duration) {
  const double low = static_cast<double>(min_);
  const double high = static_cast<double>(max_);
  const double from = motion_.truth(at);
  const double speed = reset_way(at) / hal::to_seconds(duration);
  const double first_s = std::abs(from - low) / speed;
  const double second_s = (high - low) / speed;
  motion_.rest(at, from, 0.0);
  motion_.follow(at, {{{first_s, std::copysign(speed, low - from), 0.0},
                       {second_s, speed, 0.0},
                       {high / speed, -speed, 0.0}},
                      0.0});
  // The last leg ends with the reset, however the sums are rounded.
  motion_.rest(at + duration, 0.0, 0.0);
  target_ = 0;
  return {at + hal::from_seconds(first_s), at + hal::from_seconds(first_s + second_s)};
}

std::vector<Stamp> PtuAxis::jam(Stamp at, Stamp duration) {
  const double low = static_cast<double>(min_);
  const double from = motion_.truth(at);
  const double jammed = std::round(low / 3.0);
  const double speed = (std::abs(from - low) + (jammed - low)) / hal::to_seconds(duration);
  const double first_s = std::abs(from - low) / speed;
  motion_.rest(at, from, 0.0);
  motion_.follow(
      at, {{{first_s, std::copysign(speed, low - from), 0.0}, {(jammed - low) / speed, speed, 0.0}}, jammed});
  motion_.rest(at + duration, 0.0, jammed);
  target_ = 0;
  return {at + hal::from_seconds(first_s)};
}

}  // namespace slamsensor::tools
