#include "core/detection/polar_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace slamsensor::core {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

PolarGrid grid_of(double range_max_m, double range_step_m, double bearing_step_rad) {
  DetectionConfig config;
  config.range_max_m = range_max_m;
  config.range_step_m = range_step_m;
  config.bearing_step_rad = bearing_step_rad;
  return PolarGrid(config);
}

TEST(PolarGrid, PaperSizeIs600By701) {
  const PolarGrid grid{DetectionConfig{}};
  EXPECT_EQ(grid.rows(), 600U);
  EXPECT_EQ(grid.columns(), 701U);  // 360 / 0.514 = 700.39: the last column is 0.39 of a column wide
}

TEST(PolarGrid, WholeDivisionsMakeNoSliverColumn) {
  for (std::uint32_t columns = 1; columns <= 2000; ++columns) {
    EXPECT_EQ(grid_of(10.0, 1.0, kTurn / columns).columns(), columns);
    EXPECT_EQ(grid_of(10.0, 1.0, (360.0 / columns) * kDegree).columns(), columns);
  }
  for (std::uint32_t rows = 1; rows <= 2000; ++rows) {
    EXPECT_EQ(grid_of(0.1 * rows, 0.1, 1.0).rows(), rows);
  }
  EXPECT_EQ(grid_of(10.01, 0.1, 1.0).rows(), 101U);
}

TEST(PolarGrid, EdgeBelongsToTheHigherColumn) {
  for (const double step_deg : {0.1, 0.2, 0.514, 0.7, 1.0, 18.0}) {
    const PolarGrid grid = grid_of(10.0, 1.0, step_deg * kDegree);
    for (std::uint32_t column = 0; column < grid.columns(); ++column) {
      const double edge_rad = step_deg * column * kDegree;  // rounded another way than edge_rad()
      EXPECT_EQ(grid.column_of(edge_rad), column) << step_deg;
      EXPECT_EQ(grid.column_of(grid.edge_rad(column)), column) << step_deg;
      EXPECT_EQ(grid.column_of(edge_rad - kTurn), column) << step_deg;  // the same edge, from -pi..pi
      EXPECT_EQ(grid.column_of(edge_rad + 3.0 * kTurn), column) << step_deg;
      EXPECT_EQ(grid.column_of(edge_rad - 1e-9), grid.previous(column)) << step_deg;
    }
  }
}

TEST(PolarGrid, EdgeBelongsToTheHigherRow) {
  const PolarGrid tenths = grid_of(300.0, 0.1, 1.0);
  for (std::uint32_t row = 0; row < tenths.rows(); ++row) {
    EXPECT_EQ(tenths.row_of(row / 10.0), row);
    EXPECT_EQ(tenths.row_of(row * 0.1), row);
    EXPECT_EQ(tenths.row_of((row + 0.999) * 0.1), row);
  }
}

TEST(PolarGrid, OutermostRowHasTheGreatestRange) {
  const PolarGrid grid{DetectionConfig{}};
  EXPECT_EQ(grid.row_of(299.99), 599U);
  EXPECT_EQ(grid.row_of(300.0), 599U);
  EXPECT_EQ(grid.row_of(std::numeric_limits<double>::max()), 599U);
  EXPECT_EQ(grid.row_of(0.0), 0U);
}

TEST(PolarGrid, RoundingAtTheFullTurnNeverLeavesTheGrid) {
  for (const double step_deg : {0.514, 18.0, 7.0, 360.0}) {
    const PolarGrid grid = grid_of(10.0, 1.0, step_deg * kDegree);
    EXPECT_EQ(grid.column_of(kTurn), 0U);
    EXPECT_EQ(grid.column_of(-kTurn), 0U);
    EXPECT_EQ(grid.column_of(-0.0), 0U);
    EXPECT_EQ(grid.column_of(-1e-300), 0U);  // -1e-300 + 2 pi rounds to 2 pi
    EXPECT_EQ(grid.column_of(std::nextafter(kTurn, 0.0)), 0U);
    EXPECT_EQ(grid.column_of(kTurn - 1e-6), grid.columns() - 1);
    EXPECT_EQ(grid.column_of(-1e-6), grid.columns() - 1);
  }
}

TEST(PolarGrid, AnyFiniteBearingHasAColumn) {
  const unsigned seed = 20240611;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> exponent(-320.0, 308.0);
  const PolarGrid grid{DetectionConfig{}};
  for (int i = 0; i < 100'000; ++i) {
    const double bearing_rad = (i % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, exponent(random));
    ASSERT_LT(grid.column_of(bearing_rad), grid.columns()) << bearing_rad;
  }
}

TEST(PolarGrid, OffCentreIsSignedAndCircular) {
  const PolarGrid grid = grid_of(10.0, 1.0, 18.0 * kDegree);
  EXPECT_NEAR(grid.off_centre_rad(0, 10.0 * kDegree), 1.0 * kDegree, 1e-12);
  EXPECT_NEAR(grid.off_centre_rad(19, -10.0 * kDegree), -1.0 * kDegree, 1e-12);
  EXPECT_NEAR(grid.off_centre_rad(19, 350.0 * kDegree), -1.0 * kDegree, 1e-12);
}

}  // namespace
}  // namespace slamsensor::core
