#pragma once

#include "firmware/output/nmea_epoch.hpp"
#include "firmware/output/nmea_sentence.hpp"

namespace slamsensor::firmware {

/// The detail at which the pose sentence has all of its decimals; at 0 it fits whatever it says.
inline constexpr int kNmeaPoseDetailMax = 10;

/// The proprietary sentence of the pose in the map frame, as format_nmea describes it, with `detail` (0 to
/// kNmeaPoseDetailMax).
[[nodiscard]] NmeaSentence nmea_pose_sentence(const NmeaEpoch& epoch, int detail) noexcept;

}  // namespace slamsensor::firmware
