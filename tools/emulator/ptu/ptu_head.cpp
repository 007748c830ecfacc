#include "tools/emulator/ptu/ptu_head.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr long kNowhere = 1'000'000;  // as far as a motor can be told to go without limits

std::string_view axis_name(PtuAxisId id) {
  return id == PtuAxisId::Pan ? "Pan" : "Tilt";
}

constexpr std::array kBoth = {PtuAxisId::Pan, PtuAxisId::Tilt};

std::array<PtuAxis, kPtuAxes> make_axes(const PtuSettings& settings, std::uint64_t seed) {
  Random rng(mix_seed(seed, 1));
  const auto offset = [&] {
    const double spread = static_cast<double>(settings.limit_spread);
    return std::lround(draw_uniform(rng, -spread - 0.5, spread + 0.5) *
                       (settings.limit_spread > 0 ? 1.0 : 0.0));
  };
  const std::array<long, 4> offsets{offset(), offset(), offset(), offset()};
  return {PtuAxis(settings.model.pan, settings.hard_margin, offsets[0], offsets[1]),
          PtuAxis(settings.model.tilt, settings.hard_margin, offsets[2], offsets[3])};
}

}  // namespace

PtuHead::PtuHead(const PtuSettings& settings, std::uint64_t seed)
    : config(factory_config(settings)), settings_(settings), axes_(make_axes(settings, seed)) {
}

PtuVerdict PtuHead::refuse(PtuStatus status, const std::string& pattern, PtuAxisId id, long value) const {
  return {status, worded(pattern, axis_name(id), std::to_string(value))};
}

StepperRates PtuHead::rates(PtuAxisId id, long speed) const {
  const PtuAxisConfig& own = config.axes[index_of(id)];
  return {static_cast<double>(speed), static_cast<double>(own.base_speed),
          static_cast<double>(own.acceleration)};
}

std::array<long, 2> PtuHead::bounds(PtuAxisId id) const {
  const PtuAxis& own = axis(id);
  const PtuAxisConfig& set = config.axes[index_of(id)];
  switch (config.limits) {
    case PtuLimits::Disabled:
      return {-kNowhere, kNowhere};
    case PtuLimits::User:
      return {set.user_min.value_or(own.min()), set.user_max.value_or(own.max())};
    case PtuLimits::Factory:
      break;
  }
  return {own.min(), own.max()};
}

PtuVerdict PtuHead::check_position(PtuAxisId id, long target) const {
  const auto [low, high] = bounds(id);
  const bool is_refused = settings_.model.series == PtuSeries::E && is_lost_[index_of(id)];
  if (is_resetting_ || is_refused) {
    return {PtuStatus::IllegalPosition, settings_.wording.axis_error};
  }
  if (target > high) {
    return refuse(PtuStatus::IllegalPosition, settings_.wording.above_max, id, high);
  }
  if (target < low) {
    return refuse(PtuStatus::IllegalPosition, settings_.wording.below_min, id, low);
  }
  return {};
}

PtuVerdict PtuHead::set_position(PtuAxisId id, long target, Stamp now) {
  PtuVerdict verdict = check_position(id, target);
  if (verdict.status != PtuStatus::Ok || config.control == PtuControl::Velocity) {
    return verdict;
  }
  if (config.execution == PtuExecution::Slaved) {
    stored_[index_of(id)] = target;
  } else {
    go(id, target, now);
  }
  return verdict;
}

void PtuHead::go(PtuAxisId id, long target, Stamp now) {
  axis(id).move(now, target, rates(id, config.axes[index_of(id)].speed));
}

void PtuHead::release(Stamp now) {
  for (const PtuAxisId id : kBoth) {
    if (const auto target = std::exchange(stored_[index_of(id)], std::nullopt)) {
      go(id, *target, now);
    }
  }
}

void PtuHead::set_execution(PtuExecution execution, Stamp now) {
  config.execution = execution;
  if (execution == PtuExecution::Immediate) {
    release(now);
  }
}

PtuVerdict PtuHead::check_speed(PtuAxisId id, long speed) const {
  const PtuAxisConfig& own = config.axes[index_of(id)];
  const bool is_signed = config.control == PtuControl::Velocity;
  const long magnitude = is_signed ? std::abs(speed) : speed;
  if (magnitude > own.upper_speed) {
    return refuse(PtuStatus::IllegalSpeed, settings_.wording.speed_above, id, own.upper_speed);
  }
  if (magnitude < own.lower_speed && !(is_signed && speed == 0)) {
    return refuse(PtuStatus::IllegalSpeed, settings_.wording.speed_below, id, own.lower_speed);
  }
  return {};
}

PtuVerdict PtuHead::set_speed(PtuAxisId id, long speed, Stamp now) {
  PtuVerdict verdict = check_speed(id, speed);
  if (verdict.status != PtuStatus::Ok) {
    return verdict;
  }
  if (config.control == PtuControl::Velocity) {
    if (is_resetting_) {
      return {PtuStatus::IllegalSpeed, settings_.wording.axis_error};
    }
    velocities_[index_of(id)] = speed;
    run(id, now);
    return verdict;
  }
  parameters(id).speed = speed;
  if (axis(id).is_moving(now) && !is_resetting_) {
    go(id, axis(id).target(), now);
  }
  return verdict;
}

void PtuHead::run(PtuAxisId id, Stamp now) {
  const long velocity = velocities_[index_of(id)];
  if (velocity == 0) {
    halt(id, now);
    return;
  }
  const auto [low, high] = bounds(id);
  axis(id).move(now, velocity < 0 ? low : high, rates(id, std::abs(velocity)));
}

long PtuHead::desired_speed(PtuAxisId id) const {
  return config.control == PtuControl::Velocity ? velocities_[index_of(id)] : config.axes[index_of(id)].speed;
}

long PtuHead::current_speed(PtuAxisId id, Stamp now) const {
  const long speed = std::lround(axis(id).speed(now));
  return config.control == PtuControl::Velocity ? speed : std::abs(speed);
}

void PtuHead::set_control(PtuControl control, Stamp now) {
  if (std::exchange(config.control, control) == control || is_resetting_) {
    return;
  }
  velocities_ = {};
  for (const PtuAxisId id : kBoth) {
    stored_[index_of(id)].reset();
    halt(id, now);
  }
}

std::optional<PtuVerdict> PtuHead::refuse_in_motion(PtuAxisId id, Stamp now) const {
  if (axis(id).is_moving(now) && settings_.tables_in_motion == PtuTablesInMotion::Refused) {
    return PtuVerdict{PtuStatus::AccelerationTable, settings_.wording.in_motion};
  }
  return std::nullopt;
}

PtuVerdict PtuHead::set_acceleration(PtuAxisId id, long value, Stamp now) {
  if (value < 1) {
    return {PtuStatus::AccelerationTable, settings_.wording.illegal_argument};
  }
  if (const auto refusal = refuse_in_motion(id, now)) {
    return *refusal;
  }
  parameters(id).acceleration = value;
  return {};
}

PtuVerdict PtuHead::set_base_speed(PtuAxisId id, long value, Stamp now) {
  const long lowest = model_of(settings_, id).lower_speed;
  if (value < lowest) {
    return refuse(PtuStatus::IllegalSpeed, settings_.wording.speed_below, id, lowest);
  }
  if (value > parameters(id).upper_speed) {
    return refuse(PtuStatus::IllegalSpeed, settings_.wording.speed_above, id, parameters(id).upper_speed);
  }
  if (const auto refusal = refuse_in_motion(id, now)) {
    return *refusal;
  }
  parameters(id).base_speed = value;
  return {};
}

PtuVerdict PtuHead::set_upper_speed(PtuAxisId id, long value, Stamp now) {
  PtuAxisConfig& own = parameters(id);
  const long highest = model_of(settings_, id).upper_speed_max;
  if (value > highest) {
    return refuse(PtuStatus::IllegalSpeed, settings_.wording.speed_above, id, highest);
  }
  if (value < std::max(own.lower_speed, own.base_speed)) {
    return refuse(PtuStatus::IllegalSpeed, settings_.wording.speed_below, id,
                  std::max(own.lower_speed, own.base_speed));
  }
  if (const auto refusal = refuse_in_motion(id, now)) {
    return *refusal;
  }
  own.upper_speed = value;
  own.speed = std::min(own.speed, value);
  return {};
}

PtuVerdict PtuHead::set_lower_speed(PtuAxisId id, long value, Stamp now) {
  PtuAxisConfig& own = parameters(id);
  const long lowest = model_of(settings_, id).lower_speed;
  if (value < lowest) {
    return refuse(PtuStatus::IllegalSpeed, settings_.wording.speed_below, id, lowest);
  }
  if (value > own.upper_speed) {
    return refuse(PtuStatus::IllegalSpeed, settings_.wording.speed_above, id, own.upper_speed);
  }
  if (const auto refusal = refuse_in_motion(id, now)) {
    return *refusal;
  }
  own.lower_speed = value;
  own.speed = std::max(own.speed, value);
  return {};
}

void PtuHead::halt(PtuAxisId id, Stamp now) {
  if (!is_resetting_) {
    stored_[index_of(id)].reset();
    velocities_[index_of(id)] = 0;
    axis(id).halt(now, rates(id, config.axes[index_of(id)].speed));
  }
}

}  // namespace slamsensor::tools
