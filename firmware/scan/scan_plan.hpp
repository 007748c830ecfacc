#pragma once

#include "firmware/scan/scan_config.hpp"
#include "hal/pantilt/pan_tilt.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// What stands against a plan. Each names the limit that it meets.
enum class PlanLimit : std::uint8_t {
  PanResolution,    ///< the unit reports no pan resolution
  TiltResolution,   ///< the unit reports no tilt resolution
  PanRange,         ///< the unit's pan limits leave nothing to sweep
  TiltRange,        ///< the unit's tilt limits leave no scanline
  TiltStep,         ///< the step is less than half a position of the tilt axis
  PanSpeed,         ///< the unit cannot move its pan axis
  TiltSpeed,        ///< the unit cannot move its tilt axis
  ScanlineCount,    ///< more than kScanlinesMax
  ReadingsPerLine,  ///< a line has more readings than there is room for
};

/// Why there is no plan. `wanted` and `limit` are in degrees, degrees per second, or counts.
struct PlanProblem {
  PlanLimit limit_hit;
  double wanted;
  double limit;
};

/// A sentence of the problem that needs no memory and lives as long as the program: what stands in the way
/// and which setting or limit to change.
[[nodiscard]] std::string_view describe(PlanLimit limit_hit) noexcept;
/// The same with its numbers. Allocates.
[[nodiscard]] std::string to_text(const PlanProblem& problem);

/// What the unit could not give of what was asked for; 0 is nothing.
struct PlanClipping {
  double pan_min_rad = 0.0;  ///< cut off at the right, beyond snapping to positions
  double pan_max_rad = 0.0;  ///< at the left
  double tilt_min_rad = 0.0;
  double tilt_max_rad = 0.0;
  double calibration_tilt_rad = 0.0;  ///< how far it was moved into the unit's range
  double pan_speed_radps = 0.0;       ///< taken off to stay below the unit's greatest speed, or (negative)
  double tilt_speed_radps = 0.0;      ///< added to reach its least

  [[nodiscard]] bool any() const noexcept;
};

/// Most scanlines of a scan: one for each position of a fine tilt axis.
inline constexpr std::uint32_t kScanlinesMax = 10'000;

/// The scanlines of a scan as a unit can make them: swept back and forth, from the lowest tilt up. All angles
/// are whole positions within the unit's limits. A value.
struct ScanPlan {
  double pan_min_rad = 0.0;
  double pan_max_rad = 0.0;
  double tilt_min_rad = 0.0;
  double tilt_step_rad = 0.0;
  double calibration_tilt_rad = 0.0;
  double pan_speed_radps = 0.0;
  double tilt_speed_radps = 0.0;
  double pan_resolution_rad = 0.0;
  double tilt_resolution_rad = 0.0;
  double sweep_s = 0.0;  ///< of one line, by the unit's motion model
  std::uint32_t lines = 0;
  PlanClipping clipped;

  [[nodiscard]] double tilt_rad(std::uint32_t line) const noexcept {
    return tilt_min_rad + line * tilt_step_rad;
  }
};

/// The plan that `config` makes with a unit such as `unit` and `rate_hz` readings per second. Asked-for
/// angles are rounded to the nearest position, then cut at the unit's limits; speeds are cut at the unit's.
/// No allocation.
[[nodiscard]] tl::expected<ScanPlan, PlanProblem> plan_scan(const ScanConfig& config,
                                                            const hal::PanTiltInfo& unit,
                                                            double rate_hz) noexcept;

}  // namespace slamsensor::firmware
