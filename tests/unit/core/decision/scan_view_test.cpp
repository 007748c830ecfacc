#include "core/decision/scan_view.hpp"

#include "core/config.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace slamsensor::core {
namespace {

Point2 polar(double range_m, double bearing_deg) {
  return {range_m * std::cos(bearing_deg * kDegree), range_m * std::sin(bearing_deg * kDegree)};
}

TEST(ScanView, WithoutAnythingKnownAllIsShown) {
  EXPECT_TRUE(ScanView{}.shows(polar(500.0, 170.0), 0.3));
}

TEST(ScanView, AFieldOfViewAndARangeEndWhatIsShown) {
  ScanView view;
  view.field_of_view_rad = 180.0 * kDegree;
  view.range_m = 40.0;
  EXPECT_TRUE(view.shows(polar(39.0, 89.0), 0.3));
  EXPECT_TRUE(view.shows(polar(39.0, -89.0), 0.3));
  EXPECT_FALSE(view.shows(polar(39.0, 91.0), 0.3));
  EXPECT_FALSE(view.shows(polar(39.0, -91.0), 0.3));
  EXPECT_FALSE(view.shows(polar(41.0, 0.0), 0.3));
}

TEST(ScanView, EachColumnThatTheThingCoversHasToBeFree) {
  std::vector<float> free_m(360, 50.0F);
  free_m[90] = 10.0F;                // a trunk
  free_m[200] = ScanView::kUnknown;  // not looked at
  free_m[0] = 5.0F;                  // on the seam of the circle
  ScanView view;
  view.free_m = free_m;
  EXPECT_TRUE(view.shows(polar(20.0, 60.5), 0.3));
  EXPECT_FALSE(view.shows(polar(50.0, 60.5), 0.3)) << "its far side lies beyond what was seen";
  EXPECT_FALSE(view.shows(polar(20.0, 90.5), 0.3));
  EXPECT_FALSE(view.shows(polar(20.0, 91.5), 0.3)) << "half hidden";
  EXPECT_TRUE(view.shows(polar(20.0, 93.0), 0.3));
  EXPECT_TRUE(view.shows(polar(9.0, 90.5), 0.3));
  EXPECT_FALSE(view.shows(polar(2.0, 200.5), 0.1));
  EXPECT_FALSE(view.shows(polar(20.0, -0.2), 0.3));
  EXPECT_FALSE(view.shows(polar(20.0, 359.8), 0.3));
  EXPECT_TRUE(view.shows(polar(4.0, 0.5), 0.05));
}

}  // namespace
}  // namespace slamsensor::core
