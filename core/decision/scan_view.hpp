#pragma once

#include "core/decision/rates.hpp"
#include "core/geometry/pose2.hpp"

#include <cmath>
#include <numbers>
#include <span>

namespace slamsensor::core {

/// What a scan saw beside its landmarks, in the sensor's frame L. The readings give the range up to which
/// each bearing was seen free; a list of landmarks gives a field of view and a range at most, or neither.
struct ScanView {
  static constexpr float kUnknown = -1.0F;

  std::span<const float> free_m;   ///< per column of the circle, column 0 from x' on, counter-clockwise;
                                   ///< kUnknown where nothing was looked at. Empty without readings.
  double field_of_view_rad = 0.0;  ///< centred on x'; 0 = not known
  double range_m = 0.0;            ///< landmarks are seen up to it; 0 = not known
  bool shows_faces = false;  ///< landmarks are what readings show of a trunk: its near face, not its centre

  /// Whether something of half width `half_width_m` that stands at `p_L` would have stood in the way.
  [[nodiscard]] bool shows(const Point2& p_L, double half_width_m) const noexcept {
    const double range = p_L.norm();
    const double bearing_rad = std::atan2(p_L.y(), p_L.x());
    if (range_m > 0.0 && range > range_m) {
      return false;
    }
    if (field_of_view_rad > 0.0 && std::abs(bearing_rad) > 0.5 * field_of_view_rad) {
      return false;
    }
    if (free_m.empty()) {
      return true;
    }
    constexpr double kTurn = 2.0 * std::numbers::pi;
    const auto columns = static_cast<double>(free_m.size());
    const double half = std::min(0.25 * kTurn, half_width_m / std::max(range, half_width_m));
    const auto first = static_cast<std::int64_t>(std::floor((bearing_rad - half) / kTurn * columns));
    const auto last = static_cast<std::int64_t>(std::floor((bearing_rad + half) / kTurn * columns));
    for (std::int64_t c = first; c <= last; ++c) {
      const auto size = static_cast<std::int64_t>(free_m.size());
      const float free = free_m[static_cast<std::size_t>((c % size + size) % size)];
      if (static_cast<double>(free) < range + half_width_m) {
        return false;
      }
    }
    return true;
  }
};

}  // namespace slamsensor::core
