#include "tools/world/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slamsensor::tools {
namespace {

TEST(Random, EngineAndUnitDrawsAreThoseOfTheStandard) {
  Random rng;  // the standard fixes the 10000th value of a default engine
  rng.discard(9999);
  EXPECT_EQ(rng(), 9981545732273789042ULL);
  EXPECT_EQ(to_unit(0), 0.0);
  EXPECT_EQ(to_unit(1ULL << 63U), 0.5);
  EXPECT_LT(to_unit(std::numeric_limits<std::uint64_t>::max()), 1.0);
}

TEST(Random, SeedsAreMixedAsInSplitmix64) {
  EXPECT_EQ(mix_seed(0, 0), 0xE220A8397B1DCDAFULL);  // its published first output for seed 0
  EXPECT_NE(mix_seed(1, 2), mix_seed(2, 1));
}

TEST(Random, NormalHasMomentsOfTheNormalDistribution) {
  constexpr int kDraws = 400'000;
  Random rng(11);
  double sum = 0.0;
  double sum2 = 0.0;
  double sum4 = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double z = draw_normal(rng);
    sum += z;
    sum2 += z * z;
    sum4 += z * z * z * z;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.007);
  EXPECT_NEAR(sum2 / kDraws, 1.0, 0.01);
  EXPECT_NEAR(sum4 / kDraws, 3.0, 0.08);
}

TEST(Random, FreePathIsExponential) {
  EXPECT_EQ(free_path_m(0.0, 2.0), 0.0);
  EXPECT_NEAR(free_path_m(0.5, 2.0), std::log(2.0) / 2.0, 1e-15);
  EXPECT_TRUE(std::isinf(free_path_m(0.5, 0.0)));
}

}  // namespace
}  // namespace slamsensor::tools
