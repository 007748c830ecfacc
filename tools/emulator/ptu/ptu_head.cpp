#include "tools/emulator/ptu/ptu_head.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slamsensor::tools {
namespace {

// resolution, min, max, speed, acceleration, base, lower, upper, upper at most
constexpr std::array<PtuModel, 4> kModels = {{
    {"PTU-46-17.5",
     PtuSeries::Dp,
     {185.1428, -3090, 3090, 1000, 2000, 1000, 31, 2902, 5833},
     {185.1428, -907, 604, 1000, 2000, 1000, 31, 2902, 5833}},
    {"PTU-46-70",
     PtuSeries::Dp,
     {46.2857, -12360, 12360, 1000, 2000, 1000, 31, 2902, 4666},
     {46.2857, -3628, 2416, 1000, 2000, 1000, 31, 2902, 4666}},
    {"PTU-E46-17.5",
     PtuSeries::E,
     {92.5714, -6180, 6180, 2000, 4000, 57, 57, 5804, 11666},
     {46.2857, -3628, 2416, 2000, 4000, 57, 57, 5804, 11666}},
    {"PTU-D300E",
     PtuSeries::E,
     {23.142857, -26133, 26133, 1000, 2000, 57, 57, 1985, 7777},
     {23.142857, -14000, 4666, 1000, 2000, 57, 57, 1985, 7777}},
}};

}  // namespace

const PtuModel& ptu_model(PtuKind kind) {
  return kModels[static_cast<std::size_t>(kind)];
}

namespace {

PtuWording oldest() {
  PtuWording wording;
  wording.version = "Pan-Tilt Controller v1.09.0b, (C)1996 Directed Perception, Inc., All Rights Reserved";
  wording.banner = "\r\n\r\n" + wording.version + "\r\nInitializing...";
  wording.desired_position = "Target %a position is %n";
  wording.desired_speed = "Target %a speed is %n positions/sec";
  wording.base_speed = "Base %a speed is %n positions/sec";
  wording.resolution = "%n seconds arc per position";
  return wording;
}

PtuWording e_series() {
  PtuWording wording;
  wording.version = "v3.3.0, (C)2010-2011 FLIR Commercial Systems, Inc., All Rights Reserved";
  wording.banner = "\r\n\r\n### PAN-TILT CONTROLLER\r\n### " + wording.version + "\r\nInitializing...";
  wording.environment_terse = "30.0,86,84,85";
  wording.desired_position = "Target %a position is %n";
  wording.desired_speed = "Target %a speed is %n positions/sec";
  wording.acceleration = "%a acceleration is %n positions/sec/sec";
  wording.resolution = "%n seconds arc per position";
  wording.independent = "Independent (default) speed control mode";
  wording.velocity = "Pure velocity speed control mode";
  wording.illegal_command = "Illegal Command Entered";
  return wording;
}

}  // namespace

PtuWording ptu_wording(PtuFirmware firmware) {
  switch (firmware) {
    case PtuFirmware::Dp109:
      return oldest();
    case PtuFirmware::FlirE33:
      return e_series();
    case PtuFirmware::Dp212:
      break;
  }
  return {};
}

std::string worded(std::string_view pattern, std::string_view axis, std::string_view value) {
  std::string text;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const std::string_view mark = pattern.substr(i, 2);
    if (mark == "%a" || mark == "%n") {
      text += mark == "%a" ? axis : value;
      ++i;
    } else {
      text += pattern[i];
    }
  }
  return text;
}

PtuSettings ptu_settings(PtuKind kind) {
  PtuSettings settings;
  settings.model = ptu_model(kind);
  if (settings.model.series == PtuSeries::E) {
    settings.wording = ptu_wording(PtuFirmware::FlirE33);
    settings.leading_lf = PtuLeadingLf::AfterLine;
    settings.reset_words = PtuResetWords::ChooseAndReset;
    settings.start_reports = PtuStartReports::Silent;
  }
  return settings;
}

PtuMemory factory_config(const PtuSettings& settings) {
  PtuMemory config;
  for (const PtuAxisId axis : {PtuAxisId::Pan, PtuAxisId::Tilt}) {
    const PtuAxisModel& model = model_of(settings, axis);
    PtuAxisConfig& own = config.axes[index_of(axis)];
    own.speed = model.speed;
    own.acceleration = model.acceleration;
    own.base_speed = model.base_speed;
    own.lower_speed = model.lower_speed;
    own.upper_speed = model.upper_speed;
  }
  config.start_baud = settings.factory_baud;
  return config;
}

StepperAxis::StepperAxis(const PtuAxisModel& model, long hard_margin, long min_offset, long max_offset)
    : resolution_arcsec_(model.resolution_arcsec),
      hard_margin_(static_cast<double>(hard_margin)),
      min_(model.min_position + min_offset),
      max_(model.max_position + max_offset) {
}

long StepperAxis::position(Stamp at) const {
  return std::lround(motion_.position(at));
}

Stamp StepperAxis::next_stop_hit(Stamp from) const {
  return motion_.leaves(from, static_cast<double>(min_) - hard_margin_,
                        static_cast<double>(max_) + hard_margin_);
}

void StepperAxis::move(Stamp at, long target, const StepperRates& rates) {
  target_ = target;
  if (at < blocked_until_) {
    return;
  }
  const StepperState state{motion_.position(at), motion_.speed(at)};
  motion_.follow(at, plan_move(state, static_cast<double>(target), rates));
}

void StepperAxis::halt(Stamp at, const StepperRates& rates) {
  const MotionPlan plan = plan_stop({motion_.position(at), motion_.speed(at)}, rates);
  target_ = std::lround(plan.end);
  motion_.follow(at, plan);
}

void StepperAxis::freeze(Stamp at) {
  target_ = position(at);
  motion_.rest(at, static_cast<double>(target_), motion_.slip(at));
}

void StepperAxis::block(Stamp at, Stamp until) {
  freeze(at);
  blocked_until_ = std::max(blocked_until_, until);
}

void StepperAxis::miss(Stamp at, double steps) {
  const double truth = motion_.truth(at);
  const double low = static_cast<double>(min_) - hard_margin_;
  const double high = static_cast<double>(max_) + hard_margin_;
  motion_.miss(at, std::clamp(truth + steps, std::min(low, truth), std::max(high, truth)) - truth);
}

void StepperAxis::lose_position(Stamp at) {
  target_ = 0;
  motion_.rest(at, 0.0, motion_.truth(at));
}

double StepperAxis::reset_way(Stamp at) const {
  const double low = static_cast<double>(min_);
  const double high = static_cast<double>(max_);
  return std::abs(motion_.truth(at) - low) + (high - low) + high;
}

std::vector<Stamp> StepperAxis::reset(Stamp at, Stamp duration) {
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

std::vector<Stamp> StepperAxis::jam(Stamp at, Stamp duration) {
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

namespace {

constexpr long kHardMargin = 200;     // the mechanical stops lie this far outside the limits
constexpr long kNowhere = 1'000'000;  // as far as a motor can be commanded to go without limits

std::string_view axis_name(PtuAxisId id) {
  return id == PtuAxisId::Pan ? "Pan" : "Tilt";
}

constexpr std::array kBoth = {PtuAxisId::Pan, PtuAxisId::Tilt};
constexpr std::array kTiltFirst = {PtuAxisId::Tilt, PtuAxisId::Pan};

std::array<StepperAxis, kPtuAxes> make_axes(const PtuSettings& settings, std::uint64_t seed) {
  Random rng(mix_seed(seed, 1));
  const auto offset = [&] {
    const double spread = static_cast<double>(settings.limit_spread);
    return std::lround(draw_uniform(rng, -spread - 0.5, spread + 0.5) *
                       (settings.limit_spread > 0 ? 1.0 : 0.0));
  };
  const std::array<long, 4> offsets{offset(), offset(), offset(), offset()};
  return {StepperAxis(settings.model.pan, kHardMargin, offsets[0], offsets[1]),
          StepperAxis(settings.model.tilt, kHardMargin, offsets[2], offsets[3])};
}

}  // namespace

PtuHead::PtuHead(const PtuSettings& settings, std::uint64_t seed)
    : config(factory_config(settings)), settings_(settings), axes_(make_axes(settings, seed)) {
}

PtuRefusal PtuHead::refuse(const std::string& pattern, PtuAxisId id, long value) const {
  return worded(pattern, axis_name(id), std::to_string(value));
}

StepperRates PtuHead::rates(PtuAxisId id, long speed) const {
  const PtuAxisConfig& own = config.axes[index_of(id)];
  return {static_cast<double>(speed), static_cast<double>(own.base_speed),
          static_cast<double>(own.acceleration)};
}

std::array<long, 2> PtuHead::bounds(PtuAxisId id) const {
  return config.limits == PtuLimits::On ? std::array{axis(id).min(), axis(id).max()}
                                        : std::array{-kNowhere, kNowhere};
}

PtuRefusal PtuHead::check_position(PtuAxisId id, long target) const {
  const auto [low, high] = bounds(id);
  const bool is_refused = settings_.model.series == PtuSeries::E && is_lost_[index_of(id)];
  if (is_resetting_ || is_refused) {
    return settings_.wording.axis_error;
  }
  if (target > high) {
    return refuse(settings_.wording.above_max, id, high);
  }
  if (target < low) {
    return refuse(settings_.wording.below_min, id, low);
  }
  return {};
}

PtuRefusal PtuHead::set_position(PtuAxisId id, long target, Stamp now) {
  PtuRefusal refusal = check_position(id, target);
  if (!refusal.empty() || config.control == PtuControl::Velocity) {
    return refusal;
  }
  if (config.execution == PtuExecution::Slaved) {
    stored_[index_of(id)] = target;
  } else {
    go(id, target, now);
  }
  return refusal;
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

PtuRefusal PtuHead::check_speed(PtuAxisId id, long speed) const {
  const PtuAxisConfig& own = config.axes[index_of(id)];
  const bool is_signed = config.control == PtuControl::Velocity;
  const long magnitude = is_signed ? std::abs(speed) : speed;
  if (magnitude > own.upper_speed) {
    return refuse(settings_.wording.speed_above, id, own.upper_speed);
  }
  if (magnitude < own.lower_speed && !(is_signed && speed == 0)) {
    return refuse(settings_.wording.speed_below, id, own.lower_speed);
  }
  return {};
}

PtuRefusal PtuHead::set_speed(PtuAxisId id, long speed, Stamp now) {
  PtuRefusal refusal = check_speed(id, speed);
  if (!refusal.empty()) {
    return refusal;
  }
  if (config.control == PtuControl::Velocity) {
    if (is_resetting_) {
      return settings_.wording.axis_error;
    }
    velocities_[index_of(id)] = speed;
    run(id, now);
    return refusal;
  }
  parameters(id).speed = speed;
  if (axis(id).is_moving(now) && !is_resetting_) {
    go(id, axis(id).target(), now);
  }
  return refusal;
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

PtuRefusal PtuHead::refuse_in_motion(PtuAxisId id, Stamp now) const {
  return axis(id).is_moving(now) ? settings_.wording.in_motion : PtuRefusal();
}

PtuRefusal PtuHead::set_acceleration(PtuAxisId id, long value, Stamp now) {
  if (value < 1) {
    return settings_.wording.illegal_argument;
  }
  if (PtuRefusal refusal = refuse_in_motion(id, now); !refusal.empty()) {
    return refusal;
  }
  parameters(id).acceleration = value;
  return {};
}

PtuRefusal PtuHead::set_base_speed(PtuAxisId id, long value, Stamp now) {
  const long lowest = model_of(settings_, id).lower_speed;
  if (value < lowest) {
    return refuse(settings_.wording.speed_below, id, lowest);
  }
  if (value > parameters(id).upper_speed) {
    return refuse(settings_.wording.speed_above, id, parameters(id).upper_speed);
  }
  if (PtuRefusal refusal = refuse_in_motion(id, now); !refusal.empty()) {
    return refusal;
  }
  parameters(id).base_speed = value;
  return {};
}

PtuRefusal PtuHead::set_upper_speed(PtuAxisId id, long value, Stamp now) {
  PtuAxisConfig& own = parameters(id);
  const long highest = model_of(settings_, id).upper_speed_max;
  if (value > highest) {
    return refuse(settings_.wording.speed_above, id, highest);
  }
  if (value < std::max(own.lower_speed, own.base_speed)) {
    return refuse(settings_.wording.speed_below, id, std::max(own.lower_speed, own.base_speed));
  }
  if (PtuRefusal refusal = refuse_in_motion(id, now); !refusal.empty()) {
    return refusal;
  }
  own.upper_speed = value;
  own.speed = std::min(own.speed, value);
  return {};
}

PtuRefusal PtuHead::set_lower_speed(PtuAxisId id, long value, Stamp now) {
  PtuAxisConfig& own = parameters(id);
  const long lowest = model_of(settings_, id).lower_speed;
  if (value < lowest) {
    return refuse(settings_.wording.speed_below, id, lowest);
  }
  if (value > own.upper_speed) {
    return refuse(settings_.wording.speed_above, id, own.upper_speed);
  }
  if (PtuRefusal refusal = refuse_in_motion(id, now); !refusal.empty()) {
    return refusal;
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

void PtuHead::begin_monitor(Stamp now) {
  monitor_end_ = 1;
  turn_monitor(now);
}

void PtuHead::turn_monitor(Stamp now) {
  monitor_end_ = 1 - *monitor_end_;
  go(PtuAxisId::Pan, *monitor_end_ == 0 ? axis(PtuAxisId::Pan).min() : axis(PtuAxisId::Pan).max(), now);
}

void PtuHead::end_monitor(Stamp now) {
  monitor_end_.reset();
  go(PtuAxisId::Pan, 0, now);
  go(PtuAxisId::Tilt, 0, now);
}

AxesReset PtuHead::begin_reset(PtuAxes axes, std::optional<PtuAxisId> jammed, Stamp now) {
  AxesReset reset{now, {}, {}};
  monitor_end_.reset();
  velocities_ = {};
  stored_ = {};
  for (const PtuAxisId id : kTiltFirst) {
    if (!(id == PtuAxisId::Pan ? axes.pan : axes.tilt)) {
      axis(id).freeze(now);
      continue;
    }
    axis(id).freeze(now);
    const bool does_jam = jammed == id;
    const Stamp duration = std::max(settings_.reset_time / 2, Stamp(1));
    is_lost_[index_of(id)] = does_jam;
    const auto hits = does_jam ? axis(id).jam(reset.end, duration) : axis(id).reset(reset.end, duration);
    for (const Stamp at : hits) {
      reset.hits.push_back({at, id});
    }
    if (does_jam) {
      reset.failure = refuse(settings_.wording.reset_failed, id, 0);
    }
    reset.end += duration;
  }
  is_resetting_ = true;
  return reset;
}

void PtuHead::cut_power(Stamp now) {
  monitor_end_.reset();
  velocities_ = {};
  stored_ = {};
  is_resetting_ = false;
  is_lost_ = {true, true};
  for (StepperAxis& own : axes_) {
    own.freeze(now);
    own.lose_position(now);
  }
}

Stamp PtuHead::still_from() const {
  return std::max(axes_[0].still_from(), axes_[1].still_from());
}

/// When the automatic scan turns back: not while the axis is blocked, or it would turn for ever at one
/// moment.
Stamp PtuHead::monitor_turn() const {
  return std::max(still_from(), axis(PtuAxisId::Pan).blocked_until());
}

Stamp PtuHead::next_event() const {
  if (is_resetting_) {
    return hal::kNever;
  }
  const Stamp hit = std::min(axes_[0].next_stop_hit(seen_), axes_[1].next_stop_hit(seen_));
  return is_monitoring() ? std::min(hit, monitor_turn()) : hit;
}

std::optional<PtuLimitHit> PtuHead::step(Stamp now) {
  seen_ = now;
  for (const PtuAxisId id : {PtuAxisId::Pan, PtuAxisId::Tilt}) {
    if (!is_resetting_ && axis(id).next_stop_hit(now) <= now) {
      axis(id).freeze(now);
      return PtuLimitHit{now, id};
    }
  }
  if (is_monitoring() && monitor_turn() <= now) {
    turn_monitor(now);
  }
  return std::nullopt;
}

void PtuHead::forget(Stamp before) {
  for (StepperAxis& own : axes_) {
    own.forget(before);
  }
}

}  // namespace slamsensor::tools
