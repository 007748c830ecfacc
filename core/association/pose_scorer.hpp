#pragma once

#include "core/association/candidate.hpp"
#include "core/association/map_view.hpp"
#include "core/config.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::core {

/// Holds poses against a map: which landmarks of the scan find a partner.
class PoseScorer {
 public:
  PoseScorer(Arena& arena, const AssociationConfig& config, std::uint32_t map_landmarks_max) noexcept;

  /// Number of scan landmarks with a map landmark within the tolerance under `pose_W` (not yet one to one),
  /// or any number below `enough` as soon as `enough` cannot be reached any more.
  [[nodiscard]] std::uint32_t count_inliers(const Pose2& pose_W, std::span<const Point2> scan_L,
                                            const MapView& map, std::uint32_t enough) const noexcept;

  /// One-to-one matches under `pose_W`, each scan landmark with its nearest map landmark within the
  /// tolerance; where two claim the same one, the nearer wins. Returns the sum of squared distances (m^2).
  double match(const Pose2& pose_W, std::span<const Point2> scan_L, const MapView& map,
               MatchList& matches) noexcept;

  /// Fits and matches alternately, at most kRefinements times, until the matches stay. Keeps the best seen.
  /// None when fewer than 3 landmarks match.
  [[nodiscard]] std::optional<Candidate> refine(const Pose2& pose_W, std::span<const Point2> scan_L,
                                                const MapView& map) noexcept;

 private:
  static constexpr int kRefinements = 4;

  struct Claim {
    std::uint64_t round = 0;  // of `round_`; older claims are void
    std::uint32_t slot = 0;
    float distance2_m2 = 0.0F;
  };
  AssociationConfig config_;
  BoundedVector<Claim> claims_;  // per map landmark
  std::uint64_t round_ = 0;
};

}  // namespace slamsensor::core
