#include "tools/plot/label_placer.hpp"

#include <gtest/gtest.h>

#include <random>

namespace slamsensor::tools {
namespace {

constexpr Box kFrame{10.0, 20.0, 410.0, 320.0};

LabelRequest request_at(double x, double y, double width = 20.0) {
  LabelRequest request;
  request.anchor_px = {x, y};
  request.width_px = width;
  request.height_px = 9.0;
  request.gap_px = 5.0;
  return request;
}

TEST(LabelPlacer, PlacesUpAndToTheRightWhereAllIsFree) {
  LabelPlacer placer(kFrame);
  const auto box = placer.place(request_at(200.0, 200.0));
  ASSERT_TRUE(box);
  EXPECT_GT(box->left, 200.0);
  EXPECT_LT(box->bottom, 200.0);
  EXPECT_DOUBLE_EQ(box->width(), 20.0);
}

TEST(LabelPlacer, NoTwoLabelsOverlapAndAllAreInTheFrame) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    LabelPlacer placer(kFrame);
    std::vector<Box> placed;
    for (int i = 0; i < 400; ++i) {
      LabelRequest request = request_at(uniform(0.0, 420.0), uniform(10.0, 330.0), uniform(5.0, 50.0));
      request.tolerated_from = static_cast<Obstacle>(random() % 4);
      request.rings = 1 + static_cast<int>(random() % 5);
      if (const auto box = placer.place(request)) placed.push_back(*box);
    }
    EXPECT_GT(placed.size(), 50U) << "seed " << seed;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      EXPECT_TRUE(kFrame.contains(placed[i])) << "seed " << seed;
      for (std::size_t j = 0; j < i; ++j) ASSERT_FALSE(placed[i].overlaps(placed[j])) << "seed " << seed;
    }
  }
}

TEST(LabelPlacer, KeepsOffAnObstacleWhileThereIsAnotherPlace) {
  LabelPlacer placer(kFrame);
  const Box obstacle{200.0, 100.0, 300.0, 199.0};
  placer.block(obstacle, Obstacle::Cross);
  const auto box = placer.place(request_at(200.0, 200.0));
  ASSERT_TRUE(box);
  EXPECT_FALSE(box->overlaps(obstacle));
}

TEST(LabelPlacer, StandsOnWhatIsToleratedOnlyWhenItMust) {
  LabelPlacer placer(kFrame);
  placer.block(kFrame, Obstacle::Line);
  EXPECT_FALSE(placer.place(request_at(200.0, 200.0))) << "tolerates crosses only";
  LabelRequest request = request_at(200.0, 200.0);
  request.tolerated_from = Obstacle::Line;
  EXPECT_TRUE(placer.place(request));
}

TEST(LabelPlacer, NeverStandsOnALabel) {
  LabelPlacer placer(kFrame);
  placer.block(kFrame, Obstacle::Label);
  LabelRequest request = request_at(200.0, 200.0);
  request.tolerated_from = Obstacle::Label;
  EXPECT_FALSE(placer.place(request));
}

TEST(LabelPlacer, GoesFartherOutWhenAskedTo) {
  LabelPlacer placer(kFrame);
  const Box blocked = box_around({200.0, 200.0}, 40.0);
  placer.block(blocked, Obstacle::Label);
  LabelRequest request = request_at(200.0, 200.0);
  EXPECT_FALSE(placer.place(request));
  request.rings = 20;
  const auto box = placer.place(request);
  ASSERT_TRUE(box);
  EXPECT_FALSE(box->overlaps(blocked));
}

TEST(LabelPlacer, KeepsOffALine) {
  LabelPlacer placer(kFrame);
  placer.block_line({100.0, 100.0}, {300.0, 300.0});
  const auto box = placer.place(request_at(200.0, 200.0));
  ASSERT_TRUE(box);
  for (double t = 0.0; t <= 1.0; t += 0.001) {
    const double at = 100.0 + 200.0 * t;
    EXPECT_FALSE(box->overlaps(box_around({at, at}, 0.1)));
  }
}

TEST(LabelPlacer, ALabelTooLargeForTheFrameHasNoPlace) {
  LabelPlacer placer(kFrame);
  EXPECT_FALSE(placer.place(request_at(200.0, 200.0, 500.0)));
}

}  // namespace
}  // namespace slamsensor::tools
