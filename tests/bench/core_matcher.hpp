#pragma once

#include "core/association/landmark_index.hpp"
#include "core/config.hpp"
#include "core/localizer.hpp"
#include "tests/support/in_arena.hpp"

#include <span>
#include <vector>

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
  /// Bytes of the index alone.
  [[nodiscard]] std::size_t index_bytes() const noexcept { return index_bytes_; }

 private:
  core::Config config_;
  tests::InArena<core::Localizer> localizer_;
  std::size_t bytes_ = 0;
  std::size_t index_bytes_ = 0;
};

/// What the index alone costs while a map changes as scans change it.
class IndexUnderChange {
 public:
  explicit IndexUnderChange(std::span<const core::Point2> map_W);

  /// A scan's worth of changes about a landmark of the map: 20 landmarks moved by centimetres, 2 moved so far
  /// that they are linked anew, 2 taken out and 2 put in.
  void change_about(std::uint32_t slot);

 private:
  std::vector<core::Point2> map_W_;
  tests::InArena<core::LandmarkIndex> index_;
  std::uint32_t changes_ = 0;
};

}  // namespace slamsensor::bench
