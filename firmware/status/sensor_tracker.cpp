#include "firmware/status/sensor_tracker.hpp"

namespace slamsensor::firmware {

void SensorTracker::on_fix(const core::Fix& fix, hal::Stamp made) {
  fix_ = fix;
  made_ = made;
  if (fix.status == core::FixStatus::Fix && !time_to_first_fix_) {
    time_to_first_fix_ = made - start_;
  }
}

void SensorTracker::on_head(const HeadStatus& head) {
  all_ready_ = head.pan_tilt.state == hal::DeviceState::Ready &&
               head.rangefinder.state == hal::DeviceState::Ready &&
               (!head.inclinometer || head.inclinometer->state == hal::DeviceState::Ready);
  were_ready_ = were_ready_ || all_ready_;
  is_held_ = head.held;
  is_timing_in_doubt_ = head.timing_in_doubt;
  is_failing_ = head.failing;
  if (fix_ && (!all_ready_ || is_held_ || is_failing_)) {
    // Nobody looked meanwhile: where the sensor was is a fix again when the next scan says so.
    fix_->status = core::FixStatus::NoFix;
    fix_->reason = core::FixReason::Device;
  } else if (fix_ && is_timing_in_doubt_) {
    fix_->status = core::FixStatus::NoFix;
    fix_->reason = core::FixReason::Timing;
  }
}

bool SensorTracker::is_stale(hal::Stamp now) const {
  return now - made_ > hal::from_seconds(config_.stale_s);
}

SensorState SensorTracker::state(hal::Stamp now) const {
  if (!were_ready_) {
    return SensorState::Starting;
  }
  if (!all_ready_) {
    return SensorState::Faulted;
  }
  if (is_held_) {
    return SensorState::Held;
  }
  if (is_failing_) {
    return SensorState::Faulted;
  }
  if (is_timing_in_doubt_) {
    return SensorState::Lost;
  }
  if (!fix_) {
    return SensorState::Scanning;
  }
  if (is_stale(now) || fix_->status == core::FixStatus::NoFix) {
    return SensorState::Lost;
  }
  return fix_->status == core::FixStatus::Fix ? SensorState::Fixed : SensorState::Ambiguous;
}

FixReport SensorTracker::report(hal::Stamp now) const {
  FixReport report;
  report.source = source_;
  report.monotonic = now;
  report.uptime = now - start_;
  report.time_to_first_fix = time_to_first_fix_;
  report.initialization = initialization_;
  if (fix_) {
    report.fix = *fix_;
  }
  switch (state(now)) {
    case SensorState::Starting:
    case SensorState::Faulted:
    case SensorState::Held:
      report.fix.status = core::FixStatus::NoFix;
      report.fix.reason = core::FixReason::Device;
      break;
    case SensorState::Lost:
      if (is_timing_in_doubt_) {
        report.fix.status = core::FixStatus::NoFix;
        report.fix.reason = core::FixReason::Timing;
      } else if (is_stale(now)) {
        report.fix.status = core::FixStatus::NoFix;
        report.fix.reason = core::FixReason::Stale;
      }
      break;
    case SensorState::Scanning:
    case SensorState::Fixed:
    case SensorState::Ambiguous:
      break;
  }
  return report;
}

}  // namespace slamsensor::firmware
