#pragma once

#include "core/association/landmark_index.hpp"
#include "core/config.hpp"
#include "core/decision/evidence.hpp"
#include "core/geometry/pose2.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"
#include "core/memory/fixed_vector.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace slamsensor::core {

/// A landmark of one of the maps. Its place is the weighted mean of its sightings and its prior.
struct GraphLandmark {
  static constexpr std::uint32_t kNoParent = UINT32_MAX;

  std::uint32_t id = 0;                                                   ///< unique in all maps, increasing
  std::uint32_t xi = 0;                                                   ///< positional error (Algorithm 1)
  std::array<std::uint32_t, 3> parents{kNoParent, kNoParent, kNoParent};  ///< ids that triangulated it
  std::uint32_t first_scan = 0;
  std::uint32_t last_scan = 0;
  std::uint32_t sightings = UINT32_MAX;   ///< head of the chain of its sightings in the graph
  std::uint32_t brought_by = UINT32_MAX;  ///< the pose whose scan showed it first
  float prior_x_m = 0.0F;                 ///< mean of the sightings that are not kept any more
  float prior_y_m = 0.0F;
  float prior_weight = 0.0F;
  float file_sigma_m = -1.0F;  ///< MapLandmark::sigma_m of the file that it came from; negative: of no file
  MapSlot map = 0;
  std::uint16_t misses = 0;         ///< scans in a row that should have shown it
  std::uint32_t next = UINT32_MAX;  ///< slot of another landmark of its map
  std::uint32_t previous = UINT32_MAX;
  double sum_x_m = 0.0;  ///< of weight times place, over prior and sightings
  double sum_y_m = 0.0;
  double sum_weight = 0.0;
};

/// A place from which the sensor saw landmarks.
struct GraphPose {
  Pose2 T_W_B;
  std::uint32_t scan = 0;
  std::uint32_t xi = 0;
  std::uint32_t first = 0;    ///< sighting, a place in the ring
  std::uint32_t count = 0;    ///< sightings; 0 when the pose was taken out
  std::uint32_t brought = 0;  ///< landmarks that its scan showed first ...
  std::uint32_t gone = 0;     ///< ... and how many of them later scans contradicted
  std::uint32_t chain = 0;    ///< number of the map that it was brought into, before ties
  MapSlot map = 0;
  std::uint16_t group = 0;      ///< of the last refinement
  std::uint16_t is_anchor = 0;  ///< holds the frame of its map: it is never moved
  std::uint16_t is_weak = 0;    ///< too little else holds it
};

/// One landmark in one scan.
struct GraphSighting {
  float x_m = 0.0F;  ///< in the sensor's frame L, as measured
  float y_m = 0.0F;
  float weight = 1.0F;  ///< of the robust mean
  std::uint32_t landmark = UINT32_MAX;
  std::uint32_t pose = 0;
  std::uint32_t next = UINT32_MAX;  ///< of the same landmark
};

/// Poses and landmarks of all maps, joined by sightings, and their least squares solution (DESIGN 2.6).
///
/// The landmarks are eliminated: each stands at the weighted mean of its sightings, so that the unknowns are
/// the poses. Two kinds of steps lower the sum of squares. A refit moves one pose to its best place against
/// what the other poses say of its landmarks (block Gauss-Seidel on the reduced system, exact, in time of its
/// sightings). `refine` moves all poses of a map: by the exact Gauss-Newton step as long as they are few,
/// then by preconditioned conjugate gradients. Weights are those of a robust kernel whose scale is the
/// tolerance or more: a smaller one would choose between sightings that disagree instead of averaging them.
///
/// Memory is fixed. Poses and sightings are two rings; when one is full the oldest pose is folded: its
/// sightings become part of the priors of their landmarks. One thread; no allocation after construction.
class SightingGraph {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  static constexpr std::size_t kMapsMax = 16;

  SightingGraph(Arena& arena, const Config& config) noexcept;

  /// A new landmark of `map` at `position_W` (m), as yet without sightings; kNone when there is no room.
  [[nodiscard]] std::uint32_t add_landmark(MapSlot map, const Point2& position_W, std::uint32_t scan,
                                           std::uint32_t xi) noexcept;
  /// Gives a landmark without sightings a prior of `weight` sightings at its place.
  void set_prior(std::uint32_t slot, double weight) noexcept;
  void remove_landmark(std::uint32_t slot) noexcept;
  /// The landmark stands no more: nothing is matched with it, and its slot is free for another. Until then
  /// its sightings go on saying how the poses that saw it lie to each other.
  void retire_landmark(std::uint32_t slot) noexcept;

  /// What a scan saw of a landmark.
  struct Seen {
    std::uint32_t landmark;
    Point2 point_L;
  };
  /// How much the sightings of a new pose count.
  enum class Weights : std::uint8_t {
    Robust,  ///< by how near they are to their landmarks
    Full,    ///< wholly, however far: the pose closes a loop
  };
  /// A pose of `map` with its sightings (at most the scan's capacity). The landmarks follow at once. Returns
  /// its place.
  std::uint32_t add_pose(const GraphPose& pose, std::span<const Seen> seen,
                         Weights weights = Weights::Robust) noexcept;
  /// Landmarks that went, and those that a second scan had confirmed and are confirmed no more.
  struct Loss {
    std::uint32_t landmarks = 0;
    std::uint32_t confirmed = 0;
  };
  /// Takes a pose and its sightings out again; landmarks that nothing else supports go, too.
  Loss remove_pose(std::uint32_t pose) noexcept;

  /// Moves the pose to its best place against what the other poses say of its landmarks.
  void refit(std::uint32_t pose) noexcept;
  /// Refits the poses that share a landmark with `pose`, the latest first, at most `count`, then `pose`.
  void refit_around(std::uint32_t pose, std::uint32_t count) noexcept;
  /// Refits about `sightings` sightings' worth of poses in turn, through all of them over time.
  void refit_in_turn(std::uint32_t sightings) noexcept;

  /// Makes all of `from` part of `to`: T_to_from takes coordinates of one to the other. `twins` are pairs (of
  /// from, of to) that are one landmark. Takes time in proportion to the landmarks of `from` and the poses.
  void merge(MapSlot from, MapSlot to, const Pose2& T_to_from, std::span<const Match> twins) noexcept;
  /// `gone` and `kept` are one landmark: its sightings go to `kept`, whose place follows at once.
  void unite(std::uint32_t gone, std::uint32_t kept) noexcept;
  /// Whether `a` and `b` can be one landmark, as far as is still known: no scan that is kept shows both, and
  /// not both come from before what is kept.
  [[nodiscard]] bool may_be_one(std::uint32_t a, std::uint32_t b) noexcept;
  /// How many of the scans that are kept show `least` landmarks or more of both kinds; at least 1.
  [[nodiscard]] std::size_t scans_of_both(std::span<const std::uint32_t> some,
                                          std::span<const std::uint32_t> others,
                                          std::uint32_t least) noexcept;
  /// Sums and places of all landmarks from their priors and sightings.
  void sum_anew() noexcept;
  /// Forgets all of a map.
  void forget(MapSlot map) noexcept;
  void clear() noexcept;

  /// Sets how much farther a landmark's centre is expected to lie than was measured (m), before the sightings
  /// show it. Landmarks follow.
  void expect_offset(double offset_m) noexcept;
  /// The same of an offset that sightings showed before.
  void know_offset(double offset_m) noexcept;
  /// A measured point in the body's frame.
  [[nodiscard]] Point2 body_point(const Point2& point_L) const noexcept;

  void set_robust_scale(double scale_m) noexcept { robust_scale_m_ = scale_m; }

  [[nodiscard]] std::span<const Point2> positions() const noexcept { return positions_.span(); }
  [[nodiscard]] std::span<const Standing> standing() const noexcept { return standing_.span(); }
  [[nodiscard]] Standing& standing(std::uint32_t slot) noexcept { return standing_[slot]; }
  [[nodiscard]] GraphLandmark& landmark(std::uint32_t slot) noexcept { return landmarks_[slot]; }
  [[nodiscard]] const GraphLandmark& landmark(std::uint32_t slot) const noexcept { return landmarks_[slot]; }
  [[nodiscard]] bool is_used(std::uint32_t slot) const noexcept { return used_[slot] == kStands; }
  [[nodiscard]] std::uint32_t slots() const noexcept { return static_cast<std::uint32_t>(landmarks_.size()); }
  [[nodiscard]] std::uint32_t free_landmarks() const noexcept {
    return static_cast<std::uint32_t>(free_.size() + retired_ + (landmarks_.capacity() - landmarks_.size()));
  }
  [[nodiscard]] const LandmarkIndex& index() const noexcept { return index_; }
  [[nodiscard]] GraphPose& pose(std::uint32_t place) noexcept { return poses_[place]; }
  [[nodiscard]] const GraphPose& pose(std::uint32_t place) const noexcept { return poses_[place]; }
  /// The pose whose scan showed the landmark first, or, when that is not kept, one that showed it; kNone when
  /// none is kept.
  [[nodiscard]] std::uint32_t witness_of(std::uint32_t slot) const noexcept {
    const GraphLandmark& l = landmarks_[slot];
    return l.brought_by != kNone || l.sightings == kNone ? l.brought_by : sightings_[l.sightings].pose;
  }
  /// The poses that are kept, from the oldest on: visit(place, pose).
  template <typename Visit>
  void visit_poses(Visit&& visit) const noexcept {
    for (std::uint64_t p = pose_tail_; p < pose_head_; ++p) {
      const auto place = static_cast<std::uint32_t>(p % poses_.capacity());
      if (poses_[place].count > 0) {
        visit(place, poses_[place]);
      }
    }
  }
  /// The landmarks of a map: visit(slot), which may remove that landmark.
  template <typename Visit>
  void visit_landmarks(MapSlot map, Visit&& visit) const noexcept {
    for (std::uint32_t slot = first_of_map_[map]; slot != kNone;) {
      const std::uint32_t next = landmarks_[slot].next;
      visit(slot);
      slot = next;
    }
  }
  [[nodiscard]] std::uint64_t sightings_kept() const noexcept { return sighting_head_ - sighting_tail_; }
  [[nodiscard]] std::uint64_t poses_folded() const noexcept { return folded_; }

  /// One step of the poses of `map` towards the least squares, and of the offset while the map is small.
  /// `sigma_m` is the spread of a sighting per axis. Takes time in proportion to the sightings of the map.
  void refine(MapSlot map, double sigma_m) noexcept;
  /// Variance of (x, y, heading) of a pose relative to the origin of its map, as the last refinement of that
  /// map found it, for sightings of variance 1. Zero before the first.
  [[nodiscard]] Eigen::Matrix3d drift_of(std::uint32_t pose) const noexcept {
    for (const MapDrift& drift : drifts_) {
      if (drift.map == poses_[pose].map) {
        return drift.groups[std::min<std::size_t>(poses_[pose].group, kGroupsMax - 1)];
      }
    }
    return Eigen::Matrix3d::Zero();
  }
  /// Drift is kept of `home` and of one more map: that of the last refinement of another.
  void set_home(MapSlot home) noexcept;
  [[nodiscard]] double offset_m() const noexcept { return offset_m_; }
  [[nodiscard]] double expected_offset_m() const noexcept { return expected_offset_m_; }
  /// Whether the sightings show the offset, expected or not.
  [[nodiscard]] bool is_offset_found() const noexcept { return is_offset_found_; }

 private:
  // What is in a slot.
  static constexpr std::uint8_t kFree = 0;
  static constexpr std::uint8_t kStands = 1;
  static constexpr std::uint8_t kRetired = 2;
  static constexpr double kHolds = 0.1;  // a sighting of less weight says little of where its pose is
  // A pose that fewer hold would turn freely: it stays with its neighbours.
  static constexpr std::uint32_t kHeldMin = 3;
  static constexpr double kTurnMax_rad = 0.3;  // of a step: beyond, the linearisation says nothing
  static constexpr std::uint32_t kGroupsMax = 40;
  static constexpr std::uint32_t kUnknownsMax = 3 * kGroupsMax + 1;  // the offset is the last one

  /// Carries what was measured at a pose to its map. Sines and cosines are taken once for many sightings.
  class Carrier {
   public:
    Carrier(const SightingGraph& graph, const Pose2& T_W_B) noexcept
        : T_B_L_(graph.T_B_L_), T_W_B_(T_W_B), offset_m_(graph.offset_m_) {}

    [[nodiscard]] Point2 body_point(const GraphSighting& s) const noexcept {
      const Point2 point_L(static_cast<double>(s.x_m), static_cast<double>(s.y_m));
      const double range_m = point_L.norm();
      return T_B_L_(range_m > 0.0 ? Point2(point_L * (1.0 + offset_m_ / range_m)) : point_L);
    }
    [[nodiscard]] Point2 operator()(const GraphSighting& s) const noexcept { return T_W_B_(body_point(s)); }

   private:
    RigidMotion T_B_L_;
    RigidMotion T_W_B_;
    double offset_m_;
  };

  /// What one group says of one landmark.
  struct Share {
    std::uint32_t group = 0;
    Eigen::Matrix<double, 2, 3> sum_J = Eigen::Matrix<double, 2, 3>::Zero();  // of weight times derivative
  };
  using Shares = FixedVector<Share, kGroupsMax>;

  /// (x, y, heading) of a pose, in the conjugate gradients.
  struct PoseUnknown {
    Eigen::Vector3d residual = Eigen::Vector3d::Zero();
    Eigen::Vector3d guess = Eigen::Vector3d::Zero();  // preconditioned residual
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    Eigen::Vector3d image = Eigen::Vector3d::Zero();  // of the direction
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  // of its own block of the equations
  };

  /// A landmark in the conjugate gradients, by what strong poses say.
  struct MeanPlace {
    Point2 place = Point2::Zero();
    double weight = 0.0;
    Point2 follows = Point2::Zero();  // of a direction
  };

  struct MapDrift {
    MapSlot map = UINT16_MAX;  // none
    std::array<Eigen::Matrix3d, kGroupsMax> groups{};
  };

  void put_into_map(std::uint32_t slot, MapSlot map) noexcept;
  void take_out_of_map(std::uint32_t slot) noexcept;
  void forget_one_retired() noexcept;
  void chain(std::uint32_t sighting) noexcept;
  void unchain(std::uint32_t sighting) noexcept;
  void add_to_sum(const GraphSighting& sighting, const Point2& at_W, double sign) noexcept;
  void place(std::uint32_t slot) noexcept;
  void move_pose(GraphPose& pose, const Pose2& moved, std::span<const Point2> points_B,
                 std::span<const Point2> rest_W, std::span<const double> weights) noexcept;
  void fold_oldest() noexcept;
  [[nodiscard]] static bool hang_together(const GraphPose& before, const GraphPose& pose) noexcept;
  [[nodiscard]] std::uint32_t make_groups(MapSlot map) noexcept;
  void add_landmark_to_system(std::uint32_t slot, std::uint32_t offset_at) noexcept;
  void hold_frame(MapSlot map, std::uint32_t groups) noexcept;
  [[nodiscard]] bool factorise(std::uint32_t unknowns) noexcept;
  void solve(std::span<double> x) const noexcept;
  [[nodiscard]] double step_each(MapSlot map, std::uint32_t groups, double sigma_m) noexcept;
  void step_by_gradients(MapSlot map, std::uint32_t groups) noexcept;
  template <typename Visit>
  void visit_strong(MapSlot map, Visit&& visit) noexcept;
  void sum_strong(MapSlot map) noexcept;
  void find_weak(MapSlot map) noexcept;
  void linearise(MapSlot map) noexcept;
  [[nodiscard]] double apply_system(MapSlot map) noexcept;
  [[nodiscard]] double precondition(MapSlot map, std::uint32_t groups) noexcept;
  void carry_weak(MapSlot map) noexcept;
  void move_poses(MapSlot map, double sign) noexcept;
  [[nodiscard]] double squares(MapSlot map) const noexcept;
  void find_drift(MapSlot map, std::uint32_t groups) noexcept;
  [[nodiscard]] double offset_worth_m(double sigma_m) const noexcept;
  [[nodiscard]] double& system(std::uint32_t row, std::uint32_t column) noexcept {
    return system_[std::size_t{row} * kUnknownsMax + column];
  }
  [[nodiscard]] double system(std::uint32_t row, std::uint32_t column) const noexcept {
    return system_[std::size_t{row} * kUnknownsMax + column];
  }

  MountConfig mount_;
  Pose2 T_B_L_;
  double robust_scale_m_;
  double offset_m_ = 0.0;
  double expected_offset_m_ = 0.0;
  bool is_offset_found_ = false;
  LandmarkIndex index_;
  BoundedVector<GraphLandmark> landmarks_;
  BoundedVector<Point2> positions_;
  BoundedVector<Standing> standing_;
  BoundedVector<std::uint8_t> used_;
  BoundedVector<std::uint32_t> free_;
  std::uint32_t retired_ = 0;
  std::uint32_t retired_turn_ = 0;
  std::array<std::uint32_t, kMapsMax> first_of_map_{};  // landmarks
  BoundedVector<GraphPose> poses_;
  BoundedVector<GraphSighting> sightings_;
  BoundedVector<std::uint32_t> marks_;   // per pose, of may_be_one
  BoundedVector<PoseUnknown> unknowns_;  // per pose
  BoundedVector<MeanPlace> means_;       // per landmark
  std::uint32_t mark_ = 0;
  std::uint64_t pose_head_ = 0;  // of the next pose; places are modulo the capacity
  std::uint64_t pose_tail_ = 0;
  std::uint64_t sighting_head_ = 0;
  std::uint64_t sighting_tail_ = 0;
  std::uint64_t turn_ = 0;  // of refit_in_turn
  std::uint64_t folded_ = 0;
  BoundedVector<double> system_;  // of the groups: normal equations, then their Cholesky factor
  std::array<double, kUnknownsMax> step_{};
  std::array<Point2, kGroupsMax> middles_{};  // of the groups
  std::array<double, kGroupsMax> members_{};
  std::array<MapDrift, 2> drifts_{};  // of the home map, of another
  double range_sum_m_ = 0.0;          // of the sightings of the last refinement
  double range_count_ = 0.0;
  double path_m_ = 0.0;  // within the groups of it
  std::uint32_t next_id_ = 0;

 public:
  [[nodiscard]] std::uint32_t next_id() const noexcept { return next_id_; }
  void set_next_id(std::uint32_t id) noexcept { next_id_ = id; }
};

}  // namespace slamsensor::core
