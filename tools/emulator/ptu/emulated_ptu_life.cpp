// What the unit does by itself, and what befalls it.
#include "tools/emulator/ptu/emulated_ptu.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr Stamp kMemory = std::chrono::seconds(2);  // of where the axes were
constexpr double kArcsecRad = std::numbers::pi / (180.0 * 3600.0);

}  // namespace

void EmulatedPtu::advance(Stamp now) {
  settle(now);
  unit_.head.forget(now - kMemory);
}

void EmulatedPtu::settle(Stamp now) {
  process(now);
  for (Stamp event = next_event(); event <= now; event = next_event()) {
    step(event);
    process(event);
  }
}

Stamp EmulatedPtu::next_event() const {
  if (!has_power_) {
    return power_at_;
  }
  Stamp next = std::min(greet_at_, unit_.head.next_event());
  if (!hits_.empty()) {
    next = std::min(next, hits_.front().at);
  }
  if (reset_) {
    next = std::min(next, reset_->end);
  }
  return pending_ ? std::min(next, pending_due()) : next;
}

void EmulatedPtu::step(Stamp now) {
  if (!has_power_) {
    power_on(now);
  } else if (greet_at_ <= now) {
    greet(now);
  } else if (!hits_.empty() && hits_.front().at <= now) {
    report_limit(hits_.front());
    hits_.pop_front();
  } else if (unit_.head.next_event() <= now) {
    if (const auto hit = unit_.head.step(now)) {
      report_limit(*hit);
    }
  } else if (reset_ && reset_->end <= now) {
    finish_reset(now);
  } else {
    finish_pending(now);
  }
}

void EmulatedPtu::report_limit(const PtuLimitHit& hit) {
  if (!reset_ || reset_->reports == PtuStartReports::Told) {
    port_.report(hit.axis, form_, hit.at);
  }
}

void EmulatedPtu::power_on(Stamp now) {
  has_power_ = true;
  power_at_ = hal::kNever;
  unit_.restore();
  unit_.selected_unit = 0;
  baud_ = unit_.is_networked() ? settings_.factory_baud : unit_.head.config.start_baud;
  form_ = PtuForm::Ascii;
  was_return_ = false;
  choose_audience(now);
  unit_.head.cut_power(now);
  greet_at_ = now + settings_.boot_time;
}

void EmulatedPtu::power_off(Stamp now, Stamp until) {
  has_power_ = false;
  power_at_ = std::max(until, power_at_ == hal::kNever ? until : power_at_);
  greet_at_ = hal::kNever;
  input_.clear();
  text_.clear();
  binary_.clear();
  hits_.clear();
  pending_.reset();
  reset_.reset();
  late_ = {};
  unit_.pass_through.reset();
  unit_.head.cut_power(now);
  port_.cut_power();
}

void EmulatedPtu::greet(Stamp now) {
  greet_at_ = hal::kNever;
  port_.say(settings_.wording.banner, now);
  const PtuAxes& axes = unit_.head.config.power_up_reset;
  ResetRun run{.answer = {.bytes = "*" + settings_.line_end},
               .input = settings_.starting,
               .reports = settings_.start_reports};
  is_scan_wanted_ = is_scan_wanted_ || unit_.head.config.monitor_at_power_up == PtuSwitch::On;
  begin_reset(axes, run, now);
}

void EmulatedPtu::begin_reset(const PtuAxes& axes, ResetRun run, Stamp now) {
  PtuReset reset = unit_.head.begin_reset(axes, std::exchange(jam_, std::nullopt), now);
  hits_.assign(reset.hits.begin(), reset.hits.end());
  run.end = reset.end + latency_.draw() + std::exchange(late_, Stamp{});
  run.verdict = std::move(reset.verdict);
  reset_ = std::move(run);
}

void EmulatedPtu::finish_reset(Stamp now) {
  const ResetRun done = std::move(*reset_);
  reset_.reset();
  unit_.head.end_reset();
  std::string bytes = done.answer.bytes;
  if (done.verdict.status != PtuStatus::Ok) {
    bytes = done.answer.form == PtuForm::Binary ? std::string(1, static_cast<char>(done.verdict.status))
                                                : "! " + done.verdict.error + settings_.line_end;
  }
  port_.answer(bytes, done.answer.form, now);
  if (std::exchange(is_scan_wanted_, false)) {
    unit_.head.begin_monitor(now);
  }
}

bool EmulatedPtu::inject(const Fault& fault) {
  const Stamp now = fault.at;
  const Stamp until = now + fault.duration;
  settle(now);
  switch (fault.kind) {
    case FaultKind::PowerCycle:
      power_off(now, until);
      break;
    case FaultKind::Silence:
      port_.be_silent(until);
      break;
    case FaultKind::BaudReset:
      baud_ = settings_.factory_baud;
      unit_.saved.start_baud = settings_.factory_baud;
      unit_.head.config.start_baud = settings_.factory_baud;
      break;
    case FaultKind::LateReply:
      late_ += fault.duration;
      break;
    case FaultKind::ResetError:
      fail_reset(now);
      break;
    case FaultKind::MissedSteps:
      miss_steps(now);
      break;
    case FaultKind::MonitorMode:
      begin_monitor(now);
      break;
    case FaultKind::SettingsLost:
      unit_.restore_factory();
      choose_audience(now);
      break;
    default:
      return port_.befall(fault.kind);
  }
  settle(now);
  return true;
}

void EmulatedPtu::begin_monitor(Stamp now) {
  if (!has_power_ || greet_at_ != hal::kNever || reset_) {
    is_scan_wanted_ = true;
  } else if (!unit_.head.is_monitoring()) {
    unit_.head.begin_monitor(now);
  }
}

// Without power, or before the unit has reset itself, the coming reset fails.
void EmulatedPtu::fail_reset(Stamp now) {
  jam_ = draw_unit(rng_) < 0.5 ? PtuAxisId::Pan : PtuAxisId::Tilt;
  if (has_power_ && greet_at_ == hal::kNever) {
    pending_.reset();
    hits_.clear();
    begin_reset({}, {.answer = {.bytes = "*" + settings_.line_end}}, now);
  }
}

void EmulatedPtu::miss_steps(Stamp now) {
  constexpr double kFewest = 5.0;
  const double most = std::max(static_cast<double>(settings_.missed_steps_max), kFewest);
  const double steps = std::floor(draw_uniform(rng_, kFewest, most + 1.0));
  const bool is_chance_pan = draw_unit(rng_) < 0.5;
  const double chance_sign = draw_unit(rng_) < 0.5 ? -1.0 : 1.0;
  if (reset_) {
    return;  // the reset finds home in spite of it
  }
  const auto moves = [&](PtuAxisId id) { return unit_.head.axis(id).is_moving(now); };
  const bool is_pan = moves(PtuAxisId::Pan) || (!moves(PtuAxisId::Tilt) && is_chance_pan);
  PtuAxis& axis = unit_.head.axis(is_pan ? PtuAxisId::Pan : PtuAxisId::Tilt);
  const double speed = axis.speed(now);
  axis.miss(now, steps * (speed > 0.0 ? -1.0 : speed < 0.0 ? 1.0 : chance_sign));
}

HeadAngles EmulatedPtu::angles_at(Stamp at) const {
  const auto truth_rad = [&](PtuAxisId id, int sign) {
    return sign * unit_.head.axis(id).truth_arcsec(at, settings_.steps) * kArcsecRad;
  };
  return {truth_rad(PtuAxisId::Pan, settings_.pan_sign), truth_rad(PtuAxisId::Tilt, settings_.tilt_sign)};
}

}  // namespace slamsensor::tools
