#include "tools/emulator/ptu/emulated_ptu.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kStoredMax = 100;  // bytes that wait until the unit is selected; more are lost

std::string_view limit_report(PtuAxisId axis) {
  return axis == PtuAxisId::Pan ? "!P" : "!T";
}

// Uses up one of `count`; false when none is left.
bool take_one(unsigned& count) {
  if (count == 0) {
    return false;
  }
  --count;
  return true;
}

}  // namespace

void PtuPort::send(std::string_view bytes, Stamp now) {
  if (now < silent_until_) {
    return;
  }
  const std::vector<std::uint8_t> raw(bytes.begin(), bytes.end());
  sink_.send(raw, now);
}

void PtuPort::turn_to(PtuAudience audience, Stamp now) {
  audience_ = audience;
  if (audience == PtuAudience::Host && !stored_.empty()) {
    send(std::exchange(stored_, {}), now);
  }
}

void PtuPort::say(std::string_view bytes, Stamp now) {
  if (audience_ == PtuAudience::Host && !bytes.empty()) {
    send(bytes, now);
  }
}

void PtuPort::answer(const std::string& bytes, Stamp now) {
  if (bytes.empty() || take_one(swallow_)) {
    return;
  }
  std::string told = bytes;
  if (take_one(limit_inside_)) {
    const PtuAxisId axis = draw_unit(rng_) < 0.5 ? PtuAxisId::Pan : PtuAxisId::Tilt;
    const double inside = draw_uniform(rng_, 1.0, static_cast<double>(told.size()));
    told.insert(std::min(static_cast<std::size_t>(inside), told.size()), limit_report(axis));
  }
  if (take_one(twice_)) {
    told += std::string(told);
  }
  if (audience_ == PtuAudience::Host) {
    send(told, now);
  } else {
    stored_ += told.substr(0, kStoredMax - std::min(kStoredMax, stored_.size()));
  }
}

void PtuPort::report(PtuAxisId axis, Stamp now) {
  say(limit_report(axis), now);
}

void PtuPort::be_silent(Stamp until) {
  silent_until_ = std::max(silent_until_, until);
}

bool PtuPort::befall(FaultKind kind) {
  switch (kind) {
    case FaultKind::SwallowReply:
      ++swallow_;
      return true;
    case FaultKind::DoubleReply:
      ++twice_;
      return true;
    case FaultKind::LimitReport:
      ++limit_inside_;
      return true;
    default:
      return false;
  }
}

void PtuPort::cut_power() {
  stored_.clear();
  sink_.clear();
}

namespace {

constexpr std::size_t kInputMax = 100;  // bytes that wait for the unit; more are lost
constexpr std::size_t kTextMax = 64;    // longer commands do not exist

bool is_line_end(char c) {
  return c == '\r' || c == '\n';
}

constexpr Stamp kMemory = std::chrono::seconds(2);  // of where the axes were
constexpr double kArcsecRad = std::numbers::pi / (180.0 * 3600.0);

}  // namespace

EmulatedPtu::EmulatedPtu(const PtuSettings& settings, ByteSink& sink, std::uint64_t seed, Stamp start)
    : settings_(settings),
      sink_(sink),
      unit_(settings_, mix_seed(seed, 0)),
      port_(sink, mix_seed(seed, 1)),
      latency_(settings.reply_latency, mix_seed(seed, 2)),
      rng_(mix_seed(seed, 3)),
      baud_(settings.factory_baud) {
  if (settings.begin == PtuBegin::PowerUp) {
    power_on(start);
  }
}

bool EmulatedPtu::is_reading() const {
  return has_power_ && greet_at_ == hal::kNever && !pending_ && !reset_;
}

void EmulatedPtu::receive(std::uint8_t byte, Stamp at) {
  const bool is_deaf = greet_at_ != hal::kNever || (reset_ && reset_->is_starting);
  if (!has_power_ || is_deaf || input_.size() >= kInputMax) {
    ++dropped_bytes_;
    return;
  }
  const bool is_pair = std::exchange(has_heard_return_, byte == '\r') && byte == '\n';
  // A scan ends at once, even when an answer is still to come.
  if (unit_.head.is_monitoring() && !is_pair) {
    end_monitor(at);
    return;
  }
  input_.push_back(byte);
  settle(at);
}

void EmulatedPtu::process(Stamp now) {
  while (is_reading() && !input_.empty()) {
    const std::uint8_t byte = input_.front();
    input_.pop_front();
    take(byte, now);
  }
}

void EmulatedPtu::take(std::uint8_t byte, Stamp now) {
  const bool was_return = std::exchange(was_return_, byte == '\r');
  if (byte == '\n' && was_return) {
    return;
  }
  if (unit_.head.is_monitoring()) {
    end_monitor(now);
  } else {
    take_text(static_cast<char>(byte), now);
  }
}

void EmulatedPtu::end_monitor(Stamp now) {
  unit_.head.end_monitor(now);
  text_.clear();
}

void EmulatedPtu::take_text(char c, Stamp now) {
  if (c == ' ' || is_line_end(c)) {
    end_text(c, now);
    return;
  }
  if (unit_.head.config.echo == PtuEcho::On && unit_.may_speak()) {
    port_.say({&c, 1}, now);
  }
  if (text_.size() < kTextMax) {
    text_ += c;
  }
}

void EmulatedPtu::end_text(char delimiter, Stamp now) {
  const std::string text = std::exchange(text_, {});
  if (unit_.may_speak()) {
    const bool is_line = is_line_end(delimiter);
    if (unit_.head.config.echo == PtuEcho::On) {
      port_.say(is_line ? "\r\n" : " ", now);
    } else if (is_line && settings_.leading_lf == PtuLeadingLf::AfterLine) {
      port_.say("\n", now);
    }
  }
  if (!text.empty() && (unit_.is_addressed() || text.front() == '_')) {
    begin_answer(obey_ascii(unit_, text, now), now);
  }
}

void EmulatedPtu::choose_audience(Stamp now) {
  port_.turn_to(unit_.may_speak() ? PtuAudience::Host : PtuAudience::Store, now);
}

void EmulatedPtu::begin_answer(const AsciiAnswer& answer, Stamp now) {
  choose_audience(now);
  if (answer.bytes.empty()) {
    return;
  }
  if (answer.wait == AsciiAnswer::Wait::Reset) {
    begin_reset(answer.reset, {.answer = answer}, now);
    return;
  }
  const Stamp latency = latency_.draw() + std::exchange(late_, Stamp{});
  const Stamp wait = answer.wait == AsciiAnswer::Wait::Time ? answer.time : Stamp{};
  pending_ = Pending{now + wait + latency, answer, latency};
}

// A unit that awaits its motion notices the end when it comes, whatever changes that meanwhile.
Stamp EmulatedPtu::pending_due() const {
  if (pending_->answer.wait != AsciiAnswer::Wait::Motion || pending_->has_answered) {
    return pending_->due;
  }
  return std::max(pending_->due, unit_.head.still_from() + pending_->latency);
}

void EmulatedPtu::finish_pending(Stamp now) {
  Pending done = std::move(*pending_);
  pending_.reset();
  const auto rate = done.answer.baud;
  if (done.has_answered) {
    baud_ = rate.value_or(baud_);
    return;
  }
  port_.answer(done.answer.bytes, now);
  if (rate) {
    done.has_answered = true;
    done.due = std::max(now, sink_.busy_until());
    pending_ = std::move(done);
  }
}

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
  if (!reset_ || !reset_->is_starting || settings_.start_reports == PtuStartReports::Told) {
    port_.report(hit.axis, hit.at);
  }
}

void EmulatedPtu::power_on(Stamp now) {
  has_power_ = true;
  power_at_ = hal::kNever;
  unit_.restore();
  unit_.selected_unit = 0;
  baud_ = unit_.is_networked() ? settings_.factory_baud : unit_.head.config.start_baud;
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
  hits_.clear();
  pending_.reset();
  reset_.reset();
  late_ = {};
  unit_.head.cut_power(now);
  port_.cut_power();
}

void EmulatedPtu::greet(Stamp now) {
  greet_at_ = hal::kNever;
  port_.say(settings_.wording.banner, now);
  const PtuAxes& axes = unit_.head.config.power_up_reset;
  ResetRun run{.answer = {.bytes = "*\r\n"}, .is_starting = true};
  begin_reset(axes, run, now);
}

void EmulatedPtu::begin_reset(const PtuAxes& axes, ResetRun run, Stamp now) {
  AxesReset reset = unit_.head.begin_reset(axes, std::exchange(jam_, std::nullopt), now);
  hits_.assign(reset.hits.begin(), reset.hits.end());
  run.end = reset.end + latency_.draw() + std::exchange(late_, Stamp{});
  run.failure = std::move(reset.failure);
  reset_ = std::move(run);
}

void EmulatedPtu::finish_reset(Stamp now) {
  const ResetRun done = std::move(*reset_);
  reset_.reset();
  unit_.head.end_reset();
  port_.answer(done.failure.empty() ? done.answer.bytes : "! " + done.failure + "\r\n", now);
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
    case FaultKind::Blocked:
      unit_.head.axis(PtuAxisId::Pan).block(now, until);
      unit_.head.axis(PtuAxisId::Tilt).block(now, until);
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
    begin_reset({}, {.answer = {.bytes = "*\r\n"}}, now);
  }
}

void EmulatedPtu::miss_steps(Stamp now) {
  constexpr double kFewest = 5.0;  // steps that an obstacle takes
  constexpr double kMost = 60.0;
  const double steps = std::floor(draw_uniform(rng_, kFewest, kMost + 1.0));
  const bool is_chance_pan = draw_unit(rng_) < 0.5;
  const double chance_sign = draw_unit(rng_) < 0.5 ? -1.0 : 1.0;
  if (reset_) {
    return;  // the reset finds home in spite of it
  }
  const auto moves = [&](PtuAxisId id) { return unit_.head.axis(id).is_moving(now); };
  const bool is_pan = moves(PtuAxisId::Pan) || (!moves(PtuAxisId::Tilt) && is_chance_pan);
  StepperAxis& axis = unit_.head.axis(is_pan ? PtuAxisId::Pan : PtuAxisId::Tilt);
  const double speed = axis.speed(now);
  axis.miss(now, steps * (speed > 0.0 ? -1.0 : speed < 0.0 ? 1.0 : chance_sign));
}

HeadAngles EmulatedPtu::angles_at(Stamp at) const {
  const auto truth_rad = [&](PtuAxisId id) { return unit_.head.axis(id).truth_arcsec(at) * kArcsecRad; };
  return {truth_rad(PtuAxisId::Pan), truth_rad(PtuAxisId::Tilt)};
}

}  // namespace slamsensor::tools
