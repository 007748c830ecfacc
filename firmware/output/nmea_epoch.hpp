#pragma once

#include "firmware/output/nmea.hpp"
#include "firmware/output/position_error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace slamsensor::firmware {

/// Farthest from the map's origin that a pose is written; a longer number would not fit the sentence.
inline constexpr double kNmeaCoordinateMax_m = 1e6;

/// Whether `fix` has a pose that can be written.
[[nodiscard]] inline bool has_nmea_pose(const core::Fix& fix) noexcept {
  const core::Pose2& pose = fix.pose_W;
  return fix.status != core::FixStatus::NoFix && std::isfinite(pose.heading_rad) &&
         std::abs(pose.x_m) <= kNmeaCoordinateMax_m && std::abs(pose.y_m) <= kNmeaCoordinateMax_m;
}

/// All that the sentences of an epoch share.
struct NmeaEpoch {
  NmeaEpoch(const core::Fix& the_fix, const NmeaContext& the_context) noexcept
      : fix(the_fix),
        context(the_context),
        moment(the_context.moment.value_or(NmeaMoment{.utc = the_fix.time.middle_utc})),
        time(nmea_time(moment.utc)),
        pose_known(has_nmea_pose(the_fix)),
        error_known(usable_covariance(the_fix.covariance)) {
    if (context.geo != nullptr && pose_known && fix.status == core::FixStatus::Fix) {
      place = context.geo->locate(fix.pose_W);
    }
  }

  const core::Fix& fix;
  const NmeaContext& context;
  NmeaMoment moment;
  NmeaTime time;
  bool pose_known;
  bool error_known;
  std::optional<GeoPose> place;  ///< of a fix with a datum: then and only then there is a position to emit
};

/// Appends a 1 sigma error, at most 9999 m.
inline void add_nmea_sigma(NmeaSentence& sentence, double sigma_m, int decimals) noexcept {
  sentence.fixed(std::min(sigma_m, 9999.0), decimals);
}

}  // namespace slamsensor::firmware
