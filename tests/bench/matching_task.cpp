#include "tests/bench/matching_task.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace slamsensor::bench {
namespace {

constexpr std::uint64_t kSeed = 20'001;
constexpr std::uint32_t kForeignTrees = 20'000;  // more say nothing more

tests::Forest make_rows(std::uint32_t count, tests::Draw& draw) {
  constexpr double kSpacing_m = 5.0;
  constexpr double kBeside_m = 0.4;
  const auto columns = static_cast<std::uint32_t>(std::sqrt(count));
  tests::Forest forest;
  forest.side_m = kSpacing_m * columns;
  for (std::uint32_t row = 0; row < columns; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const double x = kSpacing_m * column - 0.5 * forest.side_m + draw.normal(kBeside_m);
      const double y = kSpacing_m * row - 0.5 * forest.side_m + draw.normal(kBeside_m);
      forest.trees_W.emplace_back(x, y);
    }
  }
  return forest;
}

tests::ScanModel scan_model(const TaskShape& shape) {
  const bool is_half = shape.world == World::Half;
  return {shape.nearest, is_half ? 0.5 : 0.3, shape.nearest / (is_half ? 2U : 4U), shape.sigma_m};
}

}  // namespace

Surroundings::Surroundings(const tests::Forest& forest)
    : forest_(forest), columns_(static_cast<std::size_t>(forest.side_m / kCell_m) + 3) {
  cells_.resize(columns_ * columns_);
  for (const core::Point2& p : forest.trees_W) {
    cells_[column_of(p.y()) * columns_ + column_of(p.x())].push_back(p);
  }
}

tests::Forest Surroundings::about(const core::Point2& p, std::uint32_t nearest) const {
  const double per_tree_m2 = forest_.side_m * forest_.side_m / static_cast<double>(forest_.trees_W.size());
  const std::size_t reach = static_cast<std::size_t>(2.0 * std::sqrt(nearest * per_tree_m2) / kCell_m) + 1;
  const std::size_t row = column_of(p.y());
  const std::size_t column = column_of(p.x());
  tests::Forest part;
  part.side_m = forest_.side_m;
  for (std::size_t r = row - std::min(row, reach); r <= std::min(row + reach, columns_ - 1); ++r) {
    for (std::size_t c = column - std::min(column, reach); c <= std::min(column + reach, columns_ - 1); ++c) {
      const auto& cell = cells_[r * columns_ + c];
      part.trees_W.insert(part.trees_W.end(), cell.begin(), cell.end());
    }
  }
  return part;
}

std::size_t Surroundings::column_of(double v_m) const {
  const double column = std::floor((v_m + 0.5 * forest_.side_m) / kCell_m) + 1.0;
  return static_cast<std::size_t>(std::clamp(column, 0.0, static_cast<double>(columns_ - 1)));
}

std::string TaskShape::name() const {
  static constexpr const char* kWorlds[] = {"forest", "half", "rows", "foreign"};
  char text[64];
  std::snprintf(text, sizeof(text), "%s/n=%u/k=%u/sigma=%.2f", kWorlds[static_cast<std::size_t>(world)],
                landmarks, nearest, sigma_m);
  return text;
}

MatchingTask make_matching_task(const TaskShape& shape, std::size_t queries) {
  const std::uint64_t seed = kSeed + shape.landmarks;
  tests::Draw here_draw(seed);
  const tests::Forest here = shape.world == World::Rows ? make_rows(shape.landmarks, here_draw)
                                                        : tests::make_forest(shape.landmarks, here_draw);
  tests::Draw elsewhere_draw(seed + 1'000'000'000);
  const tests::Forest elsewhere =
      shape.world == World::Foreign
          ? tests::make_forest(std::min(shape.landmarks, kForeignTrees), elsewhere_draw)
          : tests::Forest{};
  const tests::Forest& scanned = shape.world == World::Foreign ? elsewhere : here;
  const tests::ScanModel model = scan_model(shape);
  MatchingTask task;
  task.map_W = here.trees_W;
  task.queries.resize(queries);
  if (queries == 0) {
    return task;
  }
  const Surroundings surroundings(scanned);
  tests::Draw draw(seed + 1);
  for (Query& query : task.queries) {
    query.truth_W = tests::pose_in(scanned, draw);
    query.scan_L = tests::scan_forest(surroundings.about(query.truth_W.translation(), shape.nearest),
                                      query.truth_W, model, draw);
  }
  return task;
}

}  // namespace slamsensor::bench
