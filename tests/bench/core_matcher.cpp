#include "tests/bench/core_matcher.hpp"

#include <cstdlib>

namespace slamsensor::bench {
namespace {

constexpr std::uint32_t kScanLandmarks = 32;  // the task's scans have at most 25
constexpr std::uint32_t kVariants = 1;        // a frozen map needs one pose per place

core::AssociationConfig config_for(Effort effort) {
  core::AssociationConfig config;
  config.order_share = effort == Effort::Whole ? 1.0 : 0.125;
  return config;
}

core::Capacities capacities_for(std::size_t landmarks) {
  core::Capacities capacities;
  capacities.scan_landmarks = kScanLandmarks;
  capacities.map_landmarks = static_cast<std::uint32_t>(landmarks);
  capacities.map_edges = 12 * capacities.map_landmarks;
  return capacities;
}

}  // namespace

CoreMatcher::CoreMatcher(std::span<const core::Point2> map_W, Effort effort)
    : effort_(effort),
      config_(config_for(effort)),
      capacities_(capacities_for(map_W.size())),
      map_(capacities_),
      search_(config_, capacities_) {
  for (const core::Point2& p : map_W) {
    if (!map_->try_add({}, p)) {
      std::abort();
    }
  }
  tests::InArena<core::Delaunay> delaunay(capacities_.map_landmarks);
  map_->rebuild_index(*delaunay, config_);
  core::Arena measuring;
  const core::LandmarkMap map(measuring, capacities_);
  const auto search = std::make_unique<core::PaperSearch>(measuring, config_, capacities_);
  bytes_ = measuring.bytes_used() + sizeof(core::LandmarkMap) + sizeof(core::PaperSearch) +
           sizeof(core::Candidates);
}

CoreMatcher::Answer CoreMatcher::locate(std::span<const core::Point2> scan_L) {
  const core::MapView map = map_->view();
  const core::AcceptanceConfig acceptance;
  search_->search(scan_L, map, kVariants, {}, *found_);
  core::Verdict verdict = core::judge(*found_, scan_L, map, config_.tolerance_m, acceptance);
  if (effort_ == Effort::Product && verdict.status != core::FixStatus::Fix &&
      found_->end == core::SearchEnd::Share) {
    search_->search_rest({}, *found_);
    verdict = core::judge(*found_, scan_L, map, config_.tolerance_m, acceptance);
  }
  return {verdict.status, found_->list.empty() ? core::Pose2{} : found_->list[0].pose_W};
}

}  // namespace slamsensor::bench
