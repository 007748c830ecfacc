#include "tools/replay/replay_run.hpp"

#include <chrono>
#include <utility>

namespace slamsensor::tools {

namespace {

std::chrono::nanoseconds steady_now(void*) noexcept {
  return std::chrono::steady_clock::now().time_since_epoch();
}

}  // namespace

core::Deadline ReplayRun::deadline_from(std::chrono::steady_clock::time_point begin) const {
  return clock_ == ReplayClock::Off
             ? core::Deadline{}
             : core::Deadline{steady_now, nullptr, begin.time_since_epoch() + deadline_};
}

const FixRow& ReplayRun::add(std::int64_t number, double t_s,
                             const std::function<core::Fix(const core::Deadline&)>& localise) {
  const auto begin = std::chrono::steady_clock::now();
  FixRow row;
  row.scan = number;
  row.t_s = t_s;
  row.fix = localise(deadline_from(begin));
  row.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  scans_[row.fix.scan] = {number, t_s};  // after a reset the scans are counted anew
  return result_.rows.emplace_back(row);
}

std::int64_t ReplayRun::number_of(std::uint32_t scan) const {
  const auto found = scans_.find(scan);
  return found != scans_.end() ? found->second.number : -1;
}

void ReplayRun::take_map(const core::Slam& slam) {
  std::vector<core::MapLandmark> landmarks(capacities_.map_landmarks);
  std::vector<core::Point2> positions_W(capacities_.map_landmarks, core::Point2::Zero());
  std::vector<core::PathPose> path(capacities_.path_poses);
  const core::MapState map = slam.copy_map({landmarks, positions_W, path});
  const std::uint32_t last_in_map = map.path.empty() ? 0 : map.path.back().scan;
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const core::MapLandmark& l = map.landmarks[i];
    result_.map.push_back(
        {l.id, map.positions_W[i], l.xi, l.sightings, number_of(l.first_scan), number_of(l.last_scan)});
    result_.matched.push_back(l.last_scan == last_in_map && l.first_scan != last_in_map);
  }
  for (const core::PathPose& pose : map.path) {
    if (const auto found = scans_.find(pose.scan); found != scans_.end()) {
      result_.path.push_back({found->second.t_s, pose.pose_W});
    }
  }
  result_.landmarks_evicted = map.landmarks_evicted;
  result_.path_thinnings = map.path_thinnings;
}

Replay ReplayRun::finish() {
  const core::Slam& slam = pipeline_.slam();
  result_.counters = slam.counters();
  result_.maps = slam.maps();
  take_map(slam);
  result_.cells_dropped = slam.detector().cells_dropped();
  result_.readings_refused = slam.detector().readings_refused();
  return std::move(result_);
}

}  // namespace slamsensor::tools
