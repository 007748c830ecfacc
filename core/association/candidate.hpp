#pragma once

#include "core/association/landmark_index.hpp"
#include "core/association/rigid_fit.hpp"
#include "core/fix.hpp"
#include "core/limits.hpp"
#include "core/memory/fixed_vector.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace slamsensor::core {

using MatchList = FixedVector<Match, kScanLandmarksMax>;

/// A pose from which the scan explains part of the map.
struct Candidate {
  MapSlot map = 0;                          ///< the map that it lies in
  Pose2 pose_W;                             ///< refined by least squares over `matches`
  MatchList matches;                        ///< one to one, by increasing scan landmark
  std::array<std::uint32_t, 3> triangle{};  ///< the map landmarks that triangulated it first
  double residual_m2 = 0.0;                 ///< sum of squared distances over `matches`
  double score = 0.0;         ///< of the fast search: log likelihood of its matches against chance
  double log10_chance = 0.0;  ///< bound on the chance that a wrong pose does as well (significance.hpp)

  /// The triangle is the landmarks of the map that the `corners` of the scan match, and others of the matches
  /// where a corner has none.
  void name_triangle(std::span<const std::uint32_t, 3> corners) noexcept;

  /// More matches are better; among equals the smaller residual (the paper).
  [[nodiscard]] bool matches_more_than(const Candidate& other) const noexcept {
    return matches.size() != other.matches.size() ? matches.size() > other.matches.size()
                                                  : residual_m2 < other.residual_m2;
  }

  /// Less likely to be chance is better; among equals as the paper.
  [[nodiscard]] bool more_significant_than(const Candidate& other) const noexcept {
    return log10_chance != other.log10_chance ? log10_chance < other.log10_chance : matches_more_than(other);
  }
};

/// What a search found: the best candidates first, at most a few of them at one place.
struct Candidates {
  FixedVector<Candidate, kCandidatesMax> list;
  std::uint64_t poses_tried = 0;  ///< poses that were held against the map
  std::uint64_t vertices_searched = 0;
  std::uint64_t vertices_total = 0;
  std::uint64_t neighbours_dropped = 0;  ///< correspondence neighbours beyond kVertexNeighboursMax
  SearchEnd end = SearchEnd::NotStarted;
};

/// First and second moments of the scan's landmarks: enough to tell how far apart two poses put them.
class ScanMoments {
 public:
  explicit ScanMoments(std::span<const Point2> scan_L) noexcept;

  /// Root mean square distance (m) between the places that poses `a` and `b` give the scan's landmarks.
  [[nodiscard]] double displacement_m(const Pose2& a, const Pose2& b) const noexcept;

 private:
  Point2 mean_L_ = Point2::Zero();
  double mean_square_m2_ = 0.0;
};

}  // namespace slamsensor::core
