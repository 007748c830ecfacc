#pragma once

#include "core/association/point_grid.hpp"
#include "core/geometry/pose2.hpp"
#include "core/graph/landmark_graph.hpp"

#include <span>

namespace slamsensor::core {

/// A map as association needs it; the graph and the grid are those of the positions.
struct MapView {
  std::span<const Point2> positions_W;
  const LandmarkGraph& graph;
  const PointGrid& grid;
};

}  // namespace slamsensor::core
