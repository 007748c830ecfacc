#pragma once

#include "core/association/candidate.hpp"
#include "core/association/map_view.hpp"
#include "core/association/pose_scorer.hpp"
#include "core/association/shortlist.hpp"
#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/graph/delaunay.hpp"
#include "core/graph/landmark_graph.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <cstdint>
#include <span>

namespace slamsensor::core {

/// The paper's search (section II-B, DESIGN 2.3). A vertex of the correspondence graph is a pair (scan
/// landmark, map landmark); two are joined when a scan edge and a map edge between their elements agree in
/// length. Vertices are visited by non-increasing degree; for each, its triangles are triangulated to poses
/// and held against the map. The joins are never stored: the neighbours of a vertex are merged from its
/// elements' sorted edge lists when needed, so memory is 10 bytes per vertex. One thread.
class PaperSearch {
 public:
  PaperSearch(Arena& arena, const AssociationConfig& config, const Capacities& capacities) noexcept;

  /// Searches `map` for poses of `scan_L` (m, L; at most capacities.scan_landmarks). Afterwards `found` holds
  /// the best candidates, at most `variants_max` of them at one place. Vertices up to `order_share` of the
  /// order are visited, or fewer when `deadline` expires; `found.end` says which. Triangles that lie within
  /// the matches of a kept candidate are skipped.
  void search(std::span<const Point2> scan_L, const MapView& map, std::uint32_t variants_max,
              const Deadline& deadline, Candidates& found) noexcept;

  /// Goes on with the last `search`, with the same arguments, to the end of the vertex order or the deadline.
  void search_rest(const Deadline& deadline, Candidates& found) noexcept;

 private:
  using Vertex = std::uint32_t;  // scan landmark * map size + map landmark

  /// A neighbour of the vertex that is being visited.
  struct Neighbour {
    std::uint32_t scan;
    std::uint32_t map;
  };

  void count_degrees() noexcept;
  void sort_by_degree() noexcept;
  void visit_until(std::uint64_t end, Candidates& found) noexcept;
  [[nodiscard]] bool out_of_time(std::uint32_t work) noexcept;
  void gather_neighbours(Vertex vertex, Candidates& found) noexcept;
  void visit(Vertex vertex, Candidates& found) noexcept;
  void try_triangle(const Neighbour& a, const Neighbour& b, const Neighbour& c, Candidates& found) noexcept;
  void try_pose(const Pose2& pose_W, const std::array<std::uint32_t, 3>& triangle,
                Candidates& found) noexcept;
  [[nodiscard]] bool map_edge_fits(std::uint32_t a, std::uint32_t b, double length_m) const noexcept;
  [[nodiscard]] bool searched_before(Vertex a, Vertex b) const noexcept;
  [[nodiscard]] Vertex vertex_of(std::uint32_t scan, std::uint32_t map) const noexcept;

  AssociationConfig config_;
  LandmarkGraph scan_graph_;
  Delaunay scan_delaunay_;
  PoseScorer scorer_;
  BoundedVector<float> scan_edge_m_;     // k x k, length of the scan edge or 0
  BoundedVector<std::uint16_t> degree_;  // per vertex
  BoundedVector<Vertex> order_;          // vertices by non-increasing degree
  Shortlist shortlist_;
  BoundedVector<std::uint32_t> degree_first_;  // counting sort
  FixedVector<Neighbour, kVertexNeighboursMax> neighbours_;
  std::array<std::uint32_t, kScanLandmarksMax + 1>
      group_first_{};  // neighbours of the visited vertex by scan landmark
  std::array<std::uint32_t, kScanLandmarksMax> group_scan_{};
  std::uint32_t group_count_ = 0;
  std::span<const Point2> scan_L_;
  const MapView* map_ = nullptr;
  Deadline deadline_;
  std::uint32_t work_ = 0;  // since the last look at the deadline
  bool expired_ = false;
};

}  // namespace slamsensor::core
