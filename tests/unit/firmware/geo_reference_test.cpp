#include "firmware/output/nmea.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace slamsensor::firmware {
namespace {

/// Metres of a degree of latitude and of longitude on the WGS 84 ellipsoid: an oracle of our own, good to a
/// millimetre over a hundred metres.
std::array<double, 2> metres_per_degree(double latitude_deg) {
  const double a = 6378137.0;
  const double e2 = 6.69437999014e-3;
  const double phi = latitude_deg * core::kDegree;
  const double w = std::sqrt(1.0 - e2 * std::sin(phi) * std::sin(phi));
  return {a * (1.0 - e2) / (w * w * w) * core::kDegree, a / w * std::cos(phi) * core::kDegree};
}

TEST(GeoReference, OriginIsTheDatum) {
  const GeoReference geo(Datum{47.4520576, 8.57757202, 412.35, 30.0});
  const GeoPose place = geo.locate({});
  EXPECT_NEAR(place.latitude_deg, 47.4520576, 1e-12);
  EXPECT_NEAR(place.longitude_deg, 8.57757202, 1e-12);
  EXPECT_NEAR(place.height_m, 412.35, 1e-6);
  EXPECT_NEAR(place.true_heading_deg, 30.0, 1e-9);
}

TEST(GeoReference, AxesPointWhereTheBearingSays) {
  const auto [north_m, east_m] = metres_per_degree(47.0);
  struct Case {
    double bearing_deg, x_m, y_m, north_m, east_m;
  };
  const Case cases[] = {
      {90.0, 100.0, 0.0, 0.0, 100.0}, {90.0, 0.0, 100.0, 100.0, 0.0},   {0.0, 100.0, 0.0, 100.0, 0.0},
      {0.0, 0.0, 100.0, 0.0, -100.0}, {270.0, 100.0, 0.0, 0.0, -100.0}, {180.0, 0.0, 100.0, 0.0, 100.0},
  };
  for (const Case& c : cases) {
    const GeoReference geo(Datum{47.0, 8.0, 0.0, c.bearing_deg});
    const GeoPose place = geo.locate({c.x_m, c.y_m, 0.0});
    EXPECT_NEAR((place.latitude_deg - 47.0) * north_m, c.north_m, 2e-3) << c.bearing_deg;
    EXPECT_NEAR((place.longitude_deg - 8.0) * east_m, c.east_m, 2e-3) << c.bearing_deg;
  }
}

// Counter-clockwise from x in the map is clockwise from north on the earth: true = bearing of x - heading.
TEST(GeoReference, HeadingTurnsRoundAtTheEdge) {
  const double headings_deg[] = {0.0, 10.0, 90.0, 179.0, -90.0, -179.9};
  for (const double bearing_deg : {0.0, 45.0, 90.0, 359.0}) {
    const GeoReference geo(Datum{47.0, 8.0, 0.0, bearing_deg});
    for (const double heading_deg : headings_deg) {
      double expected_deg = std::fmod(bearing_deg - heading_deg + 720.0, 360.0);
      const double actual_deg = geo.locate({0.0, 0.0, heading_deg * core::kDegree}).true_heading_deg;
      EXPECT_GE(actual_deg, 0.0);
      EXPECT_LT(actual_deg, 360.0);
      EXPECT_NEAR(std::remainder(actual_deg - expected_deg, 360.0), 0.0, 1e-9)
          << bearing_deg << ' ' << heading_deg;
    }
  }
}

// The north of a place 10 km east of the datum is not the datum's: the meridians converge by distance
// tan(latitude) / R.
TEST(GeoReference, HeadingIsThatOfThePlacesOwnNorth) {
  const GeoReference geo(Datum{60.0, 8.0, 0.0, 90.0});
  const GeoPose place = geo.locate({10'000.0, 0.0, 0.0});
  const double convergence_deg = 10'000.0 / 6.3945e6 * std::tan(60.0 * core::kDegree) / core::kDegree;
  EXPECT_NEAR(place.true_heading_deg, 90.0 + convergence_deg, 1e-3);
}

TEST(GeoReference, CrossesTheDateLine) {
  const GeoReference geo(Datum{-17.0, 179.9999, 0.0, 90.0});
  const GeoPose place = geo.locate({1000.0, 0.0, 0.0});
  EXPECT_LT(place.longitude_deg, -179.98);
  EXPECT_GE(place.longitude_deg, -180.0);
}

TEST(GeoReference, APoseThatIsNotFiniteGivesNothingThatLooksLikeAPlace) {
  const GeoReference geo(Datum{47.0, 8.0, 0.0, 90.0});
  const GeoPose place = geo.locate({std::nan(""), 0.0, 0.0});
  EXPECT_FALSE(std::isfinite(place.latitude_deg) && std::isfinite(place.longitude_deg));
}

TEST(PositionError, EllipseOfACovariance) {
  Eigen::Matrix2d covariance;
  covariance << 0.04, 0.0, 0.0, 0.01;  // 0.2 m east, 0.1 m north
  PositionError error = position_error(covariance);
  EXPECT_NEAR(error.east_m, 0.2, 1e-12);
  EXPECT_NEAR(error.north_m, 0.1, 1e-12);
  EXPECT_NEAR(error.major_m, 0.2, 1e-12);
  EXPECT_NEAR(error.minor_m, 0.1, 1e-12);
  EXPECT_NEAR(error.major_bearing_deg, 90.0, 1e-9);

  // Turned so that the major axis has bearing 30 deg.
  const double b = 30.0 * core::kDegree;
  Eigen::Matrix2d axes;  // columns: along the bearing, and to its right, in (east, north)
  axes << std::sin(b), std::cos(b), std::cos(b), -std::sin(b);
  covariance = axes * Eigen::Vector2d(0.04, 0.01).asDiagonal() * axes.transpose();
  error = position_error(covariance);
  EXPECT_NEAR(error.major_m, 0.2, 1e-12);
  EXPECT_NEAR(error.minor_m, 0.1, 1e-12);
  EXPECT_NEAR(error.major_bearing_deg, 30.0, 1e-9);
}

TEST(PositionError, KnowsACovarianceThatCannotBeUsed) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  EXPECT_TRUE(usable_covariance(covariance));
  EXPECT_TRUE(usable_covariance(Eigen::Matrix3d::Zero()));
  covariance(2, 2) = -1e-9;
  EXPECT_FALSE(usable_covariance(covariance));
  covariance(2, 2) = std::nan("");
  EXPECT_FALSE(usable_covariance(covariance));
  EXPECT_NEAR(position_error(Eigen::Matrix2d::Zero()).major_m, 0.0, 0.0);
}

}  // namespace
}  // namespace slamsensor::firmware
