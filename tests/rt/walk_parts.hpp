#pragma once

#include "core/config.hpp"
#include "core/fix.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace slamsensor::tests {

inline constexpr std::uint64_t kSeed = 20;  ///< each walk adds its own number

[[nodiscard]] inline std::int64_t count(const std::vector<core::Fix>& fixes, core::FixStatus status) {
  return std::count_if(fixes.begin(), fixes.end(),
                       [&](const core::Fix& fix) { return fix.status == status; });
}

[[nodiscard]] inline std::int64_t count(const std::vector<core::Fix>& fixes, core::FixReason reason) {
  return std::count_if(fixes.begin(), fixes.end(),
                       [&](const core::Fix& fix) { return fix.reason == reason; });
}

/// Capacities of a small world, and no more.
[[nodiscard]] inline core::Config small_config(core::SearchMethod search = core::SearchMethod::Fast) {
  core::Config config;
  config.association.search = search;
  config.capacities.map_landmarks = 600;
  config.capacities.map_edges = 8000;
  config.capacities.scan_landmarks = 40;
  config.capacities.path_poses = 200;
  config.capacities.sightings = 6000;
  return config;
}

}  // namespace slamsensor::tests
