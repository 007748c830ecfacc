#include "core/sweep/pan_fit.hpp"

#include "firmware/arena_block.hpp"
#include "firmware/scan/sensor_head.hpp"
#include "tests/support/fake_head.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace slamsensor::firmware {
namespace {

using core::PanFit;
using core::PanFitProblem;

constexpr double kStep_rad = kPaperStep_rad;
constexpr double kMilliDegree = std::numbers::pi / 180e3;
constexpr hal::Stamp kBegun = std::chrono::milliseconds(700);

/// How a line's polls are made from the truth.
struct Polls {
  double slowness = 0.0;
  double jitter_s = 0.0;  // of when the unit looks, uniform, half to each side
  double speed_radps = 1000.0 * kStep_rad;
  double base_radps = 1000.0 * kStep_rad;
  double hz = 37.3;
  double stall_rad = std::nan("");
  double stall_s = 0.0;
  double offset_rad = 0.0;  // before rounding down to a position
  std::uint64_t seed = 1;
};

struct Line {
  hal::MotionProfile move;
  tests::FakeAxis truth;
  std::vector<hal::AxisSample> polls;
};

Line make_line(const Polls& how) {
  const hal::AxisDynamics dynamics{how.base_radps, 2000.0 * kStep_rad};
  Line line;
  line.move = hal::MotionProfile(-2500 * kStep_rad, 2500 * kStep_rad, how.speed_radps, dynamics);
  line.truth.slowness = how.slowness;
  line.truth.begin(-2500 * kStep_rad, 1.0, {}, hal::Stamp{});
  line.truth.begin(-2500 * kStep_rad, 1.0, {}, std::chrono::hours(1));  // rests there
  line.truth.stall_rad = how.stall_rad;
  line.truth.stall_s = how.stall_s;
  line.truth.begin(2500 * kStep_rad, how.speed_radps, dynamics, kBegun);
  std::mt19937_64 rng(how.seed);
  for (double t_s = 0.5; t_s < 8.0; t_s += 1.0 / how.hz) {
    const hal::Stamp stamp = hal::from_seconds(t_s);
    const hal::Stamp looked = stamp + hal::from_seconds(how.jitter_s * (tests::draw(rng) - 0.5));
    const double position_rad =
        std::floor((line.truth.true_rad(looked) + how.offset_rad) / kStep_rad) * kStep_rad;
    line.polls.push_back({stamp, std::chrono::milliseconds(2), position_rad, hal::Axis::Pan});
  }
  return line;
}

core::Outcome<PanFit, PanFitProblem> fit(const hal::MotionProfile& move,
                                         const std::vector<hal::AxisSample>& polls,
                                         const PanFitConfig& config = {}) {
  std::vector<core::TimedAngle> angles;
  for (const hal::AxisSample& poll : polls) {
    angles.push_back(timed(poll));
  }
  ArenaBlock<core::PanFitter> fitter(config, std::size_t{2000});
  return fitter->fit(path_of(move), kStep_rad, angles);
}

core::Outcome<PanFit, PanFitProblem> fit(const Line& line, const PanFitConfig& config = {}) {
  return fit(line.move, line.polls, config);
}

double rms_mdeg(const Line& line, const PanFit& fit) {
  double sum = 0.0;
  int count = 0;
  for (hal::Stamp at = fit.begin(); at < fit.end(); at += std::chrono::milliseconds(5)) {
    sum += std::pow((fit.pan_rad(at) - line.truth.true_rad(at)) / kMilliDegree, 2);
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(PanFit, FindsStartAndSpeedOfALineThroughRoundingAndJitter) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Line line =
        make_line({.slowness = 250e-6, .jitter_s = 0.002, .offset_rad = 0.5 * kStep_rad, .seed = seed});
    const auto found = fit(line);
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    EXPECT_LT(rms_mdeg(line, *found), 12.0) << "seed " << seed;
    EXPECT_NEAR(found->slowness(), 250e-6, 120e-6) << "seed " << seed;
    EXPECT_LT(std::abs(hal::to_seconds(found->begin() - kBegun)), 5e-4) << "seed " << seed;
    EXPECT_EQ(found->polls_left_out(), 0U);
    EXPECT_GT(found->polls_used(), 180U);
  }
}

TEST(PanFit, ReportedSigmaIsThatOfTheError) {
  double sum = 0.0;
  constexpr int kLines = 200;
  for (std::uint64_t seed = 1; seed <= kLines; ++seed) {
    const Line line = make_line({.jitter_s = 0.004, .offset_rad = 0.5 * kStep_rad, .seed = seed});
    const auto found = fit(line);
    ASSERT_TRUE(found.has_value());
    const hal::Stamp at = kBegun + std::chrono::milliseconds(1000);
    sum += std::pow((found->pan_rad(at) - line.truth.true_rad(at)) / found->sigma_rad(at), 2);
  }
  EXPECT_GT(sum / kLines, 0.5);
  EXPECT_LT(sum / kLines, 2.0);
}

TEST(PanFit, PollsInStepWithTheAxisAreNotTrustedMoreThanTheirRounding) {
  const Line line = make_line({.hz = 40.0, .offset_rad = 0.3 * kStep_rad});
  const auto found = fit(line);
  ASSERT_TRUE(found.has_value());
  const hal::Stamp at = kBegun + std::chrono::seconds(2);
  EXPECT_GT(found->sigma_rad(at), 0.2 * kStep_rad);
  EXPECT_LT(std::abs(found->pan_rad(at) - line.truth.true_rad(at)), 3.0 * found->sigma_rad(at));
}

TEST(PanFit, FollowsRampsAboveTheBaseSpeed) {
  const Line line = make_line({.slowness = -200e-6,
                               .jitter_s = 0.001,
                               .speed_radps = 2500.0 * kStep_rad,
                               .base_radps = 300.0 * kStep_rad,
                               .offset_rad = 0.5 * kStep_rad});
  const auto found = fit(line);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(rms_mdeg(line, *found), 25.0);
  EXPECT_EQ(found->speed_radps(found->begin() - std::chrono::seconds(1)), 0.0);
  EXPECT_EQ(found->sigma_rad(found->end() + std::chrono::seconds(1)), 0.0);
}

TEST(PanFit, DelayedPollsAreLeftOut) {
  Line line = make_line({.jitter_s = 0.001, .offset_rad = 0.5 * kStep_rad});
  for (std::size_t i = 10; i < line.polls.size(); i += 6) {
    line.polls[i].stamp += std::chrono::milliseconds(10 + i % 40);
  }
  const auto found = fit(line);
  ASSERT_TRUE(found.has_value());
  EXPECT_GT(found->polls_left_out(), 20U);
  EXPECT_LT(rms_mdeg(line, *found), 12.0);
}

TEST(PanFit, RoundingDownIsTakenIntoAccount) {
  const Line line = make_line({.jitter_s = 0.002});
  const auto naive = fit(line);
  PanFitConfig config;
  config.rounding = PositionRounding::Down;
  const auto found = fit(line, config);
  ASSERT_TRUE(found.has_value() && naive.has_value());
  EXPECT_LT(rms_mdeg(line, *found), 10.0);
  EXPECT_GT(rms_mdeg(line, *naive), 18.0);  // half a position is 25.7
}

TEST(PanFit, RefusesWhatShowsTooLittle) {
  Line line = make_line({});
  line.polls.resize(8);  // the axis has hardly left
  EXPECT_EQ(fit(line).error(), PanFitProblem::TooFewPolls);
  line.polls.clear();
  EXPECT_EQ(fit(line).error(), PanFitProblem::TooFewPolls);
  const hal::MotionProfile none(0.0, 0.0, 1.0, {});
  EXPECT_EQ(fit(none, make_line({}).polls).error(), PanFitProblem::TooFewPolls);
}

TEST(PanFit, RefusesAnAxisThatWasHeldUpOnItsWay) {
  for (const double stall_s : {0.008, 0.05, 0.5}) {
    const auto found = fit(make_line({.jitter_s = 0.001, .stall_rad = 0.3, .stall_s = stall_s}));
    ASSERT_FALSE(found.has_value()) << stall_s;
    EXPECT_NE(found.error(), PanFitProblem::TooFewPolls) << stall_s;
  }
}

TEST(PanFit, RefusesAnAxisThatRanAtAnotherSpeed) {
  EXPECT_EQ(fit(make_line({.slowness = 0.1})).error(), PanFitProblem::WrongSpeed);
}

TEST(PanFit, FewPollsLeanOnWhatIsKnownOfTheClock) {
  const Line line = make_line({.jitter_s = 0.004, .hz = 1.3, .offset_rad = 0.5 * kStep_rad, .seed = 5});
  const auto found = fit(line);
  ASSERT_TRUE(found.has_value());
  EXPECT_LE(found->polls_used(), 7U);
  EXPECT_LT(std::abs(found->slowness()), 300e-6);
}

}  // namespace
}  // namespace slamsensor::firmware
