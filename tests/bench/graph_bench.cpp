// The landmark graph (DESIGN 2.3): Delaunay triangulation, the graph of depth 2 on it, and the whole index of
// a map.
#include "core/config.hpp"
#include "core/graph/delaunay.hpp"
#include "core/graph/landmark_graph.hpp"
#include "core/mapping/landmark_map.hpp"
#include "tests/bench/matching_task.hpp"
#include "tests/bench/report.hpp"
#include "tests/support/in_arena.hpp"

#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

namespace slamsensor::bench {
namespace {

constexpr std::size_t kRepetitions = 100;
constexpr std::uint32_t kDepth = 2;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

/// Times of `work`, after one run to warm the caches.
Times times_of(const std::function<void()>& work) {
  work();
  Times times(kRepetitions);
  for (std::size_t i = 0; i < kRepetitions; ++i) {
    times.add(cpu_of_ms(work));
  }
  return times;
}

void finish(Row row, std::size_t edges, const Times& times) {
  row.number("edges", static_cast<double>(edges), 0)
      .number("runs", static_cast<double>(times.count()), 0)
      .times(times)
      .finish(times.mean_ms());
}

void measure_delaunay(Row row, const std::vector<core::Point2>& points) {
  tests::InArena<core::Delaunay> delaunay(static_cast<std::uint32_t>(points.size()));
  const Times times = times_of([&] { require(delaunay->build(points)); });
  finish(std::move(row), delaunay->edges().size(), times);
}

void measure_graph(Row row, const std::vector<core::Point2>& points) {
  const auto n = static_cast<std::uint32_t>(points.size());
  tests::InArena<core::Delaunay> delaunay(n);
  tests::InArena<core::LandmarkGraph> graph("bench: graph", n, 12 * n);
  const Times times = times_of([&] { require(graph->build(points, *delaunay, kDepth)); });
  require(graph->edges_dropped() == 0);
  finish(std::move(row), graph->edge_count(), times);
}

void measure_index(Row row, const std::vector<core::Point2>& points) {
  core::Capacities capacities;
  capacities.map_landmarks = static_cast<std::uint32_t>(points.size());
  capacities.map_edges = 12 * capacities.map_landmarks;
  tests::InArena<core::Delaunay> delaunay(capacities.map_landmarks);
  tests::InArena<core::LandmarkMap> map(capacities);
  for (const core::Point2& p : points) {
    require(map->try_add({}, p));
  }
  const Times times = times_of([&] { map->rebuild_index(*delaunay, core::AssociationConfig{}); });
  finish(std::move(row), map->view().graph.edge_count(), times);
}

using Measure = void (*)(Row, const std::vector<core::Point2>&);

void add(Report& report, const std::string& what, std::uint32_t n, Measure measure) {
  add_benchmark("graph/n=" + std::to_string(n) + "/" + what, [=, &report](benchmark::State& state) {
    measure(Row(state, report, "n = " + std::to_string(n) + ": " + what),
            make_matching_task({World::Forest, n, 20, 0.15}, 0).map_W);
  });
}

}  // namespace
}  // namespace slamsensor::bench

int main(int argc, char** argv) {
  using namespace slamsensor::bench;
  Report report("Graph of a map: random trees, 70 m^2 each");
  for (const std::uint32_t n : {1000U, 10'000U}) {
    add(report, "Delaunay", n, measure_delaunay);
    add(report, "Delaunay and depth-2 graph", n, measure_graph);
    add(report, "whole index of a map (graph and grid)", n, measure_index);
  }
  return run(argc, argv, report);
}
