#include "tools/map_files/map_earth.hpp"

#include <GeographicLib/Geodesic.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr firmware::Datum kDatum{-35.2784, 149.1164, 560.0, 33.5};

TEST(MapEarth, ThereAndBackIsTheSamePlaceAsFarAsAMapReaches) {
  const MapEarth earth(kDatum);
  for (const double range_m : {0.0, 10.0, 1e3, 2e4, 6e4}) {
    for (int i = 0; i < 12; ++i) {
      const double angle = 0.5 * i;
      const core::Point2 point_W(range_m * std::cos(angle), range_m * std::sin(angle));
      const core::Point2 back_W = earth.in_map(earth.on_earth(point_W));
      EXPECT_LT((back_W - point_W).norm(), 1e-3) << range_m << " m at " << angle;
    }
  }
}

TEST(MapEarth, XPointsTowardsTheBearingAndYToItsLeft) {
  firmware::Datum datum = kDatum;
  datum.height_m = 0.0;  // geodesics run on the ellipsoid
  const MapEarth earth(datum);
  const GeographicLib::Geodesic& geodesic = GeographicLib::Geodesic::WGS84();
  const auto at = [&](double azimuth_deg, double range_m) {
    EarthPoint place;
    geodesic.Direct(datum.latitude_deg, datum.longitude_deg, azimuth_deg, range_m, place.latitude_deg,
                    place.longitude_deg);
    return earth.in_map(place);
  };
  EXPECT_LT((at(kDatum.bearing_deg, 500.0) - core::Point2(500.0, 0.0)).norm(), 1e-3);
  EXPECT_LT((at(kDatum.bearing_deg - 90.0, 500.0) - core::Point2(0.0, 500.0)).norm(), 1e-3);
  EXPECT_NEAR(earth.true_heading_deg({0.0, 0.0, 0.0}), kDatum.bearing_deg, 1e-9);
}

}  // namespace
}  // namespace slamsensor::tools
