// What the publish thread sends beside NMEA: LCM, the lines of the GPIO panel, the log.
#include "firmware/daemon/publish_loop.hpp"

namespace slamsensor::firmware {
namespace {

constexpr hal::Stamp kLogPeriod = std::chrono::milliseconds(200);
// A map is sent in bursts, so that a receiver with little room (LCM's default: 30 messages) gets all of it.
constexpr std::uint32_t kMapChunksPerTurn = 8;
// A map that does not change is repeated for those who came later.
constexpr int kMapRepeatPeriods = 6;

}  // namespace

void PublishLoop::publish_fix(const FixMessage& message) {
  told_ = status_.report.fix.status;
  reason_told_ = status_.report.fix.reason;
  is_pose_told_ = core::has_pose(status_.report.fix);
  if (lcm_) {
    lcm_->publish(status_.report);
    lcm_->publish(ScanView{identity_.initialization, message.fix.scan, message.fix.time, message.seen()});
  }
}

/// A fix that is withdrawn between two scans (stale, a device lost) is told at once, and so is another reason
/// why there is none.
void PublishLoop::publish_state_change() {
  const core::Fix& fix = status_.report.fix;
  const bool is_news =
      fix.status != told_ || fix.reason != reason_told_ || core::has_pose(fix) != is_pose_told_;
  if (lcm_ && is_news) {
    lcm_->publish(status_.report);
  }
  told_ = fix.status;
  reason_told_ = fix.reason;
  is_pose_told_ = core::has_pose(fix);
}

void PublishLoop::publish_status(const OutputTime& now) {
  if (!lcm_ || now.monotonic < status_due_) {
    return;
  }
  status_due_ = now.monotonic + hal::from_seconds(1.0 / config_.lcm.status_hz);
  lcm_->publish(status_, now.utc);
}

void PublishLoop::publish_map(const OutputTime& now) {
  const std::scoped_lock lock(map_mutex_);
  if (!lcm_) {
    static_cast<void>(inlets_.slam.map.refresh());  // the supervisor saves it
    return;
  }
  if (!map_chunk_) {
    // Between two transmissions only: the chunks of one belong to one state of the map.
    static_cast<void>(inlets_.slam.map.refresh());
    const std::uint64_t revision = inlets_.slam.map.value().revision();
    const bool is_changed = now.monotonic >= map_due_ && revision != map_sent_;
    const bool is_repeat = now.monotonic >= map_repeat_ && revision != 0;
    if (!is_changed && !is_repeat) {
      return;
    }
    map_sent_ = revision;
    map_due_ = now.monotonic + hal::from_seconds(config_.lcm.map_period_s);
    map_repeat_ = now.monotonic + kMapRepeatPeriods * hal::from_seconds(config_.lcm.map_period_s);
    map_chunk_ = 0;
  }
  const core::MapState state = inlets_.slam.map.value().state();
  const LcmMapView view{now.utc, identity_.initialization, map_sent_, state.landmarks, state.positions_W};
  map_chunk_ = lcm_->publish(view, *map_chunk_, kMapChunksPerTurn);
}

void PublishLoop::drive_gpio(hal::Stamp now) {
  if (inlets_.gpio != nullptr) {
    inlets_.gpio->step(status_.state, now);
  }
}

void PublishLoop::log_changes(hal::Stamp now) {
  if (now < log_due_) {
    return;
  }
  log_due_ = now + kLogPeriod;
  for (const LogEntry& entry : logger_.compare(status_)) {
    inlets_.log.write(entry.level, entry.text);
  }
  log_problem("LCM", lcm_ ? lcm_sink_.problem() : std::string_view(), lcm_problem_);
  log_problem("NMEA", nmea_.problem(), nmea_problem_);
}

/// A problem of an output when it comes, when it changes and when it goes.
void PublishLoop::log_problem(std::string_view output, std::string_view problem, std::string& last) {
  if (problem == last) {
    return;
  }
  last = problem;
  if (problem.empty()) {
    inlets_.log.notice(std::string(output) + " output goes on");
  } else {
    inlets_.log.warning(std::string(output) + ": " + std::string(problem));
  }
}

}  // namespace slamsensor::firmware
