#include "firmware/status/sensor_tracker.hpp"

namespace slamsensor::firmware {

void SensorTracker::on_fix(const core::Fix& fix, hal::Stamp made) {
  fix_ = fix;
  void_.reset();
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
  if (!all_ready_ || is_held_ || is_failing_) {
    void_ = core::FixReason::Device;  // until the next scan: nobody looked meanwhile
  } else if (is_timing_in_doubt_) {
    void_ = core::FixReason::Timing;
  }
}

/// The one place that decides whether there is a fix.
SensorTracker::Judgement SensorTracker::judge(hal::Stamp now) const {
  if (!were_ready_) {
    return {SensorState::Starting, core::FixReason::Device};
  }
  if (!all_ready_) {
    return {SensorState::Faulted, core::FixReason::Device};
  }
  if (is_held_) {
    return {SensorState::Held, core::FixReason::Device};
  }
  if (is_failing_) {
    return {SensorState::Faulted, core::FixReason::Device};
  }
  if (is_timing_in_doubt_) {
    return {SensorState::Lost, core::FixReason::Timing};
  }
  if (!fix_) {
    return {SensorState::Scanning, core::FixReason::NoScan};
  }
  if (now - made_ > hal::from_seconds(config_.stale_s)) {
    return {SensorState::Lost, core::FixReason::Stale};
  }
  if (void_ == core::FixReason::Device) {
    return {SensorState::Scanning, core::FixReason::NoScan};  // the head works again, and has scanned nothing
  }
  if (void_) {
    return {SensorState::Lost, void_};
  }
  switch (fix_->status) {
    case core::FixStatus::Fix:
      return {SensorState::Fixed, std::nullopt};
    case core::FixStatus::Ambiguous:
      return {SensorState::Ambiguous, std::nullopt};
    case core::FixStatus::NoFix:
      break;
  }
  return {SensorState::Lost, std::nullopt};
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
  if (const auto reason = judge(now).void_because) {
    report.fix.status = core::FixStatus::NoFix;
    report.fix.reason = *reason;
  }
  return report;
}

}  // namespace slamsensor::firmware
