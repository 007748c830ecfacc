#pragma once

#include "core/association/associate.hpp"
#include "core/association/paper_search.hpp"
#include "core/config.hpp"
#include "core/mapping/landmark_map.hpp"
#include "tests/support/in_arena.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace slamsensor::bench {

/// How far core::PaperSearch goes.
enum class Effort : std::uint8_t {
  Eighth,   ///< an eighth of the vertex order (the paper)
  Whole,    ///< the whole order
  Product,  ///< an eighth, and the rest when that gave no fix: the product's default
};

/// The product's association over a frozen map, with the default configuration and capacities that just fit.
class CoreMatcher {
 public:
  CoreMatcher(std::span<const core::Point2> map_W, Effort effort);

  struct Answer {
    core::FixStatus status = core::FixStatus::NoFix;
    core::Pose2 pose_W;  ///< of the best candidate, if there is one
  };
  [[nodiscard]] Answer locate(std::span<const core::Point2> scan_L);

  /// Bytes of one map, its index and the search.
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }

 private:
  core::Config config_;
  tests::InArena<core::LandmarkMap> map_;
  tests::InArena<core::PaperSearch> search_;
  std::unique_ptr<core::Candidates> found_ = std::make_unique<core::Candidates>();
  std::size_t bytes_ = 0;
};

}  // namespace slamsensor::bench
