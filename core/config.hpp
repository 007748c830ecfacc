#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

namespace slamsensor::core {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// Which point stands for a landmark's group of cells.
enum class LandmarkPoint : std::uint8_t {
  HullCentroid,  ///< centroid of the convex hull of the cells (the paper)
  ReadingMean,   ///< mean of the nearest readings of the cells: not quantised by the grid
};

/// Landmark detection (DESIGN 2.2; the paper's section II-A). Defaults are the paper's experiment I.
struct DetectionConfig {
  double range_min_m = 0.0;    ///< nearer returns are the carrier: their column counts as not looked at
  double range_max_m = 300.0;  ///< d_max; a return beyond it counts as no return
  double range_step_m = 0.5;   ///< delta_d, height of a spiderweb cell
  double bearing_step_rad = 0.514 * kDegree;  ///< delta_theta, width of a spiderweb cell
  double tilt_min_rad = -90.0 * kDegree;      ///< scanlines below are left out
  double tilt_max_rad = 90.0 * kDegree;       ///< scanlines above are left out
  double discard_share = 0.02;      ///< readings dropped at each end of a scanline; 0 for a full turn
  std::uint32_t landmarks_max = 0;  ///< m_k, the heaviest that are kept; 0: kDetected or kListed
  LandmarkPoint point = LandmarkPoint::ReadingMean;

  static constexpr std::uint32_t kDetected = 30;
  static constexpr std::uint32_t kListed = 60;
  /// How many of the readings' landmarks are kept at most. Lighter ones repeat badly in streets.
  [[nodiscard]] std::uint32_t detected_most() const noexcept {
    return landmarks_max > 0 ? landmarks_max : kDetected;
  }
  /// How many of a list are. Who made the list has chosen them, and where landmarks stand close together, few
  /// of them are few witnesses.
  [[nodiscard]] std::uint32_t listed_most() const noexcept {
    return landmarks_max > 0 ? landmarks_max : kListed;
  }
};

/// How a pose is fitted to its matches.
enum class PoseFit : std::uint8_t {
  LeastSquares,  ///< every match counts alike (the paper)
  Robust,        ///< matches far beyond a third of the tolerance hardly count
};

/// What leads among the poses that a search finds.
enum class CandidateRank : std::uint8_t {
  Significance,  ///< the one that chance explains least: matches, and how near they are
  Matches,       ///< the one with the most matches (the paper)
};

/// How poses are searched for.
enum class SearchMethod : std::uint8_t {
  Fast,   ///< by an index of the maps' triangles (fast_search.hpp)
  Paper,  ///< by the correspondence graph (paper_search.hpp)
};

/// Data association (DESIGN 2.3; the paper's section II-B).
struct AssociationConfig {
  SearchMethod search = SearchMethod::Fast;
  std::uint32_t index_neighbours =
      6;  ///< of the fast search: neighbours that a landmark forms triangles with
  std::uint64_t effort_max = 100'000'000;  ///< of the fast search: about nanoseconds after which it gives up
  double tolerance_m = 0.5;                ///< epsilon: edge lengths and landmark positions agree within it
  std::uint32_t depth = 2;                 ///< edges join landmarks up to this many mesh steps apart
  double order_share = 0.125;              ///< share of the vertex order that is searched for triangles
  PoseFit fit = PoseFit::Robust;
  CandidateRank rank = CandidateRank::Significance;
  bool exhaust_when_unsure = true;  ///< go on to the end of the order when the share gave no clear answer
  std::uint32_t landmarks_min = 3;  ///< a scan with fewer landmarks is not searched
};

/// When an associated pose is believed.
enum class AcceptanceRule : std::uint8_t {
  Evidence,  ///< by the evidence for and against it (core/decision)
  Paper,     ///< the largest W wins; overlap is assumed
};

struct AcceptanceConfig {
  AcceptanceRule rule = AcceptanceRule::Evidence;
  double risk = 1e-6;  ///< expected wrong fixes per scan that are taken
  double copy_size_m =
      0.0;  ///< the largest thing that comes in copies; 0 = 15 m, in a survey from the density
  double elsewhere_m =
      1.0;  ///< a pose farther than this from the answer is elsewhere: one of the two is wrong
  double elsewhere_rad = 2.0 * kDegree;  ///< a pose turned by more than this is elsewhere, too
};

/// How a matched landmark's place in the map follows what was seen.
enum class LandmarkUpdate : std::uint8_t {
  Paper,  ///< Algorithm 1: moved to its newly seen place when that has no larger error xi
  Mean,   ///< mean of its sightings, in the frame of the map
};

/// Hypotheses and positional error (DESIGN 2.5, 2.6; the paper's sections II-C and II-D).
struct MappingConfig {
  std::uint32_t hypotheses_max = 3;  ///< Lambda_max
  LandmarkUpdate update = LandmarkUpdate::Paper;
  bool propagate_corrections = false;  ///< the recursive option of Algorithm 1
  double prune_share = 0.0;  ///< landmarks seen in a smaller share of their chances are forgotten; 0 = never
  std::uint32_t prune_chances_min = 5;  ///< but not before this many chances
};

/// What memory is taken for at construction (DESIGN 2.7).
struct Capacities {
  std::uint32_t occupied_cells = 65'536;  ///< spiderweb cells of a scan: 51 scanlines of 701 columns fit
  std::uint32_t scan_landmarks = 128;     ///< landmarks of a scan that association can take
  std::uint32_t map_landmarks = 10'000;   ///< landmarks of a hypothesis' map
  std::uint32_t map_edges = 120'000;      ///< edges of a map's graph (about 10 per landmark at depth 2)
  std::uint32_t path_poses = 10'000;      ///< poses of a hypothesis' path
  std::uint32_t sightings = 100'000;      ///< landmarks in scans that the refinement keeps
};

/// Where the sensor sits on what carries it: T_B_L, sensor frame L to body frame B. Fixes and maps are the
/// body's; the default makes the two the same.
struct MountConfig {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;
};

/// All settings of core. Validated by the loader (firmware/config); core takes it as it is.
struct Config {
  MountConfig mount;
  DetectionConfig detection;
  AssociationConfig association;
  AcceptanceConfig acceptance;
  MappingConfig mapping;
  Capacities capacities;
};

}  // namespace slamsensor::core
