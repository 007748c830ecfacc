#pragma once

#include "core/geometry/pose2.hpp"
#include "firmware/config/sensor_config.hpp"
#include "firmware/output/nmea.hpp"

#include <GeographicLib/LocalCartesian.hpp>

namespace slamsensor::tools {

/// A place on the earth (WGS 84), deg.
struct EarthPoint {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

/// Points of the map's plane W and places on the earth, in both directions; each is the other's inverse
/// within a millimetre as far as a map reaches (65 km).
class MapEarth {
 public:
  explicit MapEarth(const firmware::Datum& datum);

  [[nodiscard]] EarthPoint on_earth(const core::Point2& point_W) const;
  /// Clockwise from true north at the place, [0, 360) deg.
  [[nodiscard]] double true_heading_deg(const core::Pose2& pose_W) const;
  [[nodiscard]] core::Point2 in_map(const EarthPoint& place) const;

  [[nodiscard]] const firmware::Datum& datum() const { return reference_.datum(); }

 private:
  firmware::GeoReference reference_;
  GeographicLib::LocalCartesian plane_;  // east, north, up at the datum
};

}  // namespace slamsensor::tools
