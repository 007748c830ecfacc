#include "core/graph/delaunay.hpp"
#include "core/graph/landmark_graph.hpp"
#include "core/memory/arena.hpp"
#include "firmware/arena_block.hpp"
#include "tools/commands/command.hpp"
#include "tools/output/text_output.hpp"
#include "tools/plot/curve_plot.hpp"
#include "tools/plot/svg.hpp"
#include "tools/world/random.hpp"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

namespace slamsensor::tools {
namespace {

struct Options {
  std::uint32_t points = 1000;
  std::uint32_t depth = 20;
  std::uint32_t sets = 10;
  std::uint64_t seed = 1;
  std::string out;
};

/// The complete graph is the largest that a depth can give.
struct EdgeCounter {
  EdgeCounter(core::Arena& arena, std::uint32_t points) noexcept
      : delaunay(arena, points), graph(arena, "graph", points, points * (points - 1) / 2) {}
  std::uint32_t count(std::span<const core::Point2> points, std::uint32_t depth) noexcept {
    return graph.build(points, delaunay, depth) ? graph.edge_count() : 0;
  }
  core::Delaunay delaunay;
  core::LandmarkGraph graph;
};

std::vector<core::Point2> uniform_square(std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<core::Point2> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = draw_uniform(random, 0.0, 1000.0);
    points.emplace_back(x, draw_uniform(random, 0.0, 1000.0));
  }
  return points;
}

CommandResult run(const Options& options) {
  firmware::ArenaBlock<EdgeCounter> edges(options.points);
  std::vector<double> mean(options.depth + 1, 0.0);
  {
    ProgressBar bar("edges");
    for (std::uint32_t set = 0; set < options.sets; ++set) {
      const auto points = uniform_square(options.points, options.seed + set);
      for (std::uint32_t depth = 1; depth <= options.depth; ++depth) {
        mean[depth] += edges->count(points, depth) / static_cast<double>(options.sets);
        bar.update(set * options.depth + depth, std::size_t{options.sets} * options.depth);
      }
    }
  }
  CurvePlot plot;
  plot.title = "Edges of the landmark graph against depth";
  plot.summary = {std::to_string(options.points) + " uniform random landmarks, mean of " +
                  std::to_string(options.sets) + " sets (the paper's Fig. 5)"};
  plot.x_label = "depth, mesh steps";
  plot.y_label = "edges";
  plot.x_step_min = plot.y_step_min = 1.0;
  plot.series.push_back({"edges", {}, CurveStyle::LineAndMarkers});
  CurveSeries complete{"complete graph", {}, CurveStyle::Line};
  std::printf("depth       edges\n");
  for (std::uint32_t depth = 1; depth <= options.depth; ++depth) {
    std::printf("%5u %11.0f\n", depth, mean[depth]);
    plot.series[0].points.emplace_back(depth, mean[depth]);
    complete.points.emplace_back(depth, 0.5 * options.points * (options.points - 1.0));
  }
  plot.series.push_back(complete);
  if (options.out.empty()) {
    return EX_OK;
  }
  const auto written = write_picture(options.out, draw_curve(plot));
  return written ? CommandResult(EX_OK)
                 : tl::unexpected(CommandError{written.error().message + '\n', EX_CANTCREAT});
}

}  // namespace

void add_edges(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      app.add_subcommand("edges", "count the edges of random landmark graphs against depth (Fig. 5)");
  verb->add_option("--points", options->points, "landmarks in a set")
      ->check(CLI::Range(3, 3000))
      ->capture_default_str();
  verb->add_option("--depth", options->depth, "largest depth")
      ->check(CLI::Range(1, 50))
      ->capture_default_str();
  verb->add_option("--sets", options->sets, "random sets to average")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--seed", options->seed, "of the first set")->capture_default_str();
  verb->add_option("--out", options->out, "draw the curve to this file, SVG or PNG")
      ->check(is_picture_name)
      ->type_name("F.svg|F.png");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
