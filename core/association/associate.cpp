#include "core/association/associate.hpp"

#include <cmath>

namespace slamsensor::core {
Verdict associate(std::span<const Point2> scan_L, const MapView& map, const Config& config,
                  const Deadline& deadline, PaperSearch& search, Candidates& found) noexcept {
  search.search(scan_L, map, config.mapping.hypotheses_max, deadline, found);
  Verdict verdict = judge(found, scan_L, map, config.association.tolerance_m, config.acceptance);
  if (verdict.status != FixStatus::Fix && found.end == SearchEnd::Share &&
      config.association.exhaust_when_unsure) {
    search.search_rest(deadline, found);
    verdict = judge(found, scan_L, map, config.association.tolerance_m, config.acceptance);
  }
  return verdict;
}

void describe(const Verdict& verdict, const Candidates& found, std::size_t candidate,
              std::span<const Point2> scan_L, const MapView& map, const Config& config, Fix& fix) noexcept {
  fix.status = verdict.status;
  fix.reason = verdict.reason;
  fix.search_end = found.end;
  fix.expected_false_alarms = std::pow(10.0, verdict.log10_false_alarms);
  if (candidate >= found.list.size()) {
    return;
  }
  const Candidate& chosen = found.list[candidate];
  fix.pose_W = chosen.pose_W;
  fix.matches = static_cast<std::uint32_t>(chosen.matches.size());
  fix.covariance = candidate_covariance(chosen, scan_L, map.positions_W, config.association.tolerance_m);
}

}  // namespace slamsensor::core
