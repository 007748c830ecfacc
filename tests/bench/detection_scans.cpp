#include "tests/bench/detection_scans.hpp"

#include "core/config.hpp"
#include "core/detection/polar_grid.hpp"
#include "tests/support/forest.hpp"
#include "tools/world/drive.hpp"
#include "tools/world/simulate.hpp"
#include "tools/world/world.hpp"
#include "tools/world/world_config.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>

namespace slamsensor::bench {
namespace {

constexpr std::uint64_t kSeed = 7;

template <typename T>
T value_or_exit(tl::expected<T, tools::WorldError> result) {
  if (!result) {
    std::fprintf(stderr, "bench_detection: %s\n", result.error().message.c_str());
    std::exit(1);
  }
  return std::move(*result);
}

/// Row of the spiderweb that a column of a scanline shows; none: no return.
using RowOf = std::function<std::optional<std::uint32_t>(std::uint32_t line, std::uint32_t column)>;

/// A sweep over cells that are given, each reading at a random range within its cell.
Scan scan_of_cells(const RowOf& row_of) {
  const tools::SweepConfig sweep = tools::paper_sweep_1_2();
  const core::DetectionConfig config;
  const core::PolarGrid grid(config);
  tests::Draw draw(kSeed);
  Scan scan(tools::line_count(sweep));
  for (std::uint32_t line = 0; line < scan.size(); ++line) {
    const double tilt_rad = sweep.tilt_min_rad + line * sweep.tilt_step_rad;
    for (std::size_t i = 0; i < tools::readings_per_line(sweep); ++i) {
      const double pan_rad = tools::reading_pan_rad(sweep, line, i);
      const std::optional<std::uint32_t> row = row_of(line, grid.column_of(pan_rad));
      const double horizontal_m = row ? (*row + draw.uniform(0.05, 0.95)) * config.range_step_m : 0.0;
      scan[line].push_back(
          {pan_rad, tilt_rad, row ? horizontal_m / std::cos(tilt_rad) : core::Reading::kNoReturn});
    }
  }
  return scan;
}

}  // namespace

std::vector<Scan> bush_scans(std::size_t count) {
  const tools::World world =
      value_or_exit(tools::World::create(value_or_exit(tools::load_world(SLAMSENSOR_BENCH_WORLD))));
  tools::DriveConfig drive;
  drive.stands = static_cast<std::uint32_t>(count);
  drive.kidnap_share = 1.0;
  std::vector<Scan> scans;
  for (const tools::Stand& stand : value_or_exit(tools::make_drive(world, drive, kSeed))) {
    scans.push_back(
        tools::scan(world, tools::paper_sweep_1_2(), stand.pose, stand.time_s, kSeed + scans.size()));
  }
  return scans;
}

Scan most_groups_scan() {
  return scan_of_cells([](std::uint32_t line, std::uint32_t column) -> std::optional<std::uint32_t> {
    if (column % 2 == 1) {
      return std::nullopt;
    }
    return 20 + 3 * line + 200 * (column % 4 / 2);  // three rows on: no cell touches another
  });
}

Scan most_cells_scan() {
  return scan_of_cells([](std::uint32_t line, std::uint32_t column) -> std::optional<std::uint32_t> {
    if (column % 100 == 0) {
      return std::nullopt;  // an end for the cluster
    }
    return 20 + line;
  });
}

Scan noise_scan() {
  const tools::SweepConfig sweep = tools::paper_sweep_1_2();
  const core::DetectionConfig config;
  tests::Draw draw(kSeed);
  Scan scan(tools::line_count(sweep));
  for (std::size_t line = 0; line < scan.size(); ++line) {
    const double line_tilt_rad = sweep.tilt_min_rad + static_cast<double>(line) * sweep.tilt_step_rad;
    for (std::size_t i = 0; i < tools::readings_per_line(sweep); ++i) {
      const double tilt_rad = line_tilt_rad + draw.uniform(-0.5, 0.5) * sweep.tilt_step_rad;
      const double range_m =
          draw.uniform(0.0, 1.0) < 0.5 ? core::Reading::kNoReturn : draw.uniform(0.5, config.range_max_m);
      scan[line].push_back({tools::reading_pan_rad(sweep, line, i), tilt_rad, range_m});
    }
  }
  return scan;
}

}  // namespace slamsensor::bench
