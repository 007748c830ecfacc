#pragma once

#include "core/association/candidate.hpp"
#include "core/association/landmark_index.hpp"
#include "core/config.hpp"
#include "core/decision/explored_ground.hpp"
#include "core/decision/rates.hpp"
#include "core/decision/scan_view.hpp"
#include "core/landmark_size.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace slamsensor::core {

/// What is known of a landmark of a map beside its place, as the decision needs it.
struct Standing {
  std::uint32_t sightings = 1;
  std::uint32_t chances = 1;  ///< scans whose view should have shown it, sightings included
  LandmarkSize size{};
};

/// Landmarks that are held against the maps: those of a scan, or the confirmed ones of a local map.
struct Witnesses {
  std::span<const Point2> points_B;     ///< m, in the frame B whose pose is sought
  std::span<const LandmarkSize> sizes;  ///< of each of them
  const ScanView* view = nullptr;       ///< of a scan; null for a local map
  Pose2 T_L_B;                          ///< of a scan: from B to the sensor's frame, in which the view is
  MapSlot own_map = 0;                  ///< of a local map: the map whose explored ground is the view
  Pose2 T_own_B;                        ///< of a local map: from B to its frame
  bool is_surveyed = false;     ///< the maps are complete: what looks like a place is that place or chance
  double sensor_reach_m = 0.0;  ///< of a short one groups are a share; 0: no groups but the usual ones
  double sigma_share = 1.0;     ///< spread of a witness, as a share of a scan's: a mean of sightings has less
};

/// The maps that witnesses are held against.
struct Maps {
  const LandmarkIndex& index;
  std::span<const Point2> positions;   ///< by slot, each in the frame of its map
  std::span<const Standing> standing;  ///< by slot
  const ExploredGround& ground;
  const Rates& rates;
};

/// What speaks for and against one pose. Logarithms: ln in nats, log10 in decades.
struct Evidence {
  double ln_bayes =
      -std::numeric_limits<double>::infinity();  ///< against an unmapped place, all poses alike before
  double ln_sizes = 0.0;                         ///< the part of it that the sizes of the matches have
  double group_decades =
      0.0;  ///< independent groups of matches, each at most one decade, the largest not counted
  double small_group_decades = 0.0;  ///< the same where copies are a share of the sensor's reach at most
  double log10_unmatched = 0.0;      ///< chance of so many landmarks without a counterpart on explored ground
  double log10_missing = 0.0;    ///< chance of so many landmarks of the map not shown where they should be
  double log10_odd_sizes = 0.0;  ///< chance of so many matches that are not as thick as the map has them
  std::uint32_t unmatched = 0;   ///< landmarks without a counterpart on explored ground
  std::uint32_t explored = 0;    ///< landmarks on explored ground
  std::uint32_t missing = 0;     ///< landmarks of the map in view that are not shown
  std::uint32_t in_view = 0;     ///< landmarks of the map in view
  double sigma_m = 0.0;          ///< spread of the matches about the map, per axis, scan alone
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Identity();  ///< of (x m, y m, heading rad) beside the landmarks

  [[nodiscard]] double contradiction_decades() const noexcept {
    return -(log10_unmatched + log10_missing + log10_odd_sizes);
  }
};

/// Weighs the evidence for a pose (DESIGN 2.4).
///
/// Model. Witnesses are a Poisson scatter of density lambda on new ground. From the true pose each landmark j
/// of the map in view is shown with chance d_j and stands about its place with a spread sigma; witnesses
/// without a counterpart have density lambda (1 - e + e c), where e is the share to which that ground was
/// explored and c the clutter share. The ratio of this density to that of a scan from an unmapped place,
/// integrated over the pose (Laplace) and over sigma (inverse gamma prior from what was learned), over the
/// area A of all maps and all headings, is the Bayes factor
///   BF = prod_matched (d_j / lambda) N(r_j) . prod_missing (1 - d_j) . prod_unmatched (1 - e + e c)
///        . exp((1 - c) k mean(e)) . |H|^(-1/2) / (2 pi A).
/// For scans from elsewhere its mean is at most 1, so P(BF >= t) <= 1/t however many poses were tried: it
/// needs no count of tests. What it cannot know is that the world comes in copies. Hence the two others.
/// Landmarks within the size of a copy are one witness: groups count at most a decade each, the largest not
/// at all. And what contradicts the pose counts by the tail of a beta-binomial, whose spread the rates give.
/// Where witnesses have a size, each match multiplies BF by how likely its size is for that landmark, against
/// its likelihood for any other that the witnesses show: what all of them have in common says nothing. Sizes
/// that disagree contradict the pose, by the same tail.
/// In a survey nothing is learned of d: there the share that a scan shows is integrated out under a beta
/// prior.
class EvidenceScale {
 public:
  EvidenceScale(const AssociationConfig& association, const AcceptanceConfig& acceptance) noexcept
      : association_(association), acceptance_(acceptance) {}

  /// Matches the witnesses again under the candidate's pose, gated by the spread and not by the tolerance,
  /// refines the pose with the result, and weighs it. `candidate` keeps its map and triangle.
  [[nodiscard]] Evidence weigh(const Witnesses& witnesses, const Maps& maps, Candidate& candidate) noexcept;

  /// 1 sigma per axis that matches have before anything was learned: a third of the tolerance, and at most
  /// kStartSigmaMax_m.
  [[nodiscard]] double start_sigma_m() const noexcept {
    return std::min(kStartSigmaMax_m, kStartSigma * association_.tolerance_m);
  }

 private:
  static constexpr double kStartSigma = 1.0 / 3.0;
  static constexpr double kStartSigmaMax_m =
      0.25;  // landmarks repeat better, also with the tolerance of experiments III and IV

  struct Scene;
  void match(const Scene& scene, double gate_m, Candidate& candidate) noexcept;
  void fit(const Scene& scene, double sigma_m, Candidate& candidate) const noexcept;
  [[nodiscard]] static double spread_of(const Scene& scene, const Candidate& candidate,
                                        double learned_m) noexcept;
  void weigh_matches(const Scene& scene, const Candidate& candidate, Evidence& evidence) noexcept;
  void weigh_unmatched(const Scene& scene, const Candidate& candidate, Evidence& evidence) const noexcept;
  void weigh_missing(const Scene& scene, const Candidate& candidate, Evidence& evidence) const noexcept;
  static void weigh_sizes(const Scene& scene, const Candidate& candidate, Evidence& evidence) noexcept;
  [[nodiscard]] double group_decades(const Scene& scene, const Candidate& candidate,
                                     double copy_m) const noexcept;

  AssociationConfig association_;
  AcceptanceConfig acceptance_;
  std::array<double, kScanLandmarksMax> nats_{};       // evidence of each match
  std::array<double, kScanLandmarksMax> distance2_{};  // of each match
  double ln_density_ = 0.0;
};

/// Chance to be shown of a landmark with `standing` that stands `range_m` away.
[[nodiscard]] double chance_to_be_shown(const Rates& rates, const Standing& standing,
                                        double range_m) noexcept;

/// log10 of the chance of at least `hits` of `trials` where the chance of each is drawn from a beta
/// distribution of mean `mean` and `weight` pseudo-observations (beta-binomial tail).
[[nodiscard]] double log10_beta_binomial_tail(std::uint32_t trials, std::uint32_t hits, double mean,
                                              double weight) noexcept;

}  // namespace slamsensor::core
