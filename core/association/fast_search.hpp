#pragma once

#include "core/association/candidate.hpp"
#include "core/association/landmark_index.hpp"
#include "core/association/scan_mask.hpp"
#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace slamsensor::core {

/// The map that no landmark is in.
inline constexpr MapSlot kNoMap = std::numeric_limits<MapSlot>::max();

/// What a search takes for granted of matches, to rank what it finds.
struct MatchModel {
  double sigma_m = 0.17;         ///< spread of a matched landmark about its place in the map, per axis
  double density_per_m2 = 0.01;  ///< of the scan's landmarks
  double detection = 0.7;        ///< share of the map's landmarks that a scan shows
  bool is_thorough =
      false;  ///< a leader does not end the search: where the world repeats itself, rivals count as much
};

/// The fast search: the poses from which a scan explains a part of any map, whatever the size of the maps. It
/// does what the paper's search does (triangular subgraphs of the correspondence graph, II-B), but asks an
/// index for the map triangles that are congruent to a triangle of the scan instead of visiting all vertices.
/// A triangle gives a pose. The other neighbours of its apex in the map refute nearly all wrong ones: where
/// they should be, the scan has nothing. What is left is counted over the whole scan, refined by least
/// squares over all matches, and ranked by its likelihood against chance. Triangles are tried in turn about
/// each landmark of the scan, the nearest neighbours first, so that a few tries cover the scan. One thread;
/// no allocation after construction.
class FastSearch {
 public:
  FastSearch(Arena& arena, const AssociationConfig& config, const Capacities& capacities) noexcept;

  /// Searches all maps but `except` for poses of `scan` (m, any frame B; at most capacities.scan_landmarks).
  /// `positions` are the places of the landmarks by slot, each in the frame of its map, and those that
  /// `index` lists. Afterwards `found` holds the best candidates by rank, at most one at one place, and how
  /// the search ended: Complete when all triangles were tried, Share when a clear leader was found and enough
  /// were tried that a rival would have shown, or when the effort was spent, Deadline. Candidates that chance
  /// alone explains are left out, but for the best one.
  void search(std::span<const Point2> scan, const LandmarkIndex& index, std::span<const Point2> positions,
              MapSlot except, const MatchModel& model, const Deadline& deadline, Candidates& found) noexcept;

 private:
  static constexpr std::uint32_t kNeighbours = 10;  // of a scan landmark: its triangles

  struct Neighbour {
    std::uint32_t index;
    float distance_m;
  };
  using Neighbourhood = FixedVector<Neighbour, kNeighbours>;
  /// A triangle of the scan that is looked for. The corners are relative to the apex.
  struct Wanted {
    std::array<std::uint32_t, 3> scan;  // apex, second, third
    float apex_x_m;
    float apex_y_m;
    float second_x_m;
    float second_y_m;
    float third_x_m;
    float third_y_m;
    std::array<float, 3> low2_m2;  // bounds of the squares of the middle, shortest and longest side
    std::array<float, 3> high2_m2;
  };
  /// A landmark of the scan and two of its neighbours, and what it costs to look for them.
  struct Plan {
    float cost;
    std::uint8_t apex;
    std::uint8_t i;
    std::uint8_t j;
  };
  static constexpr std::uint32_t kPlansMax = 200;
  /// What a triangle says of the pose: the turn from the scan to the map, and where the middle of the
  /// triangle lies in both, relative to the apex.
  struct Turned {
    float cosine;
    float sine;
    float middle_scan_x_m;
    float middle_scan_y_m;
    float middle_map_x_m;
    float middle_map_y_m;
  };
  /// Where poses were tried.
  struct Tried {
    std::uint32_t key = 0;
    std::uint32_t round = 0;
    std::uint32_t failures = 0;
  };

  void plan_all() noexcept;
  [[nodiscard]] bool try_plans(Candidates& found) noexcept;
  [[nodiscard]] bool try_all(Candidates& found) noexcept;
  [[nodiscard]] bool has_lead(const Candidates& found) const noexcept;
  [[nodiscard]] bool is_contested(const Candidates& found) const noexcept;
  void find_neighbourhood(std::uint32_t apex) noexcept;
  [[nodiscard]] std::optional<Plan> plan(std::uint32_t apex, std::uint32_t i, std::uint32_t j) const noexcept;
  [[nodiscard]] bool try_pair(std::uint32_t apex, std::uint32_t i, std::uint32_t j,
                              Candidates& found) noexcept;
  void query(std::uint32_t apex, std::uint32_t second, std::uint32_t third, LandmarkIndex::Turn turn,
             Candidates& found) noexcept;
  [[nodiscard]] bool is_witnessed(const Wanted& wanted, std::span<const LandmarkIndex::Offset> star,
                                  LandmarkIndex::Pair pair, Turned& turned) const noexcept;
  void try_pose(const Wanted& wanted, const Turned& turned, std::uint32_t apex, Candidates& found) noexcept;
  [[nodiscard]] bool is_confirmed(const RigidMotion& move, MapSlot map, const Wanted& wanted) noexcept;
  [[nodiscard]] std::uint32_t count(const RigidMotion& move, MapSlot map, std::uint32_t enough) noexcept;
  void refine(const Pose2& pose, MapSlot map, const Wanted& wanted, Candidates& found) noexcept;
  [[nodiscard]] double match(const Pose2& pose, MapSlot map, double gate_m, MatchList& matches) noexcept;
  void offer(const Candidate& candidate, Candidates& found) noexcept;
  [[nodiscard]] Tried& tried_at(const RigidMotion& move, MapSlot map) noexcept;
  [[nodiscard]] bool is_over(Candidates& found) noexcept;
  [[nodiscard]] bool is_late(Candidates& found) noexcept;
  [[nodiscard]] double score(std::size_t matches, double residual_m2) const noexcept;

  AssociationConfig config_;
  std::array<Neighbourhood, kScanLandmarksMax> neighbourhoods_{};
  std::array<bool, kScanLandmarksMax> has_neighbourhood_{};
  ScanMask mask_;
  FixedVector<Plan, kPlansMax> plans_;
  BoundedVector<Tried> tried_;
  std::array<std::uint32_t, 512>
      claimed_slot_{};  // one-to-one matching: which landmark of the scan claims a slot
  std::array<std::uint32_t, 512> claimed_round_{};
  std::array<std::uint32_t, 512> claimed_match_{};
  std::uint32_t claim_round_ = 0;
  std::uint32_t round_ = 0;  // of searches, for tried_
  std::span<const Point2> scan_;
  std::span<const Point2> positions_;
  const LandmarkIndex* index_ = nullptr;
  MapSlot except_ = kNoMap;
  MatchModel model_;
  Deadline deadline_;
  Point2 middle_ = Point2::Zero();  // of the scan
  ScanMoments moments_{{}};
  double window_m_ = 0.0;   // by which sides may differ
  double per_match_ = 0.0;  // nats that a match says at a distance of nought
  double chance_ = 0.0;     // nats that chance reaches somewhere in maps of this size
  double worth_ = 0.0;      // nats below which a pose is not worth refining: too many better ones are known
  std::uint32_t witnesses_ =
      0;                    // that a triangle has to have beside its corners; 0: the map is asked instead
  std::uint64_t work_ = 0;  // in about nanoseconds
  std::uint64_t looked_at_ = 0;  // work at the last look at the deadline
};

}  // namespace slamsensor::core
