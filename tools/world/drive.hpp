#pragma once

#include "core/geometry/pose2.hpp"
#include "tools/world/world.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <vector>

namespace slamsensor::tools {

/// A place at which the sensor makes a scan, and when that scan starts.
struct Stand {
  core::Pose2 pose;  ///< T_W_L of the levelled sensor
  double time_s = 0.0;
};

/// A drive through a world, from stand to stand.
struct DriveConfig {
  std::uint32_t stands = 20;
  double step_m = 5.0;          ///< from a stand to the next
  double turn_sigma_rad = 0.3;  ///< of the change of heading at a stand; wider where the way ahead is blocked
  double clearance_m =
      1.0;                 ///< kept to every stem, bush, rock, post and wall, at the stands and between them
  double margin_m = 10.0;  ///< kept to the edge of the area
  double kidnap_share =
      0.0;  ///< chance that the sensor is carried to within a step of an earlier stand instead
  double period_s = 300.0;  ///< from the start of a scan to the start of the next
};

/// The stands of the world's file in their order when it names any, else a random walk: every stand is
/// `step_m` from the one before in the direction of its own heading, with a clear way between them, unless it
/// was kidnapped there. A walk that runs into a dead end is carried on from elsewhere. Refused when a named
/// stand is inside an obstacle, when the area has no free place, or a number is out of its range. Equal
/// arguments, equal stands.
[[nodiscard]] tl::expected<std::vector<Stand>, WorldError> make_drive(const World& world,
                                                                      const DriveConfig& config,
                                                                      std::uint64_t seed);

}  // namespace slamsensor::tools
