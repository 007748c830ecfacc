#pragma once

#include "core/association/candidate.hpp"
#include "core/association/landmark_index.hpp"
#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace slamsensor::core {

/// The map that no landmark is in.
inline constexpr MapSlot kNoMap = std::numeric_limits<MapSlot>::max();

/// What a search takes for granted of matches, to rank what it finds.
struct MatchModel {
  double sigma_m = 0.17;         ///< spread of a matched landmark about its place in the map, per axis
  double density_per_m2 = 0.01;  ///< of the scan's landmarks
  double detection = 0.7;        ///< share of the map's landmarks that a scan shows
};

/// The fast search: the poses from which a scan explains a part of any map, whatever the size of the maps. It
/// does what the paper's search does (triangular subgraphs of the correspondence graph, II-B), but asks an
/// index for the map triangles that are congruent to a triangle of the scan instead of visiting all vertices.
/// A triangle gives a pose; the scan's next landmarks confirm or refute it by a few look-ups; what is
/// confirmed is refined by least squares over all matches and ranked by its likelihood against chance.
/// Triangles are tried in turn about each landmark of the scan, the nearest neighbours first, so that a few
/// tries cover the scan. One thread; no allocation after construction.
class FastSearch {
 public:
  FastSearch(Arena& arena, const AssociationConfig& config, const Capacities& capacities) noexcept;

  /// Searches all maps but `except` for poses of `scan` (m, any frame B; at most capacities.scan_landmarks).
  /// `positions` are the places of the landmarks by slot, each in the frame of its map, and those that
  /// `index` lists. Afterwards `found` holds the best candidates by rank, at most one at one place, and how
  /// the search ended: Complete when all triangles were tried, Share when a clear leader was found and enough
  /// were tried that a rival would have shown, or when the effort was spent, Deadline.
  void search(std::span<const Point2> scan, const LandmarkIndex& index, std::span<const Point2> positions,
              MapSlot except, const MatchModel& model, const Deadline& deadline, Candidates& found) noexcept;

 private:
  static constexpr std::uint32_t kNeighbours =
      10;  // of a scan landmark: its triangles, and what confirms them

  struct Neighbour {
    std::uint32_t index;
    float distance_m;
  };
  using Neighbourhood = FixedVector<Neighbour, kNeighbours>;
  struct Triangle {
    std::array<std::uint32_t, 3> scan;
    std::array<std::uint32_t, 3> map;
  };
  /// Where poses were tried.
  struct Tried {
    std::uint32_t key = 0;
    std::uint32_t round = 0;
    std::uint32_t failures = 0;
  };

  void find_neighbourhoods() noexcept;
  [[nodiscard]] bool try_pair(std::uint32_t apex, std::uint32_t i, std::uint32_t j,
                              Candidates& found) noexcept;
  void query(std::uint32_t apex, std::uint32_t second, std::uint32_t third, LandmarkIndex::Turn turn,
             Candidates& found) noexcept;
  void try_triangle(const Triangle& triangle, Candidates& found) noexcept;
  [[nodiscard]] bool is_confirmed(const RigidMotion& move, MapSlot map,
                                  const Triangle& triangle) const noexcept;
  void refine(const Pose2& pose, MapSlot map, const Triangle& triangle, Candidates& found) noexcept;
  [[nodiscard]] double match(const Pose2& pose, MapSlot map, double gate_m, MatchList& matches) noexcept;
  void offer(const Candidate& candidate, Candidates& found) const noexcept;
  [[nodiscard]] Tried& tried_at(const RigidMotion& move, MapSlot map) noexcept;
  [[nodiscard]] bool is_over(Candidates& found) noexcept;

  AssociationConfig config_;
  std::array<Neighbourhood, kScanLandmarksMax> neighbourhoods_{};
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
  std::uint64_t work_ = 0;       // in about nanoseconds
  std::uint64_t looked_at_ = 0;  // work at the last look at the deadline
};

}  // namespace slamsensor::core
