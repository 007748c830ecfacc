#include "core/association/graph_search.hpp"

#include <algorithm>

namespace slamsensor::core {

GraphSearch::GraphSearch(Arena& arena, const AssociationConfig& config, const Capacities& capacities) noexcept
    : config_(config),
      delaunay_(arena, capacities.map_landmarks),
      graph_(arena, "association: map graph", capacities.map_landmarks, capacities.map_edges),
      grid_(arena, "association: map grid", capacities.map_landmarks),
      search_(arena, config, capacities),
      points_(arena, "association: map points", capacities.map_landmarks),
      own_(arena, "association: candidates of a map", 1) {
  SLAMSENSOR_ASSERT(own_.try_resize(1));
}

void GraphSearch::search(std::span<const Point2> scan, MapSlot map, std::span<const std::uint32_t> slots,
                         std::span<const Point2> positions, const Deadline& deadline,
                         Candidates& found) noexcept {
  points_.clear();
  for (const std::uint32_t slot : slots) {
    SLAMSENSOR_ASSERT(points_.try_push_back(positions[slot]));
  }
  if (!graph_.build(points_.span(), delaunay_, config_.depth)) {
    return;  // landmarks out of reach of the lattice
  }
  grid_.build(points_.span(), 2.0 * config_.tolerance_m);
  const MapView view{points_.span(), graph_, grid_};
  Candidates& own = own_[0];
  search_.search(scan, view, 1, deadline, own);
  if (own.end == SearchEnd::Share) {
    search_.search_rest(deadline, own);
  }
  found.end = own.end == SearchEnd::Deadline ? own.end : found.end;
  found.poses_tried += own.poses_tried;
  found.neighbours_dropped += own.neighbours_dropped;
  for (Candidate candidate : own.list) {
    candidate.map = map;
    for (Match& match : candidate.matches) {
      match.map = slots[match.map];
    }
    for (std::uint32_t& corner : candidate.triangle) {
      corner = slots[corner];
    }
    candidate.score = -candidate.log10_chance;
    if (found.list.size() == kCandidatesMax && found.list.back().score < candidate.score) {
      found.list.truncate(kCandidatesMax - 1);
    }
    if (found.list.try_push_back(candidate)) {
      for (std::size_t i = found.list.size() - 1; i > 0 && found.list[i - 1].score < found.list[i].score;
           --i) {
        std::swap(found.list[i - 1], found.list[i]);
      }
    }
  }
}

}  // namespace slamsensor::core
