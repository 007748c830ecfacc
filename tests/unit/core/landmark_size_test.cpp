#include "core/landmark_size.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slamsensor::core {
namespace {

TEST(LandmarkSize, IsTheMeanOfTheLogarithms) {
  LandmarkSize size;
  EXPECT_FALSE(size.is_known());
  EXPECT_EQ(size.diameter_m(), 0.0);
  size.add(LandmarkSize::seen(0.2));
  EXPECT_NEAR(size.diameter_m(), 0.2, 1e-7);
  size.add(LandmarkSize::seen(0.8));
  EXPECT_NEAR(size.diameter_m(), 0.4, 1e-7);
  size.add({});  // a sighting that measured none
  EXPECT_NEAR(size.diameter_m(), 0.4, 1e-7);
  EXPECT_EQ(size.sightings, 2.0F);
}

TEST(LandmarkSize, WhatIsNoDiameterIsNotMeasured) {
  for (const double none : {0.0, -0.3, 1e-4, 1e4, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(LandmarkSize::seen(none).is_known()) << none;
  }
}

TEST(LandmarkSize, SightingsHaveErrorsInCommon) {
  EXPECT_NEAR(LandmarkSize::seen(0.3).variance_share(), 1.0, 1e-6);
  EXPECT_NEAR((LandmarkSize{0.0F, 7.0F}.variance_share()), 0.4, 1e-6);
  EXPECT_GT((LandmarkSize{0.0F, 1e6F}.variance_share()), 0.3);
}

TEST(LandmarkSize, FollowsATreeThatGrows) {
  LandmarkSize size;
  for (int i = 0; i < 10'000; ++i) {
    size.add(LandmarkSize::seen(0.2));
  }
  for (int i = 0; i < 300; ++i) {
    size.add(LandmarkSize::seen(0.25));
  }
  EXPECT_NEAR(size.diameter_m(), 0.25, 0.005);
}

TEST(LandmarkSize, AllThatSightingsGiveIsPossible) {
  LandmarkSize size;
  EXPECT_TRUE(size.is_possible());
  for (const double diameter_m : {1e-3, 1e3, 0.3}) {
    EXPECT_TRUE(LandmarkSize::seen(diameter_m).is_possible()) << diameter_m;
    size.add(LandmarkSize::seen(diameter_m));
  }
  EXPECT_TRUE(size.is_possible());
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const LandmarkSize bad :
       {LandmarkSize{0.0F, -1.0F}, LandmarkSize{0.0F, kNan}, LandmarkSize{kNan, 1.0F},
        LandmarkSize{8.0F, 1.0F}, LandmarkSize{-9.0F, 1.0F}, LandmarkSize{0.0F, 1e9F}}) {
    EXPECT_FALSE(bad.is_possible()) << bad.ln_diameter << ' ' << bad.sightings;
  }
}

}  // namespace
}  // namespace slamsensor::core
