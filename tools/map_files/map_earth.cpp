#include "tools/map_files/map_earth.hpp"

#include <cmath>

namespace slamsensor::tools {

MapEarth::MapEarth(const firmware::Datum& datum)
    : reference_(datum), plane_(datum.latitude_deg, datum.longitude_deg, datum.height_m) {
}

EarthPoint MapEarth::on_earth(const core::Point2& point_W) const {
  const firmware::GeoPose place = reference_.locate({point_W.x(), point_W.y(), 0.0});
  return {place.latitude_deg, place.longitude_deg};
}

double MapEarth::true_heading_deg(const core::Pose2& pose_W) const {
  return reference_.locate(pose_W).true_heading_deg;
}

core::Point2 MapEarth::in_map(const EarthPoint& place) const {
  // The plane lies above the ellipsoid away from the datum: the height at which the place's vertical meets
  // the plane is found by steps, each of which leaves less than a thousandth of the error.
  constexpr int kSteps = 4;
  double east_m = 0.0;
  double north_m = 0.0;
  double up_m = 0.0;
  double height_m = datum().height_m;
  for (int i = 0; i < kSteps; ++i) {
    plane_.Forward(place.latitude_deg, place.longitude_deg, height_m, east_m, north_m, up_m);
    height_m -= up_m;
  }
  const double bearing_rad = datum().bearing_deg * core::kDegree;
  const double sine = std::sin(bearing_rad);
  const double cosine = std::cos(bearing_rad);
  return {east_m * sine + north_m * cosine, -east_m * cosine + north_m * sine};
}

}  // namespace slamsensor::tools
