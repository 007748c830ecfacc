#include "tests/bench/core_matcher.hpp"

#include <cstdlib>

namespace slamsensor::bench {
namespace {

core::Config config_for(std::size_t landmarks, Effort effort) {
  core::Config config;
  config.association.order_share = effort == Effort::Whole ? 1.0 : 0.125;
  config.association.exhaust_when_unsure = effort == Effort::Product;
  config.mapping.hypotheses_max = 1;      // a frozen map needs one pose per place
  config.capacities.scan_landmarks = 32;  // the task's scans have at most 25
  config.capacities.map_landmarks = static_cast<std::uint32_t>(landmarks);
  config.capacities.map_edges = 12 * config.capacities.map_landmarks;
  return config;
}

/// Bytes that a T takes from its arena, and its own.
template <typename T, typename... Args>
std::size_t bytes_of(const Args&... args) {
  core::Arena measuring;
  const auto measured = std::make_unique<T>(measuring, args...);
  return measuring.bytes_used() + sizeof(T);
}

}  // namespace

CoreMatcher::CoreMatcher(std::span<const core::Point2> map_W, Effort effort)
    : config_(config_for(map_W.size(), effort)),
      map_(config_.capacities),
      search_(config_.association, config_.capacities) {
  for (const core::Point2& p : map_W) {
    if (!map_->try_add({}, p)) {
      std::abort();
    }
  }
  tests::InArena<core::Delaunay> delaunay(config_.capacities.map_landmarks);
  map_->rebuild_index(*delaunay, config_.association);
  bytes_ = bytes_of<core::LandmarkMap>(config_.capacities) +
           bytes_of<core::PaperSearch>(config_.association, config_.capacities) + sizeof(core::Candidates);
}

CoreMatcher::Answer CoreMatcher::locate(std::span<const core::Point2> scan_L) {
  const core::Verdict verdict = core::associate(scan_L, map_->view(), config_, {}, *search_, *found_);
  return {verdict.status, found_->list.empty() ? core::Pose2{} : found_->list[0].pose_W};
}

}  // namespace slamsensor::bench
