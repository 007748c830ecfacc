#pragma once

#include "core/config.hpp"
#include "core/localizer.hpp"
#include "tests/support/in_arena.hpp"

#include <span>

namespace slamsensor::bench {

/// The product's association over a frozen map, with the default configuration and capacities that just fit.
/// The paper's search goes through the whole order of its vertices and builds the graph of the map anew for
/// each scan.
class CoreMatcher {
 public:
  CoreMatcher(std::span<const core::Point2> map_W, core::SearchMethod search);

  struct Answer {
    core::FixStatus status = core::FixStatus::NoFix;
    core::Pose2 pose_W;  ///< of the best candidate, if there is one
  };
  [[nodiscard]] Answer locate(std::span<const core::Point2> scan_L);

  /// Bytes of the map, its index and the search.
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

 private:
  core::Config config_;
  tests::InArena<core::Localizer> localizer_;
  std::size_t bytes_ = 0;
};

}  // namespace slamsensor::bench
