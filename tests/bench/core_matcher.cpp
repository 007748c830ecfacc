#include "tests/bench/core_matcher.hpp"

#include "tests/support/forest.hpp"

#include <cstdlib>
#include <memory>
#include <vector>

namespace slamsensor::bench {
namespace {

core::Config config_for(std::size_t landmarks, core::SearchMethod search) {
  core::Config config;
  config.association.search = search;
  config.association.order_share = 1.0;   // of the paper's search
  config.capacities.scan_landmarks = 32;  // the task's scans have at most 25
  config.capacities.map_landmarks = static_cast<std::uint32_t>(landmarks);
  config.capacities.map_edges = 12 * config.capacities.map_landmarks;
  config.capacities.path_poses = 1;  // a survey has no path
  config.capacities.sightings = 1;
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
      bytes_(bytes_of<core::Localizer>(config_)) {
  if (!localizer_->set_map(map_W)) {
    std::abort();
  }
}

CoreMatcher::Answer CoreMatcher::locate(std::span<const core::Point2> scan_L) {
  const core::Fix fix = localizer_->locate(tests::as_landmarks({scan_L.begin(), scan_L.end()}), {}, {});
  return {fix.status, fix.pose_W};
}

}  // namespace slamsensor::bench
