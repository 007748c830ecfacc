#pragma once

#include "core/config.hpp"
#include "core/decision/rates.hpp"
#include "core/mapping/hypothesis.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::core {

/// Events of the fixed memory and of the search, counted since construction.
struct Counters {
  std::uint64_t landmarks_cut = 0;       ///< scan landmarks beyond capacities.scan_landmarks, lightest first
  std::uint64_t landmarks_refused = 0;   ///< scan landmarks that were not finite or out of reach
  std::uint64_t neighbours_dropped = 0;  ///< correspondence neighbours beyond kVertexNeighboursMax
  std::uint64_t searches_cut = 0;        ///< by the deadline
};

/// Whether scans may change the map.
enum class Frozen : std::uint8_t {
  No,
  Yes,  ///< localise only, in the best hypothesis: nothing that it remembers changes
};

/// All of a hypothesis that cannot be computed again: what a map file keeps and what a restart needs. The
/// arrays belong to someone else; `landmarks[i]` stands at `positions_W[i]` (m).
struct MapState {
  std::span<const MapLandmark> landmarks;  ///< by increasing id
  std::span<const Point2> positions_W;
  std::span<const PathPose> path;       ///< by increasing scan
  std::uint64_t weight = 0;             ///< W
  std::uint64_t landmarks_evicted = 0;  ///< as in Hypothesis
  std::uint64_t path_thinnings = 0;     ///< as in Hypothesis
  std::uint32_t next_id = 0;            ///< of the next new landmark
  std::uint32_t scans = 0;              ///< processed so far; the number of the next one
  bool is_surveyed = false;             ///< somebody else measured all landmarks: the map is complete
  std::optional<Rates> rates{};         ///< what was learned with it; a survey and old files have none
};

/// Where a map is copied to.
struct MapRoom {
  std::span<MapLandmark> landmarks;
  std::span<Point2> positions_W;
  std::span<PathPose> path;
};

/// What keeps a MapState from being a hypothesis.
enum class MapFlaw : std::uint8_t {
  None,
  TooFewLandmarks,   ///< fewer than the three that a pose takes
  TooManyLandmarks,  ///< more than capacities.map_landmarks
  TooManyPoses,      ///< more than capacities.path_poses
  PositionCount,     ///< not one position per landmark
  IdOrder,           ///< an id is not larger than the one before
  NextId,            ///< an id is not below next_id
  Position,          ///< a position is not a number or out of reach (kLatticeReach_m)
  Parents,           ///< parents at xi 0, none above it, twice the same, or one that never was
  ParentXi,          ///< a parent does not stand nearer to the origin than its child
  Sightings,         ///< a landmark without a sighting or a chance
  Sigma,             ///< a landmark's sigma is negative or no number
  Size,              ///< no sightings can have measured a landmark's size
  LandmarkScans,     ///< last seen before it was first seen, or in a scan that is still to come
  PathOrder,         ///< a pose's scan is not later than the one before, or is still to come
  PathPose,          ///< a pose is not a number
  Rates,             ///< scans cannot have taught what was learned (Rates::is_possible)
};

/// A flaw and where it is: the index of the landmark or of the pose, or the count that is wrong.
struct MapCheck {
  MapFlaw flaw = MapFlaw::None;
  std::size_t index = 0;

  [[nodiscard]] bool ok() const noexcept { return flaw == MapFlaw::None; }
};

/// The first flaw of `state`, held against `capacities`. Every state that HypothesisSet gives out has none
/// (unless it holds fewer than three landmarks). Takes n log n steps and no memory.
[[nodiscard]] MapCheck check_map(const MapState& state, const Capacities& capacities) noexcept;

/// `hypothesis` as it stands, valid until it changes.
[[nodiscard]] MapState state_of(const Hypothesis& hypothesis, std::uint32_t scans) noexcept;

}  // namespace slamsensor::core
