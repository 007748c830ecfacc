#include "core/detection/polar_grid.hpp"

#include "core/memory/assert.hpp"

namespace slamsensor::core {
namespace {

constexpr double kCellsAlongMax = 1e6;
constexpr double kCellsMax = 2147483648.0;

/// `extent / step`, made whole when only rounding keeps it from that: 360 deg in steps of 18 deg are 20,
/// not 21.
double steps_in(double extent, double step) noexcept {
  const double steps = extent / step;
  const double whole = std::round(steps);
  return std::abs(steps - whole) < PolarGrid::kEdgeSlack ? whole : steps;
}

/// The number of cells that cover `steps` steps.
std::uint32_t cells_along(double steps) noexcept {
  SLAMSENSOR_ASSERT(steps >= 1.0 && steps <= kCellsAlongMax);
  return static_cast<std::uint32_t>(std::ceil(steps));
}

}  // namespace

PolarGrid::PolarGrid(const DetectionConfig& config) noexcept
    : bearing_step_rad_(config.bearing_step_rad),
      range_step_m_(config.range_step_m),
      columns_per_rad_(1.0 / config.bearing_step_rad),
      rows_per_m_(1.0 / config.range_step_m),
      turn_columns_(steps_in(kTurn, config.bearing_step_rad)),
      columns_(cells_along(turn_columns_)),
      rows_(cells_along(steps_in(config.range_max_m, config.range_step_m))) {
  SLAMSENSOR_ASSERT(static_cast<double>(columns_) * rows_ < kCellsMax);
}

double PolarGrid::off_centre_rad(std::uint32_t column, double bearing_rad) const noexcept {
  const double centre_rad = (column + 0.5) * bearing_step_rad_;
  return std::remainder(bearing_rad - centre_rad, kTurn);
}

}  // namespace slamsensor::core
