#include "core/association/candidate.hpp"

#include "tests/support/forest.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace slamsensor::core {
namespace {

TEST(ScanMoments, DisplacementIsTheRootMeanSquareOverTheScan) {
  tests::Draw draw(21);
  for (int round = 0; round < 50; ++round) {
    std::vector<Point2> scan;
    for (int i = 0; i < 12; ++i) {
      scan.push_back(Point2{draw.uniform(-20, 40), draw.uniform(-10, 30)});
    }
    const Pose2 a{draw.uniform(-50, 50), draw.uniform(-50, 50), draw.uniform(-3, 3)};
    const Pose2 b{draw.uniform(-50, 50), draw.uniform(-50, 50), draw.uniform(-3, 3)};
    double sum = 0.0;
    for (const Point2& p : scan) {
      sum += (a * p - b * p).squaredNorm();
    }
    EXPECT_NEAR(ScanMoments(scan).displacement_m(a, b), std::sqrt(sum / 12.0), 1e-9);
  }
  EXPECT_EQ(ScanMoments({}).displacement_m({}, {}), 0.0);
}

TEST(Candidate, MoreMatchesFirstThenTheSmallerResidual) {
  Candidate a;
  Candidate b;
  ASSERT_TRUE(a.matches.try_push_back({0, 0}));
  a.residual_m2 = 9.0;
  EXPECT_TRUE(a.matches_more_than(b));
  EXPECT_FALSE(b.matches_more_than(a));
  ASSERT_TRUE(b.matches.try_push_back({0, 1}));
  b.residual_m2 = 1.0;
  EXPECT_TRUE(b.matches_more_than(a));
  EXPECT_FALSE(a.matches_more_than(a));
  EXPECT_TRUE(b.more_significant_than(a));  // equally unlikely to be chance: as the paper
  a.log10_chance = -3.0;
  EXPECT_TRUE(a.more_significant_than(b));
}

}  // namespace
}  // namespace slamsensor::core
