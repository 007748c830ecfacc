#pragma once

#include "core/association/fast_search.hpp"
#include "core/association/paper_search.hpp"
#include "core/association/point_grid.hpp"
#include "core/graph/delaunay.hpp"
#include "core/graph/landmark_graph.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// The paper's search on maps that change: it builds the graph of each map anew for each scan, which takes
/// time in proportion to the map. The literal method beside the fast one, and its oracle. One thread; no
/// allocation after construction.
class GraphSearch {
 public:
  GraphSearch(Arena& arena, const AssociationConfig& config, const Capacities& capacities) noexcept;

  /// As FastSearch::search, in one map: the landmarks in `slots` with their `positions` by slot. Candidates
  /// are added to those in `found`.
  void search(std::span<const Point2> scan, MapSlot map, std::span<const std::uint32_t> slots,
              std::span<const Point2> positions, const Deadline& deadline, Candidates& found) noexcept;

 private:
  AssociationConfig config_;
  Delaunay delaunay_;
  LandmarkGraph graph_;
  PointGrid grid_;
  PaperSearch search_;
  BoundedVector<Point2> points_;
  BoundedVector<Candidates> own_;  // one
};

}  // namespace slamsensor::core
