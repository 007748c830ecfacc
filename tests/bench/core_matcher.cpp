#include "tests/bench/core_matcher.hpp"

#include "tests/support/forest.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <vector>

namespace slamsensor::bench {
namespace {

core::Config config_for(std::size_t landmarks, core::SearchMethod search) {
  core::Config config;
  config.association.search = search;
  config.association.order_share = 1.0;  // of the paper's search
  config.capacities.scan_landmarks = core::kScanLandmarksMax;
  config.capacities.map_landmarks = static_cast<std::uint32_t>(landmarks);
  config.capacities.map_edges = 12 * config.capacities.map_landmarks;
  config.capacities.path_poses = 1;  // a survey has no path
  config.capacities.sightings = core::kScanLandmarksMax;
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

CoreMatcher::CoreMatcher(std::span<const core::Point2> map_W, core::SearchMethod search)
    : config_(config_for(map_W.size(), search)),
      localizer_(config_),
      bytes_(bytes_of<core::Localizer>(config_)),
      index_bytes_(bytes_of<core::LandmarkIndex>(config_.association, config_.capacities)) {
  if (!localizer_->set_map(map_W)) {
    std::abort();
  }
}

CoreMatcher::Answer CoreMatcher::locate(std::span<const core::Point2> scan_L) {
  const core::Fix fix = localizer_->locate(tests::as_landmarks({scan_L.begin(), scan_L.end()}), {}, {});
  return {fix.status, fix.pose_W};
}

IndexUnderChange::IndexUnderChange(std::span<const core::Point2> map_W)
    : map_W_(map_W.begin(), map_W.end()),
      index_(core::AssociationConfig{}, config_for(map_W.size(), core::SearchMethod::Fast).capacities) {
  for (std::uint32_t slot = 0; slot < map_W_.size(); ++slot) {
    index_->insert(slot, 0, map_W_[slot]);
  }
}

void IndexUnderChange::change_about(std::uint32_t slot) {
  constexpr double kReach_m = 25.0;
  std::vector<std::uint32_t> near;
  index_->visit_within(0, map_W_[slot], kReach_m,
                       [&](std::uint32_t other, double) { near.push_back(other); });
  const double sign = changes_++ % 2 == 0 ? 1.0 : -1.0;
  for (std::uint32_t i = 0; i < std::min<std::size_t>(near.size(), 24); ++i) {
    core::Point2& p = map_W_[near[i]];
    if (i < 2) {
      index_->erase(near[i]);
      index_->insert(near[i], 0, p);
    } else {
      p.x() += sign * (i < 4 ? 0.3 : 0.02);
      index_->move(near[i], p);
    }
  }
}

}  // namespace slamsensor::bench
