#pragma once

#include "firmware/scan/scanline.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace slamsensor::firmware {

/// Even cells of pan that profiles of lines are laid out on: cell i is at min_rad + i * cell_rad.
struct ProfileGrid {
  double min_rad = 0.0;
  double cell_rad = 0.0;
  std::size_t cells = 0;
};

/// Most cells of a profile; bounds what it costs to compare two.
inline constexpr std::size_t kProfileCellsMax = 8192;

/// The grid of pan_min_rad to pan_max_rad (greater) with a cell for each reading when they are `reading_rad`
/// apart (positive), or wider cells when those would be more than kProfileCellsMax.
[[nodiscard]] ProfileGrid make_grid(double pan_min_rad, double pan_max_rad, double reading_rad) noexcept;

/// How far the world is over pan, as one line saw it: the logarithm of the range, so that an edge counts by
/// the ratio of its two ranges, lightly smoothed. No allocation after construction.
class RangeProfile {
 public:
  static constexpr std::int16_t kHole = -1;   ///< not looked at
  static constexpr double kPerUnit = 1000.0;  ///< of a natural logarithm of (range / m + 1)

  RangeProfile();

  /// Takes the steady part of `line`. What is beyond `range_max_m` and what did not return count as equally
  /// far.
  void build(const Scanline& line, const ProfileGrid& grid, double range_max_m) noexcept;

  /// Per cell of the grid.
  [[nodiscard]] std::span<const std::int16_t> cells() const noexcept { return smooth_; }

  [[nodiscard]] SweepDirection direction() const noexcept { return direction_; }
  [[nodiscard]] std::uint32_t line() const noexcept { return line_; }
  [[nodiscard]] double pan_radps() const noexcept { return pan_radps_; }
  [[nodiscard]] double fit_sigma_s() const noexcept { return fit_sigma_s_; }
  [[nodiscard]] double latency_s() const noexcept { return latency_s_; }

 private:
  void draw(const ProfileGrid& grid, const core::Reading& from, const core::Reading& to,
            double range_max_m) noexcept;
  void smooth() noexcept;

  std::vector<double> raw_;  // per cell; negative where there is no reading nearby
  std::vector<std::int16_t> smooth_;
  SweepDirection direction_ = SweepDirection::Leftwards;
  std::uint32_t line_ = 0;
  double pan_radps_ = 0.0;
  double fit_sigma_s_ = 0.0;
  double latency_s_ = 0.0;
};

}  // namespace slamsensor::firmware
