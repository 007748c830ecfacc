#pragma once

#include "core/association/candidate.hpp"
#include "core/config.hpp"
#include "core/graph/delaunay.hpp"
#include "core/mapping/hypothesis.hpp"
#include "core/mapping/map_state.hpp"
#include "core/mapping/positional_error.hpp"
#include "core/mapping/pruning.hpp"
#include "core/memory/arena.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// Brings localised scans into hypotheses: moves what was matched, adds what is new, forgets what was not
/// confirmed, and keeps the index that the next association searches.
class MapBuilder {
 public:
  MapBuilder(Arena& arena, const Config& config) noexcept;

  /// Makes `hypothesis` the map of its first scan, whose pose is the origin of the map frame.
  void start(std::span<const Point2> scan_L, std::uint32_t scan, Hypothesis& hypothesis) noexcept;

  /// Brings the scan into the hypothesis as `candidate` places it. A full map makes room by losing its least
  /// useful landmarks (fewest sightings for their chances, then longest unseen), a full path every other pose
  /// but the first; both are counted in the hypothesis.
  void extend(std::span<const Point2> scan_L, const Candidate& candidate, std::uint32_t scan,
              Hypothesis& hypothesis) noexcept;

  /// Makes `hypothesis` equal to the one that `state` was taken of; check_map must have found no flaw in it.
  void restore(const MapState& state, Hypothesis& hypothesis) noexcept;

 private:
  void add_unmatched(const ScanInMap& scan, std::uint32_t scan_xi,
                     const std::array<std::uint32_t, 3>& parents, Hypothesis& hypothesis) noexcept;
  void make_room(std::uint32_t wanted, std::uint32_t scan, Hypothesis& hypothesis) noexcept;

  Config config_;
  PositionalError positional_error_;
  Pruning pruning_;
  Delaunay delaunay_;
  BoundedVector<bool> drop_;
  BoundedVector<double> usefulness_;
};

}  // namespace slamsensor::core
