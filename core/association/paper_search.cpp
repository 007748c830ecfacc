#include "core/association/paper_search.hpp"

#include "core/association/significance.hpp"
#include "core/association/triangulation.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
namespace {

constexpr std::uint32_t kDegreeMax = 8191;  // larger degrees sort as this one
// Work between two looks at the deadline, in map edges compared; a pose held against the map counts as many.
// About 0.1 ms.
constexpr std::uint32_t kWorkPerDeadlineLook = 4096;
constexpr std::uint32_t kWorkPerPose = 256;
constexpr std::uint32_t kWorkPerVertex = 64;
constexpr std::uint32_t kInliersMin = 4;  // three match by construction: only a fourth says anything
constexpr std::uint32_t kScanEdgesMax = kScanLandmarksMax * (kScanLandmarksMax - 1) / 2;

/// Twice the signed area of a triangle; its sign tells a triangle from its mirror image.
double twice_area(const Point2& a, const Point2& b, const Point2& c) noexcept {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Whether moving each corner by `tolerance_m` can turn the triangle over.
bool nearly_collinear(double twice_area_m2, double longest_m, double tolerance_m) noexcept {
  return std::abs(twice_area_m2) < 2.0 * tolerance_m * longest_m;
}

std::size_t vertices_max(const Capacities& capacities) noexcept {
  return static_cast<std::size_t>(capacities.scan_landmarks) * capacities.map_landmarks;
}

}  // namespace

PaperSearch::PaperSearch(Arena& arena, const AssociationConfig& config, const Capacities& capacities) noexcept
    : config_(config),
      scan_graph_(arena, "association: scan graph", capacities.scan_landmarks,
                  std::min(kScanEdgesMax, capacities.scan_landmarks * capacities.scan_landmarks / 2)),
      scan_delaunay_(arena, capacities.scan_landmarks),
      scorer_(arena, config, capacities.map_landmarks),
      scan_edge_m_(arena, "association: scan edges",
                   static_cast<std::size_t>(capacities.scan_landmarks) * capacities.scan_landmarks),
      degree_(arena, "association: vertex degrees", vertices_max(capacities)),
      order_(arena, "association: vertex order", vertices_max(capacities)),
      shortlist_(arena, config, vertices_max(capacities)),
      degree_first_(arena, "association: degree counts", kDegreeMax + 2) {
}

PaperSearch::Vertex PaperSearch::vertex_of(std::uint32_t scan, std::uint32_t map) const noexcept {
  return scan * static_cast<std::uint32_t>(map_->positions_W.size()) + map;
}

bool PaperSearch::searched_before(Vertex a, Vertex b) const noexcept {
  return degree_[a] != degree_[b] ? degree_[a] > degree_[b] : a < b;
}

void PaperSearch::search(std::span<const Point2> scan_L, const MapView& map, std::uint32_t variants_max,
                         const Deadline& deadline, Candidates& found) noexcept {
  scan_L_ = scan_L;
  map_ = &map;
  found.poses_tried = found.vertices_searched = found.vertices_total = found.neighbours_dropped = 0;
  found.end = SearchEnd::Complete;

  const std::size_t k = scan_L.size();
  const std::size_t vertices = k * map.positions_W.size();
  const bool fits = shortlist_.start(vertices, static_cast<std::uint32_t>(map.positions_W.size()),
                                     variants_max, ScanMoments(scan_L), found);
  if (!fits || !scan_edge_m_.try_resize(k * k) || !scan_graph_.build(scan_L, scan_delaunay_, config_.depth) ||
      map.graph.vertex_count() != map.positions_W.size() || !degree_.try_resize(vertices) ||
      !order_.try_resize(vertices)) {
    return;  // no graph, no triangles: the search is complete with nothing found
  }
  std::fill(scan_edge_m_.begin(), scan_edge_m_.end(), 0.0F);
  for (std::uint32_t i = 0; i < k; ++i) {
    for (const LandmarkGraph::Neighbour& n : scan_graph_.neighbours(i)) {
      scan_edge_m_[i * k + n.vertex] = n.length_m;
    }
  }
  found.vertices_total = vertices;
  count_degrees();
  sort_by_degree();
  const auto share =
      static_cast<std::uint64_t>(std::ceil(config_.order_share * static_cast<double>(vertices)));
  deadline_ = deadline;
  visit_until(std::min<std::uint64_t>(share, vertices), found);
}

void PaperSearch::search_rest(const Deadline& deadline, Candidates& found) noexcept {
  deadline_ = deadline;
  visit_until(found.vertices_total, found);
}

bool PaperSearch::out_of_time(std::uint32_t work) noexcept {
  work_ += work;
  if (work_ >= kWorkPerDeadlineLook) {
    work_ = 0;
    expired_ = expired_ || deadline_.expired();
  }
  return expired_;
}

void PaperSearch::visit_until(std::uint64_t end, Candidates& found) noexcept {
  work_ = 0;
  expired_ = deadline_.expired();
  for (std::uint64_t i = found.vertices_searched; i < end; ++i) {
    const Vertex vertex = order_[i];
    if (degree_[vertex] < 2) {  // no triangle here, nor at any later vertex
      found.vertices_searched = found.vertices_total;
      break;
    }
    visit(vertex, found);
    if (out_of_time(kWorkPerVertex)) {
      found.end = SearchEnd::Deadline;
      return;
    }
    found.vertices_searched = i + 1;
  }
  found.end = found.vertices_searched == found.vertices_total ? SearchEnd::Complete : SearchEnd::Share;
}

/// Degree of (i, a): pairs of an edge at i and an edge at a that agree in length; both lists are sorted, so
/// the window of agreeing map edges only moves forward.
void PaperSearch::count_degrees() noexcept {
  const auto n = static_cast<std::uint32_t>(map_->positions_W.size());
  const auto tolerance = static_cast<float>(config_.tolerance_m);
  for (std::uint32_t i = 0; i < scan_L_.size(); ++i) {
    const auto scan_edges = scan_graph_.neighbours(i);
    for (std::uint32_t a = 0; a < n; ++a) {
      const auto map_edges = map_->graph.neighbours(a);
      std::size_t low = 0;
      std::size_t high = 0;
      std::size_t degree = 0;
      for (const LandmarkGraph::Neighbour& edge : scan_edges) {
        while (low < map_edges.size() && map_edges[low].length_m < edge.length_m - tolerance) {
          ++low;
        }
        while (high < map_edges.size() && map_edges[high].length_m <= edge.length_m + tolerance) {
          ++high;
        }
        degree += high - low;
      }
      degree_[i * n + a] = static_cast<std::uint16_t>(std::min<std::size_t>(degree, kDegreeMax));
    }
  }
}

void PaperSearch::sort_by_degree() noexcept {
  SLAMSENSOR_ASSERT(degree_first_.try_resize(kDegreeMax + 2));
  std::fill(degree_first_.begin(), degree_first_.end(), 0U);
  for (const std::uint16_t degree : degree_) {
    ++degree_first_[kDegreeMax - degree + 1U];
  }
  for (std::size_t d = 1; d < degree_first_.size(); ++d) {
    degree_first_[d] += degree_first_[d - 1];
  }
  for (Vertex v = 0; v < degree_.size(); ++v) {
    order_[degree_first_[kDegreeMax - degree_[v]]++] = v;
  }
}

void PaperSearch::gather_neighbours(Vertex vertex, Candidates& found) noexcept {
  const auto n = static_cast<std::uint32_t>(map_->positions_W.size());
  const auto tolerance = static_cast<float>(config_.tolerance_m);
  const auto map_edges = map_->graph.neighbours(vertex % n);
  neighbours_.clear();
  group_count_ = 0;
  std::size_t low = 0;
  for (const LandmarkGraph::Neighbour& edge : scan_graph_.neighbours(vertex / n)) {
    while (low < map_edges.size() && map_edges[low].length_m < edge.length_m - tolerance) {
      ++low;
    }
    group_first_[group_count_] = static_cast<std::uint32_t>(neighbours_.size());
    group_scan_[group_count_] = edge.vertex;
    for (std::size_t e = low; e < map_edges.size() && map_edges[e].length_m <= edge.length_m + tolerance;
         ++e) {
      if (searched_before(vertex_of(edge.vertex, map_edges[e].vertex), vertex)) {
        continue;  // its triangles with this vertex have been searched
      }
      if (!neighbours_.try_push_back({edge.vertex, map_edges[e].vertex})) {
        ++found.neighbours_dropped;
      }
    }
    if (neighbours_.size() > group_first_[group_count_]) {
      ++group_count_;
    }
  }
  group_first_[group_count_] = static_cast<std::uint32_t>(neighbours_.size());
}

void PaperSearch::visit(Vertex vertex, Candidates& found) noexcept {
  gather_neighbours(vertex, found);
  const auto n = static_cast<std::uint32_t>(map_->positions_W.size());
  const std::size_t k = scan_L_.size();
  const Neighbour apex{vertex / n, vertex % n};
  for (std::uint32_t g = 0; g < group_count_; ++g) {
    for (std::uint32_t h = g + 1; h < group_count_; ++h) {
      const auto side_m = static_cast<double>(scan_edge_m_[group_scan_[g] * k + group_scan_[h]]);
      if (side_m == 0.0) {
        continue;
      }
      for (std::uint32_t b = group_first_[g]; b < group_first_[g + 1]; ++b) {
        if (out_of_time(group_first_[h + 1] - group_first_[h])) {
          return;
        }
        for (std::uint32_t c = group_first_[h]; c < group_first_[h + 1]; ++c) {
          if (map_edge_fits(neighbours_[b].map, neighbours_[c].map, side_m)) {
            try_triangle(apex, neighbours_[b], neighbours_[c], found);
          }
        }
      }
    }
  }
}

bool PaperSearch::map_edge_fits(std::uint32_t a, std::uint32_t b, double length_m) const noexcept {
  if (a == b) {
    return false;
  }
  // The distance refuses nearly all without a look at the lists.
  const double distance_m = (map_->positions_W[a] - map_->positions_W[b]).norm();
  if (std::abs(distance_m - length_m) > config_.tolerance_m) {
    return false;
  }
  const auto edges = map_->graph.neighbours(a);
  const auto shortest = static_cast<float>(distance_m) * (1.0F - 1e-5F) - 1e-5F;
  const auto longest = static_cast<float>(distance_m) * (1.0F + 1e-5F) + 1e-5F;
  auto edge =
      std::lower_bound(edges.begin(), edges.end(), shortest,
                       [](const LandmarkGraph::Neighbour& e, float length) { return e.length_m < length; });
  for (; edge != edges.end() && edge->length_m <= longest; ++edge) {
    if (edge->vertex == b) {
      return true;
    }
  }
  return false;
}

void PaperSearch::try_triangle(const Neighbour& a, const Neighbour& b, const Neighbour& c,
                               Candidates& found) noexcept {
  if (shortlist_.covers(vertex_of(a.scan, a.map), vertex_of(b.scan, b.map), vertex_of(c.scan, c.map))) {
    return;  // a subset of a kept candidate's matches
  }
  const std::array<Point2, 3> scan{scan_L_[a.scan], scan_L_[b.scan], scan_L_[c.scan]};
  const std::array<Point2, 3> map{map_->positions_W[a.map], map_->positions_W[b.map],
                                  map_->positions_W[c.map]};
  const double scan_area = twice_area(scan[0], scan[1], scan[2]);
  const double longest_m =
      std::max({(scan[0] - scan[1]).norm(), (scan[0] - scan[2]).norm(), (scan[1] - scan[2]).norm()});
  if (!nearly_collinear(scan_area, longest_m, config_.tolerance_m) &&
      scan_area * twice_area(map[0], map[1], map[2]) < 0.0) {
    return;  // the mirror image of the scan's triangle: no motion of the plane joins them
  }
  for (const Pose2& pose_W : triangulate(scan, map, config_.tolerance_m)) {
    try_pose(pose_W, {a.map, b.map, c.map}, found);
  }
}

void PaperSearch::try_pose(const Pose2& pose_W, const std::array<std::uint32_t, 3>& triangle,
                           Candidates& found) noexcept {
  ++found.poses_tried;
  if (out_of_time(kWorkPerPose)) {
    return;
  }
  if (scorer_.count_inliers(pose_W, scan_L_, *map_, kInliersMin) < kInliersMin) {
    return;
  }
  std::optional<Candidate> candidate = scorer_.refine(pose_W, scan_L_, *map_);
  if (candidate && candidate->matches.size() >= kInliersMin) {
    candidate->triangle = triangle;
    candidate->log10_chance = log10_chance(*candidate, scan_L_, *map_, config_.tolerance_m);
    shortlist_.offer(*candidate, found);
  }
}

}  // namespace slamsensor::core
