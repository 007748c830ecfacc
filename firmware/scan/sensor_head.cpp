#include "firmware/scan/sensor_head.hpp"

#include "core/detection/levelling.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::firmware {
namespace {

// What the drivers keep at most, and what may come in meanwhile.
constexpr std::size_t kRangeRounds = hal::kRangeSamplesMax / 512 + 1;
constexpr std::size_t kPositionRounds = hal::kAxisSamplesMax / 64 + 1;

constexpr hal::Stamp kStopped = std::chrono::milliseconds(500);  // between two steps
constexpr hal::Stamp kResumed = std::chrono::seconds(5);         // then all is as before

const hal::MotionProfile& profile(const void* model) noexcept {
  return *static_cast<const hal::MotionProfile*>(model);
}

}  // namespace

core::AxisPath path_of(const hal::MotionProfile& move) noexcept {
  return {&move,
          move.start_rad(),
          move.target_rad(),
          move.duration_s(),
          [](const void* model, double elapsed_s) noexcept { return profile(model).position_rad(elapsed_s); },
          [](const void* model, double elapsed_s) noexcept { return profile(model).speed_radps(elapsed_s); }};
}

core::TimedAngle timed(const hal::AxisSample& sample) noexcept {
  return {sample.stamp, sample.half_width, sample.position_rad,
          sample.axis == hal::Axis::Pan ? core::SweepAxis::Pan : core::SweepAxis::Tilt};
}

core::TimedRange timed(const hal::RangeSample& sample) noexcept {
  constexpr std::array kKinds = {core::EchoKind::Return, core::EchoKind::None, core::EchoKind::Weak,
                                 core::EchoKind::Saturated, core::EchoKind::Fault};  // as hal::Echo
  return {sample.stamp, sample.range_m, kKinds[static_cast<std::size_t>(sample.echo)]};
}

SensorHead::SensorHead(hal::PanTilt& pan_tilt, hal::Rangefinder& rangefinder, const SensorHeadConfig& config)
    : pan_tilt_(pan_tilt),
      rangefinder_(rangefinder),
      scheduler_(pan_tilt, rangefinder, config.scan),
      assembler_(core::AssemblerConfig{config.scan.readings_per_line_max, config.scan.polls_per_line_max,
                                       config.scan.late_data_s},
                 config.pan_fit),
      calibration_(config.latency),
      motion_(config.motion),
      levelling_(config.levelling),
      pan_sigma_max_rad_(config.scan.pan_sigma_max_rad),
      loose_max_share_(config.scan.lines_rejected_max_share),
      counters_({"lines_loose", "scans_loose", "scans_other_latency"}) {
  if (levelling_.source != InclinationSource::None) {
    levelled_.reserve(config.scan.readings_per_line_max);
  }
  if (levelling_.source == InclinationSource::Fixed) {
    attitude_ = levelling_.fixed;
  } else if (levelling_.has_inclinometer()) {
    scheduler_.hold(HoldReason::LeanUnknown);
  }
}

void SensorHead::step(hal::Stamp now) noexcept {
  resumed_ = stepped_ > hal::Stamp{} && now - stepped_ > kStopped ? now : resumed_;
  stepped_ = now;
  pan_tilt_.step(now);
  rangefinder_.step(now);
  take_samples();
  const bool knows_latency = !calibration_.is_busy() || (in_scan() && calibration_.has_looked());
  act(scheduler_.step(now, {assembler_->is_idle(), knows_latency}), now);
  finish_line(now);
  calibrate();
}

std::optional<HeadEvent> SensorHead::take() noexcept {
  HeadEvent event;
  if (events_.take({&event, 1}) == 0) {
    return std::nullopt;
  }
  return event;
}

std::string_view SensorHead::problem() const noexcept {
  if (pan_tilt_.state() != hal::DeviceState::Ready) {
    return pan_tilt_.problem();
  }
  if (rangefinder_.state() != hal::DeviceState::Ready) {
    return rangefinder_.problem();
  }
  for (const hal::Device* const device :
       {static_cast<const hal::Device*>(&pan_tilt_), static_cast<const hal::Device*>(&rangefinder_)}) {
    if (!device->timing_doubt().empty()) {
      return device->timing_doubt();
    }
  }
  if (const auto reason = scheduler_.held()) {
    return describe(*reason);
  }
  if (const auto& plan_problem = scheduler_.plan_problem()) {
    return describe(plan_problem->limit_hit);
  }
  if (const std::string_view failure = failure_.text(); !failure.empty()) {
    return failure;
  }
  return doubt_ ? describe(*doubt_) : std::string_view{};
}

bool SensorHead::is_failing() const noexcept {
  return failure_.is_failing() || scheduler_.plan_problem().has_value();
}

bool SensorHead::is_timing_in_doubt() const noexcept {
  return !pan_tilt_.timing_doubt().empty() || !rangefinder_.timing_doubt().empty();
}

void SensorHead::incline(const core::Attitude& reported) noexcept {
  if (!levelling_.has_inclinometer() || !std::isfinite(reported.roll_rad) ||
      !std::isfinite(reported.pitch_rad)) {
    return;
  }
  attitude_ = core::without_offset(reported, levelling_.offset);
  scheduler_.release(HoldReason::LeanUnknown);
  if (core::lean_rad(*attitude_) > levelling_.max_lean_rad) {
    scheduler_.hold(HoldReason::LeansTooFar);
  } else {
    scheduler_.release(HoldReason::LeansTooFar);
  }
  if (in_scan() && scan_attitude_ &&
      core::angle_between_rad(*attitude_, *scan_attitude_) > levelling_.moved_rad) {
    scheduler_.on_carrier_moved();
  }
}

void SensorHead::take_samples() noexcept {
  for (std::size_t round = 0; round < kPositionRounds; ++round) {
    const std::size_t count = pan_tilt_.take(positions_);
    for (std::size_t i = 0; i < count; ++i) {
      assembler_->add(timed(positions_[i]));
    }
    if (count < positions_.size()) {
      break;
    }
  }
  for (std::size_t round = 0; round < kRangeRounds; ++round) {
    const std::size_t count = rangefinder_.take(ranges_);
    for (std::size_t i = 0; i < count; ++i) {
      assembler_->add(timed(ranges_[i]));
      if (is_sweeping_) {
        readings_watch_.add(ranges_[i]);
      }
    }
    readings_ += count;
    if (count < ranges_.size()) {
      break;
    }
  }
}

void SensorHead::act(SchedulerAction action, hal::Stamp now) noexcept {
  switch (action) {
    case SchedulerAction::None:
      return;
    case SchedulerAction::PassBegun:
      return begin_pass();
    case SchedulerAction::LineBegun:
      is_sweeping_ = true;
      readings_watch_.begin_line();
      return begin_line();
    case SchedulerAction::LineEnded:
      move_ = pan_tilt_.axis(hal::Axis::Pan).move;
      is_sweeping_ = false;
      failure_.on_readings(readings_watch_);
      stuck_in_scan_ = stuck_in_scan_ || failure_.is_stuck();
      return assembler_->end_line(path_of(move_), now);
    case SchedulerAction::PassEnded:
      return end_pass(now);
    case SchedulerAction::PassAborted:
      return abort_pass();
  }
}

void SensorHead::begin_pass() noexcept {
  if (in_scan()) {
    scan_ = {};
    lines_loose_ = 0;
    stuck_in_scan_ = false;
    scan_.scan = scans_++;
    scan_attitude_ = attitude_;
    motion_.begin_scan();
    push(ScanBegun{scan_.scan});
  }
}

void SensorHead::begin_line() noexcept {
  const ScanPlan& plan = scheduler_.plan();
  if (scheduler_.line() == 0) {
    if (calibration_due_) {
      calibration_.end_pass();
      calibration_due_ = false;
    }
    const double rate_hz = std::max(1.0, rangefinder_.info().rate_hz);
    calibration_.begin_pass(plan.pan_min_rad, plan.pan_max_rad, plan.pan_speed_radps / rate_hz);
  }
  assembler_->begin_line({scheduler_.line(), pan_tilt_.axis(hal::Axis::Tilt).position_rad,
                          plan.pan_resolution_rad, plan.tilt_resolution_rad});
}

void SensorHead::end_pass(hal::Stamp now) noexcept {
  calibration_due_ = true;
  scan_attitude_.reset();
  failure_.on_pass();
  if (!in_scan()) {
    return;
  }
  if (stuck_in_scan_) {
    last_abort_ = ScanAbort::LinesRejected;
    push(ScanAborted{scan_.scan, ScanAbort::LinesRejected});
    return;
  }
  doubt_ = judge_timing();
  if (doubt_) {
    last_abort_ = ScanAbort::TimingInDoubt;
    push(ScanAborted{scan_.scan, ScanAbort::TimingInDoubt});
    return;
  }
  motion_.end_scan();
  if (motion_.has_moved()) {
    last_abort_ = ScanAbort::CarrierMoved;
    push(ScanAborted{scan_.scan, ScanAbort::CarrierMoved});
    return;
  }
  scan_.middle = scan_.begin + (scan_.end - scan_.begin) / 2;
  scan_.lines_rejected = scheduler_.lines_rejected() + lines_loose_;
  scan_.known = now;
  push(scan_);
}

std::optional<ScanDoubt> SensorHead::judge_timing() noexcept {
  const ScanPlan& plan = scheduler_.plan();
  if (lines_loose_ > loose_max_share_ * plan.lines) {
    counters_.count(HeadEventCount::ScansLoose);
    const bool is_measured = latency().pairs > 0 || latency().sigma_s == 0.0;
    return is_measured ? ScanDoubt::PositionsLoose : ScanDoubt::LatencyUnknown;
  }
  if (calibration_.departs(pan_sigma_max_rad_ / plan.pan_speed_radps)) {
    counters_.count(HeadEventCount::ScansOtherLatency);
    return ScanDoubt::OtherLatency;
  }
  return std::nullopt;
}

void SensorHead::abort_pass() noexcept {
  scan_attitude_.reset();
  is_sweeping_ = false;
  assembler_->abandon();
  last_abort_ = scheduler_.abort_reason();
  if (resumed_ == hal::Stamp{} || stepped_ - resumed_ > kResumed) {  // else nobody listened to the devices
    failure_.on_abort({*last_abort_, scheduler_.move(hal::Axis::Pan), scheduler_.move(hal::Axis::Tilt),
                       scheduler_.lines_rejected(), scheduler_.plan().lines, pan_tilt_.line_trouble()});
  }
  if (last_abort_ == ScanAbort::TimingInDoubt) {
    doubt_ = ScanDoubt::Device;
  }
  if (in_scan()) {
    push(ScanAborted{scan_.scan, scheduler_.abort_reason()});
  }
}

void SensorHead::finish_line(hal::Stamp now) noexcept {
  const auto line = assembler_->step(now, calibration_.latency());
  if (!line) {
    return;
  }
  if (!*line) {
    scheduler_.on_line_rejected();
    failure_.on_line_rejected(line->error());
    return;
  }
  failure_.on_line();
  calibration_.add(**line);
  if (!in_scan()) {
    return;
  }
  if ((*line)->pan_sigma_rad > pan_sigma_max_rad_) {
    ++lines_loose_;
    counters_.count(HeadEventCount::LinesLoose);
  } else {
    motion_.add(**line);
    if (motion_.has_moved()) {
      scheduler_.on_carrier_moved();
    }
    hand_out(**line);
  }
}

void SensorHead::hand_out(const Scanline& line) noexcept {
  if (scan_.lines++ == 0) {
    scan_.begin = line.stamps.front();
  }
  scan_.end = line.stamps.back();
  push(attitude_ ? levelled(line) : line);
}

Scanline SensorHead::levelled(Scanline line) noexcept {
  const core::Levelling level(*attitude_);
  levelled_.clear();
  for (const core::Reading& reading : line.readings) {
    levelled_.push_back(level(reading));
  }
  line.readings = levelled_;
  return line;
}

void SensorHead::calibrate() noexcept {
  calibration_.step();
  if (calibration_due_ && !calibration_.is_busy()) {
    calibration_.end_pass();
    calibration_due_ = false;
  }
}

void SensorHead::push(const HeadEvent& event) noexcept {
  if (!events_.try_push(event)) {
    ++events_dropped_;
  }
}

}  // namespace slamsensor::firmware
