#include "firmware/scan/range_profile.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::firmware {
namespace {

constexpr double kGapCells = 4.0;  // readings farther apart are not joined

double height_of(const core::Reading& reading, double range_max_m) noexcept {
  const double range_m = reading.has_return() ? std::min(reading.range_m, range_max_m) : range_max_m;
  return RangeProfile::kPerUnit * std::log1p(range_m);
}

}  // namespace

ProfileGrid make_grid(double pan_min_rad, double pan_max_rad, double reading_rad) noexcept {
  const double span_rad = pan_max_rad - pan_min_rad;
  const double cell_rad = std::max(reading_rad, span_rad / static_cast<double>(kProfileCellsMax - 1));
  return {pan_min_rad, cell_rad, static_cast<std::size_t>(span_rad / cell_rad * (1.0 + 1e-12)) + 1};
}

RangeProfile::RangeProfile() {
  raw_.reserve(kProfileCellsMax);
  smooth_.reserve(kProfileCellsMax);
}

void RangeProfile::build(const Scanline& line, const ProfileGrid& grid, double range_max_m) noexcept {
  direction_ = line.direction;
  line_ = line.line;
  pan_radps_ = line.pan_radps;
  fit_sigma_s_ = line.fit_sigma_s;
  latency_s_ = line.latency_s;
  raw_.assign(std::min(grid.cells, kProfileCellsMax), -1.0);
  const auto is_steady = [&](const core::Reading& reading) {
    return reading.pan_rad >= line.steady_min_rad && reading.pan_rad <= line.steady_max_rad;
  };
  for (std::size_t i = 1; i < line.readings.size(); ++i) {
    const core::Reading& a = line.readings[i - 1];
    const core::Reading& b = line.readings[i];
    if (is_steady(a) && is_steady(b)) {
      const bool ordered = a.pan_rad <= b.pan_rad;
      draw(grid, ordered ? a : b, ordered ? b : a, range_max_m);
    }
  }
  smooth();
}

/// Fills the cells between two readings by a straight line.
void RangeProfile::draw(const ProfileGrid& grid, const core::Reading& from, const core::Reading& to,
                        double range_max_m) noexcept {
  const double from_cell = (from.pan_rad - grid.min_rad) / grid.cell_rad;
  const double to_cell = (to.pan_rad - grid.min_rad) / grid.cell_rad;
  const double last = static_cast<double>(raw_.size()) - 1.0;
  const double width = to_cell - from_cell;
  if (!(width > 0.0) || width > kGapCells || !(to_cell >= 0.0) || !(from_cell <= last)) {
    return;
  }
  const double from_height = height_of(from, range_max_m);
  const double to_height = height_of(to, range_max_m);
  for (double cell = std::max(0.0, std::ceil(from_cell)); cell <= std::min(last, to_cell); cell += 1.0) {
    const double share = (cell - from_cell) / width;
    raw_[static_cast<std::size_t>(cell)] = from_height + share * (to_height - from_height);
  }
}

void RangeProfile::smooth() noexcept {
  smooth_.assign(raw_.size(), kHole);
  for (std::size_t i = 1; i + 1 < raw_.size(); ++i) {
    if (raw_[i - 1] >= 0.0 && raw_[i] >= 0.0 && raw_[i + 1] >= 0.0) {
      smooth_[i] = static_cast<std::int16_t>(std::lround(0.25 * (raw_[i - 1] + 2.0 * raw_[i] + raw_[i + 1])));
    }
  }
}

}  // namespace slamsensor::firmware
