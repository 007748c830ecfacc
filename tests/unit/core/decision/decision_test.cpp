#include "core/decision/decision.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace slamsensor::core {
namespace {

constexpr double kStructure = 8.0;  // of a world that may repeat itself
constexpr MapSlot kHome = 2;
constexpr MapSlot kOther = 5;

/// A place of the home map that all speaks for.
Weighed good(double x_m = 0.0, double decades = 20.0) {
  Weighed w;
  w.candidate.map = kHome;
  w.candidate.pose_W = {x_m, 0.0, 0.3};
  for (std::uint32_t i = 0; i < 15; ++i) {
    EXPECT_TRUE(w.candidate.matches.try_push_back({i, i}));
  }
  w.evidence.ln_bayes = decades * std::numbers::ln10;
  w.evidence.group_decades = w.evidence.small_group_decades = 6.0;
  w.evidence.log10_unmatched = -0.3;
  w.evidence.log10_missing = -0.3;
  w.evidence.covariance = Eigen::Vector3d(0.01, 0.01, 1e-5).asDiagonal();
  return w;
}

void set_groups(Weighed& w, double decades) {
  w.evidence.group_decades = w.evidence.small_group_decades = decades;
}

Verdict judge(const std::vector<Weighed>& weighed, Stake stake = Stake::Fix, double structure = kStructure) {
  return decide(weighed, kHome, stake, SearchEnd::Complete, structure, {});
}

TEST(Decide, WhatAllSpeaksForIsAFix) {
  const Verdict verdict = judge({good()});
  EXPECT_EQ(verdict.status, FixStatus::Fix);
  EXPECT_EQ(verdict.reason, FixReason::None);
  EXPECT_EQ(verdict.chosen, 0U);
  EXPECT_NEAR(verdict.log10_expected_wrong, -20.0, 1e-9);
}

TEST(Decide, NothingFoundIsNoOverlapOrTheDeadline) {
  EXPECT_EQ(judge({}).reason, FixReason::NoOverlap);
  EXPECT_EQ(judge({}).chosen, SIZE_MAX);
  EXPECT_EQ(decide({}, kHome, Stake::Fix, SearchEnd::Deadline, kStructure, {}).reason, FixReason::Deadline);
}

TEST(Decide, ChanceIsNoOverlap) {
  const Verdict verdict = judge({good(0.0, 5.0)});  // the risk is a millionth
  EXPECT_EQ(verdict.status, FixStatus::NoFix);
  EXPECT_EQ(verdict.reason, FixReason::NoOverlap);
  EXPECT_EQ(judge({good(0.0, 7.0)}).status, FixStatus::Fix);
}

TEST(Decide, APoseThatIsNotPreciseIsNoFix) {
  Weighed loose = good();
  loose.evidence.covariance(1, 1) = 0.2;
  EXPECT_EQ(judge({loose}).reason, FixReason::TooFewLandmarks);
  Weighed turned = good();
  turned.evidence.covariance(2, 2) = 1e-3;
  EXPECT_EQ(judge({turned}).reason, FixReason::TooFewLandmarks);
}

// A copse and its twin that was never mapped: however well it matches, one group says nothing of the world
// about it.
TEST(Decide, OneGroupIsACopyThatWasNeverMapped) {
  Weighed copse = good(0.0, 60.0);
  set_groups(copse, 0.0);
  for (const double structure : {2.0, kStructure, 20.0}) {
    const Verdict verdict = judge({copse}, Stake::Fix, structure);
    EXPECT_EQ(verdict.status, FixStatus::Ambiguous) << structure;
    EXPECT_EQ(verdict.reason, FixReason::Copy) << structure;
    EXPECT_EQ(judge({copse}, Stake::Again, structure).status, FixStatus::Ambiguous) << structure;
  }
}

TEST(Decide, ContradictionsWeighAgainstGroups) {
  Weighed contradicted = good();
  set_groups(contradicted, 4.0);
  EXPECT_EQ(judge({contradicted}).status, FixStatus::Fix);
  contradicted.evidence.log10_unmatched = -4.0;
  EXPECT_EQ(judge({contradicted}).reason, FixReason::Copy);
}

// Row 2 of a car park shows what row 1 showed: to have just been there is no reason to be still there.
TEST(Decide, WhatIsSeenAgainHasRivalsAndTheConfiguredRiskAllTheSame) {
  EXPECT_EQ(judge({good(0.0, 30.0), good(10.0, 28.0)}, Stake::Again).reason, FixReason::Symmetric);
  EXPECT_EQ(judge({good(0.0, 5.0)}, Stake::Again).reason, FixReason::NoOverlap);
  Weighed two_groups = good();
  set_groups(two_groups, 1.0);
  EXPECT_EQ(judge({two_groups}, Stake::Again).status, FixStatus::Fix);
  EXPECT_EQ(judge({two_groups}, Stake::Fix).reason, FixReason::Copy);
  two_groups.evidence.log10_unmatched = -1.0;  // the first scan at the second of two copses alike
  EXPECT_EQ(judge({two_groups}, Stake::Again).reason, FixReason::Copy);
}

TEST(Decide, AMapThatBeganWhereAnotherWasLeftIsTiedByTwoGroups) {
  Weighed two_groups = good();
  set_groups(two_groups, 2.0);
  EXPECT_EQ(judge({two_groups}, Stake::Follow).status, FixStatus::Fix);
  EXPECT_EQ(judge({two_groups}, Stake::Tie).reason, FixReason::Copy);
  EXPECT_NE(judge({good(0.0, 8.0)}, Stake::Follow).status, FixStatus::Fix) << "a tie binds many scans";
}

// What goes on where it was just seen counts the groups of a short reach. What was lost and comes back does
// not, but where the world does not repeat itself.
TEST(Decide, AShortReachGoesOnWithSmallGroups) {
  Weighed near = good();
  set_groups(near, 0.0);
  near.evidence.small_group_decades = 1.0;
  EXPECT_EQ(judge({near}, Stake::Again).status, FixStatus::Fix);
  EXPECT_EQ(judge({near}, Stake::Follow).status, FixStatus::Fix);
  near.evidence.small_group_decades = 2.0;
  EXPECT_EQ(judge({near}, Stake::Fix).reason, FixReason::Copy);
  EXPECT_EQ(judge({near}, Stake::Tie).reason, FixReason::Copy);
  EXPECT_EQ(judge({near}, Stake::Fix, 6.9).status, FixStatus::Fix) << "13 decades beyond wrong places";
}

// Two gardens alike in different surroundings: the copy explains the map of one by a hundred decades, and a
// third of its landmarks is not there.
TEST(Decide, ATieThatAThirdContradictsIsNoTie) {
  Weighed garden = good(0.0, 107.0);
  EXPECT_EQ(judge({garden}, Stake::Tie, 6.9).status, FixStatus::Fix);
  garden.evidence.log10_unmatched = -3.0;
  for (const Stake stake : {Stake::Tie, Stake::Follow}) {
    EXPECT_EQ(judge({garden}, stake, 6.9).reason, FixReason::NoOverlap);
  }
}

TEST(Rates, ManyScansOfOneCopseSayNoMoreOfTheWorldThanOne) {
  Rates rates;
  const double before = rates.structure_decades;
  for (int i = 0; i < 1000; ++i) {
    rates.see_runner_up(0.0, 0.0);
  }
  EXPECT_EQ(rates.structure_decades, before);
  for (int i = 0; i < 50; ++i) {
    rates.see_runner_up(0.0, 1.0);
  }
  EXPECT_LT(rates.structure_decades, 6.0);
  rates.see_runner_up(30.0, 0.0);  // also of a scan that was not believed
  EXPECT_GT(rates.structure_decades, 7.0);
}

TEST(Decide, ATwinThatWasMappedMakesItAmbiguous) {
  const Verdict verdict = judge({good(0.0, 20.0), good(50.0, 19.9)});
  EXPECT_EQ(verdict.status, FixStatus::Ambiguous);
  EXPECT_EQ(verdict.reason, FixReason::Symmetric);
  EXPECT_EQ(verdict.chosen, 0U);
  // Though the odds are clear, what is missing at the other place may be new ground here.
  EXPECT_EQ(judge({good(0.0, 30.0), good(50.0, 16.0)}).reason, FixReason::Symmetric);
  EXPECT_EQ(judge({good(0.0, 30.0), good(50.0, 5.0)}).status, FixStatus::Fix);
  EXPECT_EQ(judge({good(0.0, 20.0), good(0.3, 19.9)}).status, FixStatus::Fix) << "the same place is no rival";
}

TEST(Decide, ARivalThatIsContradictedIsNone) {
  Weighed rival = good(50.0, 12.0);
  EXPECT_EQ(judge({good(), rival}).status, FixStatus::Ambiguous);
  rival.evidence.log10_unmatched = -2.0;
  EXPECT_EQ(judge({good(), rival}).status, FixStatus::Fix);
}

TEST(Decide, APlaceTurnedAtTheSpotIsARival) {
  Weighed turned = good(0.0, 19.9);
  turned.candidate.pose_W.heading_rad += std::numbers::pi;
  EXPECT_EQ(judge({good(), turned}).reason, FixReason::Symmetric);
}

// Another map may hold the same place: where the world repeats itself it is a rival.
TEST(Decide, AnotherMapIsARivalWhereTheWorldRepeatsItself) {
  Weighed other = good(0.0, 25.0);
  other.candidate.map = kOther;
  EXPECT_EQ(judge({good(), other}).status, FixStatus::Ambiguous);
  EXPECT_EQ(judge({good(), other}).chosen, 0U) << "what is chosen lies in the map that was asked for";
  EXPECT_EQ(judge({good(), other}, Stake::Fix, 3.0).status, FixStatus::Fix);
}

// Unless an earlier scan said that both places are one, and nothing was seen to repeat itself since the
// start.
TEST(Decide, AnotherMapIsNoRivalWhereItLiesSoThatBothPlacesAreOne) {
  Weighed other = good(0.0, 25.0);
  other.candidate.map = kOther;
  other.is_same_place = true;
  EXPECT_EQ(judge({good(), other}, Stake::Fix, Rates::kStartStructure).status, FixStatus::Fix);
  EXPECT_EQ(judge({good(), other}, Stake::Fix, Rates::kStartStructure + 0.1).status, FixStatus::Ambiguous);
  Weighed elsewhere_in_home = good(50.0, 25.0);
  EXPECT_EQ(judge({elsewhere_in_home, good(), other}).status, FixStatus::Ambiguous);
}

// A place that is visited in turns with another had maps of single scans beside home, each of them a rival
// for good.
TEST(Decide, AMapThatExplainsFarLessIsNoRival) {
  Weighed other = good(0.0, 29.0);
  other.candidate.map = kOther;
  EXPECT_EQ(judge({good(0.0, 40.0), other}).status, FixStatus::Fix);
  EXPECT_EQ(judge({good(0.0, 38.0), other}).status, FixStatus::Ambiguous);
}

// Posts about a roundabout: a local map was tied to home, turned by 180 degrees, though another local map
// explained it better.
TEST(Decide, AMapThatExplainsItBetterForbidsATieWhereTheWorldRepeatsItself) {
  Weighed other = good(0.0, 45.0);
  other.candidate.map = kOther;
  EXPECT_EQ(judge({good(0.0, 40.0), other}, Stake::Tie, 20.0).status, FixStatus::Ambiguous);
  EXPECT_EQ(judge({good(0.0, 40.0), other}, Stake::Follow, 20.0).status, FixStatus::Ambiguous);
  EXPECT_EQ(judge({good(0.0, 46.0), other}, Stake::Tie, 20.0).status, FixStatus::Fix);
  EXPECT_EQ(judge({good(0.0, 40.0), other}, Stake::Tie, 3.0).status, FixStatus::Fix)
      << "a world without copies";
}

// Scans of plantations were fixes 79 and 33 m from where they were: 13.0 and 44.5 decades, where wrong places
// of those maps had reached 13.3 and 36.3.
TEST(Decide, WhereTheWorldRepeatsItselfAFixExplainsMoreThanWrongPlacesDo) {
  EXPECT_EQ(judge({good(0.0, 13.0)}, Stake::Fix, 13.3).reason, FixReason::Symmetric);
  EXPECT_EQ(judge({good(0.0, 44.5)}, Stake::Fix, 36.3).reason, FixReason::Symmetric);
  EXPECT_EQ(judge({good(0.0, 17.0)}, Stake::Fix, 13.3).status, FixStatus::Fix);
  EXPECT_EQ(judge({good(0.0, 13.0)}, Stake::Again, 13.3).status, FixStatus::Fix) << "seen just before";
  EXPECT_EQ(judge({good(0.0, 7.0)}, Stake::Fix, Rates::kStartStructure).status, FixStatus::Fix)
      << "nothing is known of this world yet";
}

TEST(Decide, ALocalMapBindsNothingAndAsksForLess) {
  Weighed copse = good(0.0, 6.0);
  set_groups(copse, 0.0);
  copse.evidence.covariance(1, 1) = 0.2;
  EXPECT_EQ(judge({copse}, Stake::Local).status, FixStatus::Fix);
  copse.evidence.log10_missing = -5.0;
  EXPECT_EQ(judge({copse}, Stake::Local).reason, FixReason::NoOverlap);
  EXPECT_EQ(judge({good(0.0, 3.0)}, Stake::Local).reason, FixReason::NoOverlap);
  EXPECT_EQ(judge({good(), good(50.0, 19.9)}, Stake::Local).status, FixStatus::Ambiguous);
}

TEST(Decide, ATieAsksForMoreThanAFix) {
  EXPECT_EQ(judge({good(0.0, 8.0)}).status, FixStatus::Fix);
  EXPECT_EQ(judge({good(0.0, 8.0)}, Stake::Tie).status, FixStatus::NoFix);
  Weighed contradicted = good();
  contradicted.evidence.log10_missing = -2.5;
  EXPECT_EQ(judge({contradicted}).status, FixStatus::Fix);
  EXPECT_EQ(judge({contradicted}, Stake::Tie).status, FixStatus::NoFix);
}

TEST(Decide, TheLikelierPlaceOfTheMapIsChosenWhereverItStands) {
  const std::vector<Weighed> weighed{good(50.0, 3.0), good(0.0, 20.0), good(90.0, 4.0)};
  EXPECT_EQ(judge(weighed).chosen, 1U);
  EXPECT_NEAR(runner_up_decades(weighed, 1, {}), 4.0, 1e-9);
  EXPECT_EQ(runner_up_decades(std::vector<Weighed>{good()}, 0, {}), 0.0);
}

TEST(Decide, PositionSigmaIsThatOfTheLongerAxis) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance.topLeftCorner<2, 2>() << 2.5, 1.5, 1.5, 2.5;  // axes of 4 and 1 at 45 degrees
  EXPECT_NEAR(position_sigma_m(covariance), 2.0, 1e-12);
}

}  // namespace
}  // namespace slamsensor::core
