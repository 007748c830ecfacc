#include "tools/eval/evaluation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <random>

namespace slamsensor::tools {
namespace {

using testing::HasSubstr;

std::vector<TimedPose> straight(int count) {
  std::vector<TimedPose> poses;
  for (int i = 0; i < count; ++i) poses.push_back({1.0 + i, {static_cast<double>(i), 0.0, 0.0}});
  return poses;
}

std::vector<TimedPose> moved(std::vector<TimedPose> poses, const core::Pose2& motion) {
  for (TimedPose& timed : poses) timed.pose = motion * timed.pose;
  return poses;
}

TEST(Evaluation, HandComputedErrors) {
  const std::vector<TimedPose> truth = straight(4);
  std::vector<TimedPose> fixes = truth;
  fixes[1].pose.y_m = 0.3;
  fixes[2].pose.y_m = -0.4;
  fixes[2].pose.heading_rad = 0.02;
  fixes[3].pose.x_m = 3.0 + 1.2;
  const auto result = evaluate(truth, fixes);
  ASSERT_TRUE(result);
  ASSERT_TRUE(result->first_fix);
  const AlignedErrors& errors = *result->first_fix;
  EXPECT_EQ(errors.wrong_fixes, 1U);
  EXPECT_NEAR(errors.ate_rms_m, std::sqrt((0.09 + 0.16 + 1.44) / 4.0), 1e-12);
  EXPECT_NEAR(errors.ate_median_m, 0.35, 1e-12);
  EXPECT_NEAR(errors.ate_max_m, 1.2, 1e-12);
  EXPECT_NEAR(errors.heading_rms_rad, 0.01, 1e-12);
  EXPECT_NEAR(errors.heading_max_rad, 0.02, 1e-12);
  EXPECT_EQ(errors.worst.t, 4.0);
  EXPECT_LE(result->least_squares->ate_rms_m, errors.ate_rms_m);
}

TEST(Evaluation, FirstFixDefinesTheMapFrame) {
  const std::vector<TimedPose> truth = straight(10);
  std::vector<TimedPose> fixes = moved(truth, {30.0, -7.0, 2.5});
  const auto result = evaluate(truth, fixes);
  ASSERT_TRUE(result && result->first_fix);
  EXPECT_NEAR(result->first_fix->ate_max_m, 0.0, 1e-12);
  EXPECT_EQ(result->first_fix->wrong_fixes, 0U);
  // A first fix that is turned carries all the others round with it; least squares forgives it.
  fixes[0].pose.heading_rad += 0.2;
  const auto turned = evaluate(truth, fixes);
  EXPECT_NEAR(turned->first_fix->ate_max_m, 2.0 * 9.0 * std::sin(0.1), 1e-9);
  EXPECT_EQ(turned->first_fix->wrong_fixes, 9U);
  EXPECT_EQ(turned->least_squares->wrong_fixes, 1U);
}

TEST(Evaluation, FirstMeansFirstInTheFileNotInTime) {
  const std::vector<TimedPose> truth = straight(3);
  std::vector<TimedPose> fixes{truth[2], truth[0], truth[1]};
  fixes[1].pose.y_m += 0.5;
  const auto result = evaluate(truth, fixes);
  EXPECT_NEAR(result->first_fix->fixes[0].distance_m, 0.0, 1e-12);
  EXPECT_NEAR(result->first_fix->fixes[1].distance_m, 0.5, 1e-12);
}

TEST(Evaluation, ARigidlyMovedTrajectoryHasNoLeastSquaresError) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    std::vector<TimedPose> truth;
    const int count = 1 + static_cast<int>(random() % 40);
    for (int i = 0; i < count; ++i) {
      truth.push_back({i * 0.5, {uniform(-100, 100), uniform(-100, 100), uniform(-3, 3)}});
    }
    const auto result =
        evaluate(truth, moved(truth, {uniform(-1e3, 1e3), uniform(-1e3, 1e3), uniform(-4, 4)}));
    ASSERT_TRUE(result && result->least_squares) << "seed " << seed;
    EXPECT_LT(result->least_squares->ate_max_m, 1e-9) << "seed " << seed;
    EXPECT_LT(result->least_squares->heading_max_rad, 1e-9) << "seed " << seed;
    EXPECT_LT(result->first_fix->ate_max_m, 1e-9) << "seed " << seed;
  }
}

TEST(Evaluation, LeastSquaresIsTheBestOfNearbyMotions) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    std::vector<TimedPose> truth;
    std::vector<TimedPose> fixes;
    for (int i = 0; i < 20; ++i) {
      truth.push_back({i * 1.0, {uniform(-50, 50), uniform(-50, 50), 0.0}});
      fixes.push_back(
          {i * 1.0, {truth.back().pose.x_m + uniform(-1, 1), truth.back().pose.y_m + uniform(-1, 1), 0.0}});
    }
    const AlignedErrors best = *evaluate(truth, fixes)->least_squares;
    for (const core::Pose2& nudge :
         {core::Pose2{0.01, 0, 0}, {-0.01, 0, 0}, {0, 0.01, 0}, {0, -0.01, 0}, {0, 0, 1e-3}, {0, 0, -1e-3}}) {
      const core::Pose2 other = best.T_truth_map * nudge;
      double squares = 0.0;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        squares += (other * fixes[i].pose.translation() - truth[i].pose.translation()).squaredNorm();
      }
      EXPECT_GT(std::sqrt(squares / 20.0), best.ate_rms_m) << "seed " << seed;
    }
  }
}

TEST(Evaluation, PositionsAtOnePlaceAreAlignedByTheirHeadings) {
  const std::vector<TimedPose> truth{{1, {5, 6, 0.1}}, {2, {5, 6, 0.7}}, {3, {5, 6, -0.4}}};
  const auto result = evaluate(truth, moved(truth, {1, 2, 3.1}));
  EXPECT_NEAR(result->least_squares->ate_max_m, 0.0, 1e-12);
  EXPECT_NEAR(result->least_squares->heading_max_rad, 0.0, 1e-12);
}

TEST(Evaluation, OneFixHasNoError) {
  const auto result = evaluate(straight(5), std::vector<TimedPose>{{3.0, {9, 9, 1}}});
  ASSERT_TRUE(result && result->first_fix && result->least_squares);
  EXPECT_NEAR(result->first_fix->ate_max_m, 0.0, 1e-12);
  EXPECT_NEAR(result->least_squares->ate_max_m, 0.0, 1e-12);
  EXPECT_EQ(result->scans_without_fix, 4U);
}

TEST(Evaluation, FixesWithoutTruthAreCountedAndNotJudged) {
  std::vector<TimedPose> fixes = straight(3);
  fixes.insert(fixes.begin(), {0.5, {1e6, 0, 0}});
  fixes.push_back({99.0, {1e6, 0, 0}});
  const auto result = evaluate(straight(3), fixes);
  EXPECT_EQ(result->fixes, 5U);
  EXPECT_EQ(result->fixes_without_truth, 2U);
  EXPECT_EQ(result->first_fix->wrong_fixes, 0U);
  EXPECT_EQ(result->first_fix->fixes.size(), 3U);
}

TEST(Evaluation, TheNearestTruthWithinTheToleranceCounts) {
  const std::vector<TimedPose> truth = straight(3);
  const std::vector<TimedPose> fixes{
      {1.0 + 0.009, truth[0].pose}, {1.9, truth[1].pose}, {3.4, truth[2].pose}};
  EXPECT_EQ(evaluate(truth, fixes)->fixes_without_truth, 2U);
  EvaluationConfig config;
  config.time_tolerance_s = 0.15;
  EXPECT_EQ(evaluate(truth, fixes, config)->fixes_without_truth, 1U);
  config.time_tolerance_s = 0.5;
  const auto result = evaluate(truth, fixes, config);
  EXPECT_EQ(result->fixes_without_truth, 0U);
  EXPECT_NEAR(result->first_fix->ate_max_m, 0.0, 1e-12);
}

TEST(Evaluation, ATimeJustAtTheToleranceCountsHoweverItsDifferenceIsRounded) {
  EvaluationConfig config;
  config.time_tolerance_s = 0.02;
  EXPECT_EQ(evaluate({{{1.0, {}}}}, {{{1.02, {}}}}, config)->fixes_without_truth, 0U);
  EXPECT_EQ(evaluate({{{1.0, {}}}}, {{{1.020001, {}}}}, config)->fixes_without_truth, 1U);
}

TEST(Evaluation, LimitsOfAWrongFixAreExclusiveAndConfigurable) {
  const std::vector<TimedPose> truth = straight(3);
  std::vector<TimedPose> fixes = truth;
  fixes[1].pose.y_m = 1.0;
  fixes[2].pose.heading_rad = 3.0 * std::numbers::pi / 180.0;
  EXPECT_EQ(evaluate(truth, fixes)->first_fix->wrong_fixes, 1U) << "exactly 1 m is not beyond 1 m";
  EvaluationConfig config;
  config.wrong_distance_m = 0.5;
  config.wrong_heading_rad = 0.1;
  const auto result = evaluate(truth, fixes, config);
  EXPECT_EQ(result->first_fix->wrong_fixes, 1U);
  EXPECT_TRUE(result->first_fix->fixes[1].is_wrong);
}

TEST(Evaluation, HeadingErrorGoesTheShortWayRound) {
  std::vector<TimedPose> truth = straight(2);
  std::vector<TimedPose> fixes = truth;
  truth[1].pose.heading_rad = 3.14;
  fixes[1].pose.heading_rad = -3.14;
  EXPECT_NEAR(evaluate(truth, fixes)->first_fix->heading_max_rad, 2.0 * (std::numbers::pi - 3.14), 1e-12);
}

TEST(Evaluation, TenthsFollowTheTruthInTime) {
  std::vector<TimedPose> truth = straight(20);
  std::vector<TimedPose> fixes = truth;
  for (std::size_t i = 0; i < fixes.size(); ++i) fixes[i].pose.y_m = 0.01 * static_cast<double>(i);
  fixes.erase(fixes.begin() + 4, fixes.begin() + 6);
  std::reverse(truth.begin(), truth.end());
  const auto result = evaluate(truth, fixes);
  EXPECT_EQ(result->first_fix->tenths[0].fixes, 2U);
  EXPECT_EQ(result->first_fix->tenths[2].fixes, 0U);
  EXPECT_NEAR(result->first_fix->tenths[9].max_m, 0.19, 1e-12);
  EXPECT_NEAR(result->first_fix->tenths[9].rms_m, std::sqrt((0.18 * 0.18 + 0.19 * 0.19) / 2.0), 1e-12);
}

TEST(Evaluation, RefusesWhatCannotBeJudged) {
  std::vector<TimedPose> twice = straight(3);
  twice[2].t = twice[0].t;
  std::vector<TimedPose> broken = straight(3);
  broken[1].pose.y_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(evaluate(twice, straight(3)).error().message,
              HasSubstr("truth holds two poses with the time 1"));
  EXPECT_THAT(evaluate(straight(3), twice).error().message, HasSubstr("trajectory holds two poses"));
  EXPECT_THAT(evaluate(straight(3), broken).error().message, HasSubstr("not a finite number"));
  EvaluationConfig config;
  config.wrong_distance_m = -1.0;
  EXPECT_FALSE(evaluate(straight(3), straight(3), config));
}

TEST(EvaluationReport, NothingInCommonIsSaid) {
  const auto result = evaluate(straight(3), std::vector<TimedPose>{{77.0, {}}});
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->first_fix);
  EXPECT_THAT(evaluation_text(*result), HasSubstr("nothing to compare"));
  const auto json = nlohmann::json::parse(evaluation_json(*result));
  EXPECT_TRUE(json["first_fix"].is_null());
  EXPECT_TRUE(json["wrong_fixes"].is_null());
  EXPECT_EQ(json["fixes_without_truth"], 1);
  EXPECT_TRUE(has_nothing_in_common(*result));
  EXPECT_THAT(evaluation_text(*result), HasSubstr("within 0.01 s"));
  EXPECT_FALSE(has_nothing_in_common(*evaluate(straight(3), straight(3))));
  EXPECT_FALSE(has_nothing_in_common(*evaluate(straight(3), {}))) << "a run without a fix is a result";
  EXPECT_TRUE(has_nothing_in_common(*evaluate({}, straight(3))));
  EXPECT_TRUE(evaluate({}, {})) << "two empty files are a result, not a crash";
}

TEST(EvaluationReport, GoldenText) {
  std::vector<TimedPose> fixes = straight(2);
  fixes[1].pose.x_m = 1.5;
  EXPECT_EQ(evaluation_text(*evaluate(straight(2), fixes)),
            "scans in truth          2\n"
            "fixes                   2\n"
            "fixes without truth     0\n"
            "scans without fix       0\n"
            "\n"
            "aligned by                   first fix   least squares\n"
            "                            (official)                \n"
            "wrong fixes                          0               0\n"
            "ATE rms (m)                      0.354           0.250\n"
            "ATE median (m)                   0.250           0.250\n"
            "ATE max (m)                      0.500           0.250\n"
            "heading rms (deg)                0.000           0.000\n"
            "heading max (deg)                0.000           0.000\n"
            "worst fix at t                       2               1\n"
            "  its distance (m)               0.500           0.250\n"
            "  its heading (deg)              0.000           0.000\n"
            "\n"
            "ATE rms (m) in tenths of the run\n"
            "tenth  1, 1 fix                  0.000           0.250\n"
            "tenth  2, 0 fixes                    -               -\n"
            "tenth  3, 0 fixes                    -               -\n"
            "tenth  4, 0 fixes                    -               -\n"
            "tenth  5, 0 fixes                    -               -\n"
            "tenth  6, 1 fix                  0.500           0.250\n"
            "tenth  7, 0 fixes                    -               -\n"
            "tenth  8, 0 fixes                    -               -\n"
            "tenth  9, 0 fixes                    -               -\n"
            "tenth 10, 0 fixes                    -               -\n"
            "\n"
            "A fix is wrong when it is more than 1 m or 2 deg from the truth. The first fix defines the map "
            "frame.\n");
}

TEST(EvaluationReport, JsonHasTheFigures) {
  std::vector<TimedPose> fixes = straight(4);
  fixes[3].pose.y_m = 2.0;
  const std::string text = evaluation_json(*evaluate(straight(4), fixes));
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["scans_in_truth"], 4);
  EXPECT_EQ(json["wrong_fixes"], 1);
  EXPECT_EQ(json["official_alignment"], "first_fix");
  EXPECT_DOUBLE_EQ(json["first_fix"]["ate_max_m"].get<double>(), 2.0);
  EXPECT_EQ(json["first_fix"]["worst"]["t"], 4.0);
  EXPECT_EQ(json["first_fix"]["tenths"].size(), 10U);
  EXPECT_TRUE(json["least_squares"].contains("ate_rms_m"));
  EXPECT_EQ(text, evaluation_json(*evaluate(straight(4), fixes)));
}

}  // namespace
}  // namespace slamsensor::tools
