#include "tools/report/correspondence_figure.hpp"

#include "core/graph/delaunay.hpp"
#include "core/graph/landmark_graph.hpp"
#include "core/localizer.hpp"
#include "firmware/arena_block.hpp"
#include "tools/output/text_output.hpp"
#include "tools/plot/scales.hpp"
#include "tools/plot/svg.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace slamsensor::tools {
namespace {

constexpr double kSide_px = 640.0;
constexpr double kMargin_px = 46.0;

/// An edge of a landmark graph.
struct Edge {
  std::size_t a = 0;
  std::size_t b = 0;
  double length_m = 0.0;
};

struct GraphMaker {
  GraphMaker(core::Arena& arena, std::uint32_t points)
      : delaunay(arena, points), graph(arena, "graph", points, points * (points - 1) / 2 + 1) {}
  core::Delaunay delaunay;
  core::LandmarkGraph graph;
};

std::vector<Edge> edges_of(std::span<const core::Point2> points, std::uint32_t depth) {
  firmware::ArenaBlock<GraphMaker> maker(static_cast<std::uint32_t>(std::max<std::size_t>(points.size(), 3)));
  std::vector<Edge> edges;
  if (!maker->graph.build(points, maker->delaunay, depth)) {
    return edges;
  }
  for (std::uint32_t a = 0; a < points.size(); ++a) {
    for (const core::LandmarkGraph::Neighbour& to : maker->graph.neighbours(a)) {
      if (to.vertex > a) {
        edges.push_back({a, to.vertex, static_cast<double>(to.length_m)});
      }
    }
  }
  return edges;
}

std::vector<core::Point2> places_of(std::span<const core::ScanLandmark> landmarks) {
  std::vector<core::Point2> places;
  places.reserve(landmarks.size());
  for (const core::ScanLandmark& landmark : landmarks) {
    places.push_back(landmark.position_L);
  }
  return places;
}

/// Pairs (of scan, of other) that are one landmark by the fix of `scan` in `other`; none without a fix.
std::vector<std::pair<std::size_t, std::size_t>> pairs_by_fix(std::span<const core::ScanLandmark> scan,
                                                              std::span<const core::Point2> other,
                                                              const core::Config& config) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  firmware::ArenaBlock<core::Localizer> localizer(config);
  if (!localizer->set_map(other)) {
    return pairs;
  }
  const core::Fix fix = localizer->locate(scan, {}, {});
  if (fix.status != core::FixStatus::Fix) {
    return pairs;
  }
  std::vector<bool> is_taken(other.size(), false);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const core::Point2 place = fix.pose_W * scan[i].position_L;
    std::size_t best = other.size();
    double least_m = config.association.tolerance_m;
    for (std::size_t j = 0; j < other.size(); ++j) {
      if (const double apart_m = (other[j] - place).norm(); !is_taken[j] && apart_m <= least_m) {
        best = j;
        least_m = apart_m;
      }
    }
    if (best < other.size()) {
      is_taken[best] = true;
      pairs.emplace_back(i, best);
    }
  }
  return pairs;
}

enum class PairedAs : std::uint8_t { Ordered, Scattered };

/// The order in which the paired come first; scattered, so that pairs stand on no common line, which would
/// hide the edges between them.
std::vector<std::size_t> paired_first(std::size_t count, const std::vector<std::size_t>& paired,
                                      PairedAs as) {
  std::size_t stride = 1;
  if (as == PairedAs::Scattered) {
    stride = std::max<std::size_t>(1, paired.size() * 2 / 5);
    while (std::gcd(stride, std::max<std::size_t>(1, paired.size())) != 1) {
      ++stride;
    }
  }
  std::vector<std::size_t> place(count, count);
  for (std::size_t i = 0; i < paired.size(); ++i) {
    place[paired[i]] = i * stride % paired.size();
  }
  std::size_t next = paired.size();
  for (std::size_t& at : place) {
    at = at == count ? next++ : at;
  }
  return place;
}

/// Where vertices stand in the picture.
struct Board {
  std::size_t others = 1;
  std::vector<std::size_t> row;
  std::vector<std::size_t> column;
  core::Point2 corner_px = core::Point2::Zero();
  double row_px = 1.0;
  double column_px = 1.0;

  [[nodiscard]] core::Point2 px(std::size_t vertex) const {
    return corner_px + core::Point2((static_cast<double>(column[vertex % others]) + 0.5) * column_px,
                                    (static_cast<double>(row[vertex / others]) + 0.5) * row_px);
  }
};

void draw_edges(SvgWriter& svg, const Board& board, const CorrespondenceGraph& graph,
                const std::vector<bool>& is_true) {
  PathData chance;
  PathData right;
  for (const auto& [a, b] : graph.edges) {
    (is_true[a] && is_true[b] ? right : chance).segment(board.px(a), board.px(b));
  }
  const double density = static_cast<double>(graph.edges.size()) / 1000.0;
  svg.path(chance, stroke("#555555", 0.6) + " stroke-opacity=\"" +
                       fixed_text(std::clamp(0.35 / std::max(1.0, density), 0.03, 0.35), 3) + '"');
  svg.path(right, stroke(kTruthColour, 0.9) + " stroke-opacity=\"0.6\"");
}

void draw_vertices(SvgWriter& svg, const Board& board, const CorrespondenceGraph& graph,
                   const std::vector<bool>& is_true) {
  std::size_t most = 1;
  for (const std::size_t degree : graph.degree) {
    most = std::max(most, degree);
  }
  const double largest_px = 0.42 * std::min(board.row_px, board.column_px);
  for (std::size_t v = 0; v < graph.degree.size(); ++v) {
    const double share = static_cast<double>(graph.degree[v]) / static_cast<double>(most);
    const double radius_px = std::max(0.7, largest_px * std::sqrt(share));
    const std::string colour(is_true[v] ? kTruthColour : kHeadingColour);
    svg.circle(board.px(v), radius_px,
               graph.degree[v] == 0 ? std::string("fill=\"#cccccc\"") : "fill=\"" + colour + '"');
  }
}

std::string summary_text(const CorrespondenceGraph& graph, std::size_t scan, std::size_t pairs,
                         const core::AssociationConfig& config) {
  return std::to_string(scan) + " by " + std::to_string(graph.others) + " landmarks, " +
         std::to_string(graph.edges.size()) + " edges at depth " + std::to_string(config.depth) +
         " and tolerance " + fixed_text(config.tolerance_m, 2) + " m; " +
         (pairs > 0 ? std::to_string(pairs) + " pairs belong together (orange)"
                    : std::string("there is no fix of the one in the other"));
}

}  // namespace

CorrespondenceGraph correspondence_graph(std::span<const core::Point2> scan,
                                         std::span<const core::Point2> other,
                                         const core::AssociationConfig& config) {
  CorrespondenceGraph graph;
  graph.others = other.size();
  graph.degree.assign(scan.size() * other.size(), 0);
  std::vector<Edge> theirs = edges_of(other, config.depth);
  std::sort(theirs.begin(), theirs.end(),
            [](const Edge& a, const Edge& b) { return a.length_m < b.length_m; });
  const auto join = [&](std::size_t a, std::size_t b) {
    graph.edges.emplace_back(a, b);
    ++graph.degree[a];
    ++graph.degree[b];
  };
  for (const Edge& ours : edges_of(scan, config.depth)) {
    auto their = std::lower_bound(theirs.begin(), theirs.end(), ours.length_m - config.tolerance_m,
                                  [](const Edge& edge, double length_m) { return edge.length_m < length_m; });
    for (; their != theirs.end() && their->length_m <= ours.length_m + config.tolerance_m; ++their) {
      join(ours.a * graph.others + their->a, ours.b * graph.others + their->b);
      join(ours.a * graph.others + their->b, ours.b * graph.others + their->a);
    }
  }
  return graph;
}

std::string draw_correspondences(std::span<const core::ScanLandmark> scan,
                                 std::span<const core::ScanLandmark> other, const core::Config& config,
                                 const std::string& title) {
  const std::vector<core::Point2> others = places_of(other);
  const CorrespondenceGraph graph = correspondence_graph(places_of(scan), others, config.association);
  const auto pairs = pairs_by_fix(scan, others, config);
  std::vector<bool> is_true(graph.degree.size(), false);
  std::vector<std::size_t> paired;
  std::vector<std::size_t> paired_other;
  for (const auto& [i, j] : pairs) {
    is_true[i * graph.others + j] = true;
    paired.push_back(i);
    paired_other.push_back(j);
  }
  SvgWriter svg;
  const double top =
      draw_heading(svg, title, {summary_text(graph, scan.size(), pairs.size(), config.association)},
                   {kMargin_px, 14.0}, kSide_px) +
      10.0;
  Board board;
  board.others = std::max<std::size_t>(1, graph.others);
  board.row = paired_first(scan.size(), paired, PairedAs::Ordered);
  board.column = paired_first(other.size(), paired_other, PairedAs::Scattered);
  board.corner_px = {kMargin_px, top};
  board.row_px = kSide_px / static_cast<double>(std::max<std::size_t>(1, scan.size()));
  board.column_px = kSide_px / static_cast<double>(board.others);
  svg.rect({kMargin_px, top, kMargin_px + kSide_px, top + kSide_px}, stroke(kGrid, 1.0));
  draw_edges(svg, board, graph, is_true);
  draw_vertices(svg, board, graph, is_true);
  constexpr std::string_view kMiddle = "fill=\"#1a1a1a\" font-size=\"12\" text-anchor=\"middle\"";
  svg.text({kMargin_px + 0.5 * kSide_px, top + kSide_px + 24.0}, "landmarks of the other scan", kMiddle);
  svg.text({0.0, 0.0}, "landmarks of the scan",
           "transform=\"translate(24 " + fixed_text(top + 0.5 * kSide_px, 2) + ") rotate(-90)\" " +
               std::string(kMiddle));
  return svg.finish(kSide_px + 2.0 * kMargin_px, top + kSide_px + 40.0);
}

}  // namespace slamsensor::tools
