#include "core/association/rigid_fit.hpp"

#include "tests/support/forest.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <vector>

namespace slamsensor::core {
namespace {

using tests::Draw;

struct Case {
  Pose2 truth;
  std::vector<Point2> scan_L;
  std::vector<Point2> map_W;
  std::vector<Match> matches;
};

Case make_case(Draw& draw, std::uint32_t count, double sigma_m) {
  Case c;
  c.truth = {draw.uniform(-30, 30), draw.uniform(-30, 30), draw.uniform(-3.1, 3.1)};
  for (std::uint32_t i = 0; i < count; ++i) {
    c.map_W.push_back(Point2{draw.uniform(-30, 30), draw.uniform(-30, 30)});
    c.scan_L.push_back(c.truth.inverse() * c.map_W.back() +
                       Point2{draw.normal(sigma_m), draw.normal(sigma_m)});
    c.matches.push_back({i, i});
  }
  return c;
}

TEST(RigidFit, IsExactWithoutNoise) {
  Draw draw(3);
  for (int i = 0; i < 100; ++i) {
    const Case c = make_case(draw, 2 + draw.below(20), 0.0);
    const auto pose = fit_pose(c.matches, c.scan_L, c.map_W);
    ASSERT_TRUE(pose);
    EXPECT_NEAR(pose->x_m, c.truth.x_m, 1e-9);
    EXPECT_NEAR(pose->y_m, c.truth.y_m, 1e-9);
    EXPECT_NEAR(wrap_angle(pose->heading_rad - c.truth.heading_rad), 0.0, 1e-10);
  }
}

TEST(RigidFit, NeedsTwoDistinctLandmarks) {
  const std::vector<Point2> points{Point2(1, 2), Point2(1, 2)};
  const std::vector<Match> both{{0, 0}, {1, 1}};
  EXPECT_FALSE(fit_pose(std::span(both).first(1), points, points));
  EXPECT_FALSE(fit_pose(both, points, points));
}

TEST(RigidFit, RobustFitIsNotPulledByAWrongMatch) {
  Draw draw(4);
  for (int i = 0; i < 50; ++i) {
    Case c = make_case(draw, 12, 0.02);
    c.map_W[5] += Point2(0.6, -0.5);
    const auto plain = fit_pose(c.matches, c.scan_L, c.map_W);
    ASSERT_TRUE(plain);
    const Pose2 robust = fit_pose_robust(*plain, c.matches, c.scan_L, c.map_W, 0.1);
    const double plain_error = (plain->translation() - c.truth.translation()).norm();
    const double robust_error = (robust.translation() - c.truth.translation()).norm();
    EXPECT_LT(robust_error, 0.05) << "case " << i;
    EXPECT_LT(robust_error, plain_error + 0.02) << "case " << i;
  }
}

TEST(RigidFit, RobustFitWithoutMatchesStays) {
  const Pose2 start{1, 2, 0.5};
  const Pose2 end = fit_pose_robust(start, {}, {}, {}, 0.1);
  EXPECT_EQ(end.x_m, 1.0);
  EXPECT_EQ(end.heading_rad, 0.5);
}

// Normalised estimation error squared. With a known spread its mean would be the pose's 3 degrees of freedom;
// with one estimated from 24 degrees of freedom (21 of the residuals, 3 of the prior) it is 3 * 24 / 22.
TEST(PoseCovariance, IsConsistentWithTheErrorsItDescribes) {
  Draw draw(5);
  double sum = 0.0;
  constexpr int kDraws = 2000;
  constexpr double kSigma = 0.1;
  for (int i = 0; i < kDraws; ++i) {
    const Case c = make_case(draw, 12, kSigma);
    const auto pose = fit_pose(c.matches, c.scan_L, c.map_W);
    ASSERT_TRUE(pose);
    const Eigen::Vector3d error(pose->x_m - c.truth.x_m, pose->y_m - c.truth.y_m,
                                wrap_angle(pose->heading_rad - c.truth.heading_rad));
    const Eigen::Matrix3d covariance = pose_covariance(*pose, c.matches, c.scan_L, c.map_W, kSigma);
    sum += error.dot(covariance.inverse() * error);
  }
  EXPECT_NEAR(sum / kDraws, 3.27, 0.3);
}

TEST(PoseCovariance, IsSymmetricAndHugeWhenNothingIsKnown) {
  const std::vector<Point2> one{Point2(3, 4)};
  const std::vector<Match> match{{0, 0}};
  const Eigen::Matrix3d unknown = pose_covariance(Pose2{}, match, one, one, 0.1);
  EXPECT_GT(unknown(0, 0), 1e5);
  Draw draw(6);
  const Case c = make_case(draw, 8, 0.1);
  const Eigen::Matrix3d known = pose_covariance(c.truth, c.matches, c.scan_L, c.map_W, 0.1);
  EXPECT_TRUE(known.isApprox(known.transpose(), 1e-9));
  EXPECT_GT(known.determinant(), 0.0);
}

}  // namespace
}  // namespace slamsensor::core
