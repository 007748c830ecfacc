#include "firmware/output/geo_reference.hpp"

#include <cmath>

namespace slamsensor::firmware {
namespace {

/// Columns: east, north and up at a place, in earth-centred axes.
Eigen::Matrix3d east_north_up(double latitude_deg, double longitude_deg) {
  const double phi = latitude_deg * core::kDegree;
  const double lambda = longitude_deg * core::kDegree;
  Eigen::Matrix3d axes;
  axes.col(0) << -std::sin(lambda), std::cos(lambda), 0.0;
  axes.col(1) << -std::sin(phi) * std::cos(lambda), -std::sin(phi) * std::sin(lambda), std::cos(phi);
  axes.col(2) << std::cos(phi) * std::cos(lambda), std::cos(phi) * std::sin(lambda), std::sin(phi);
  return axes;
}

/// Map axes in (east, north), x at a true bearing (clockwise from north) and y at its left.
Eigen::Matrix2d map_axes(double bearing_deg) {
  const double beta = bearing_deg * core::kDegree;
  Eigen::Matrix2d axes;
  axes.col(0) << std::sin(beta), std::cos(beta);
  axes.col(1) << -std::cos(beta), std::sin(beta);
  return axes;
}

/// True bearing of a vector in (east, north), in [0, 360).
double bearing_deg(const Eigen::Vector2d& direction_EN) {
  const double bearing = std::atan2(direction_EN.x(), direction_EN.y()) / core::kDegree;
  const double positive = bearing < 0.0 ? bearing + 360.0 : bearing;
  return positive >= 360.0 ? 0.0 : positive;
}

}  // namespace

GeoReference::GeoReference(const Datum& datum)
    : datum_(datum),
      plane_(datum.latitude_deg, datum.longitude_deg, datum.height_m),
      R_plane_W_(map_axes(datum.bearing_deg)),
      R_earth_plane_(east_north_up(datum.latitude_deg, datum.longitude_deg)) {
}

GeoPose GeoReference::locate(const core::Pose2& T_W_L) const noexcept {
  const Eigen::Vector2d p_plane = R_plane_W_ * T_W_L.translation();
  GeoPose place;
  plane_.Reverse(p_plane.x(), p_plane.y(), 0.0, place.latitude_deg, place.longitude_deg, place.height_m);
  const Eigen::Matrix3d R_earth_EN = east_north_up(place.latitude_deg, place.longitude_deg);
  const Eigen::Matrix3d R_EN_plane = R_earth_EN.transpose() * R_earth_plane_;
  place.R_EN_W = R_EN_plane.topLeftCorner<2, 2>() * R_plane_W_;
  const Eigen::Vector2d forward_W(std::cos(T_W_L.heading_rad), std::sin(T_W_L.heading_rad));
  place.true_heading_deg = bearing_deg(place.R_EN_W * forward_W);
  return place;
}

}  // namespace slamsensor::firmware
