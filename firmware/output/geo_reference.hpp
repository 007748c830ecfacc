#pragma once

#include "core/geometry/pose2.hpp"
#include "firmware/config/config.hpp"

#include <Eigen/Core>
#include <GeographicLib/LocalCartesian.hpp>

namespace slamsensor::firmware {

/// A pose of the map frame W on the earth (WGS 84).
struct GeoPose {
  double latitude_deg = 0.0;   ///< [-90, 90]
  double longitude_deg = 0.0;  ///< [-180, 180]
  double height_m = 0.0;       ///< of the point of the map's plane above the ellipsoid
  double true_heading_deg =
      0.0;  ///< of the sensor's x' axis, clockwise from true north at the place, [0, 360)
  Eigen::Matrix2d R_EN_W =
      Eigen::Matrix2d::Identity();  ///< takes plane vectors in W to (east, north) at the place
};

/// Places the map on the earth: W is the plane that touches the datum's height surface at its latitude and
/// longitude, x towards the datum's true bearing, y 90 deg to its left, z up. Immutable, so any thread may
/// use it.
class GeoReference {
 public:
  explicit GeoReference(const Datum& datum);

  /// Where on the earth `T_W_L` is. East and north are those of the place, not of the datum: over a map of
  /// kilometres the meridians converge. Allocates nothing. A pose that is not finite gives values that are
  /// not finite.
  [[nodiscard]] GeoPose locate(const core::Pose2& T_W_L) const noexcept;

  [[nodiscard]] const Datum& datum() const noexcept { return datum_; }

 private:
  Datum datum_;
  GeographicLib::LocalCartesian plane_;  ///< east, north, up at the datum
  Eigen::Matrix2d R_plane_W_;            ///< map axes to the datum's (east, north)
  Eigen::Matrix3d R_earth_plane_;        ///< the datum's (east, north, up) to earth-centred axes
};

}  // namespace slamsensor::firmware
