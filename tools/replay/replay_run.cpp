#include "tools/replay/replay_run.hpp"

#include <chrono>
#include <utility>

namespace slamsensor::tools {

const FixRow& ReplayRun::add(std::int64_t number, double t_s, const std::function<core::Fix()>& localise) {
  const auto begin = std::chrono::steady_clock::now();
  FixRow row;
  row.scan = number;
  row.t_s = t_s;
  row.fix = localise();
  row.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  numbers_[row.fix.scan] = number;  // after a reset the scans are counted anew
  return result_.rows.emplace_back(row);
}

std::int64_t ReplayRun::number_of(std::uint32_t scan) const {
  const auto found = numbers_.find(scan);
  return found != numbers_.end() ? found->second : -1;
}

void ReplayRun::take_map(const core::HypothesisSet& hypotheses) {
  if (hypotheses.empty()) {
    return;
  }
  const core::Hypothesis& best = hypotheses.best();
  const std::uint32_t last_in_map = best.path.empty() ? 0 : best.path.back().scan;
  for (std::size_t i = 0; i < best.map.size(); ++i) {
    const core::MapLandmark& l = best.map.landmarks()[i];
    result_.map.push_back({l.id, best.map.positions_W()[i], l.xi, l.sightings, number_of(l.first_scan),
                           number_of(l.last_scan)});
    result_.matched.push_back(l.last_scan == last_in_map && l.first_scan != last_in_map);
  }
  result_.landmarks_evicted = best.landmarks_evicted;
  result_.path_thinnings = best.path_thinnings;
}

Replay ReplayRun::finish() {
  const core::Slam& slam = pipeline_.slam();
  result_.counters = slam.hypotheses().counters();
  take_map(slam.hypotheses());
  result_.cells_dropped = slam.detector().cells_dropped();
  result_.readings_refused = slam.detector().readings_refused();
  return std::move(result_);
}

}  // namespace slamsensor::tools
