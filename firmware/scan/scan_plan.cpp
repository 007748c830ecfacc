#include "firmware/scan/scan_plan.hpp"

#include "hal/pantilt/pan_tilt.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace slamsensor::firmware {
namespace {

constexpr double kSlack = 1e-6;  // positions: a limit that is a whole position is not missed by rounding
constexpr double kPerDegree = 180.0 / std::numbers::pi;

// In the order of PlanLimit.
constexpr std::array<std::string_view, 9> kTexts = {
    "the pan-tilt unit reports no pan resolution; check its driver and model",
    "the pan-tilt unit reports no tilt resolution; check its driver and model",
    "the pan range asked for is outside the unit's pan limits; change pan_min and pan_max or the unit's "
    "limits",
    "the tilt range asked for is outside the unit's tilt limits; change tilt_min and tilt_max or the unit's "
    "limits",
    "tilt_step is less than half a position of the unit's tilt axis; make it larger",
    "the unit reports no pan speed above zero; check its driver and model",
    "the unit reports no tilt speed above zero; check its driver and model",
    "the tilt range has more scanlines than a scan may have; make tilt_step larger",
    "a scanline has more readings than there is room for; raise readings_per_line_max or the pan speed, or "
    "lower the rangefinder's rate",
};

/// An asked-for interval as positions of an axis.
struct Interval {
  double min_rad = 0.0;
  double max_rad = 0.0;
  double cut_min_rad = 0.0;
  double cut_max_rad = 0.0;
};

double to_position_rad(double angle_rad, double resolution_rad) noexcept {
  return std::round(angle_rad / resolution_rad) * resolution_rad;
}

/// The first whole position at or above the axis' lower limit, the last at or below its upper.
double lowest_rad(const hal::AxisInfo& axis) noexcept {
  return std::ceil(axis.min_rad / axis.resolution_rad - kSlack) * axis.resolution_rad;
}
double highest_rad(const hal::AxisInfo& axis) noexcept {
  return std::floor(axis.max_rad / axis.resolution_rad + kSlack) * axis.resolution_rad;
}

Interval fit_interval(double min_rad, double max_rad, const hal::AxisInfo& axis) noexcept {
  const double wanted_min_rad = to_position_rad(min_rad, axis.resolution_rad);
  const double wanted_max_rad = to_position_rad(max_rad, axis.resolution_rad);
  Interval fitted;
  fitted.min_rad = std::max(wanted_min_rad, lowest_rad(axis));
  fitted.max_rad = std::min(wanted_max_rad, highest_rad(axis));
  fitted.cut_min_rad = fitted.min_rad - wanted_min_rad;
  fitted.cut_max_rad = wanted_max_rad - fitted.max_rad;
  return fitted;
}

std::optional<PlanProblem> check_unit(const hal::PanTiltInfo& unit) noexcept {
  if (!(unit.pan.resolution_rad > 0.0)) {
    return PlanProblem{PlanLimit::PanResolution, 0.0, unit.pan.resolution_rad * kPerDegree};
  }
  if (!(unit.tilt.resolution_rad > 0.0)) {
    return PlanProblem{PlanLimit::TiltResolution, 0.0, unit.tilt.resolution_rad * kPerDegree};
  }
  if (!(unit.pan.speed_max_radps > 0.0)) {
    return PlanProblem{PlanLimit::PanSpeed, 0.0, unit.pan.speed_max_radps * kPerDegree};
  }
  if (!(unit.tilt.speed_max_radps > 0.0)) {
    return PlanProblem{PlanLimit::TiltSpeed, 0.0, unit.tilt.speed_max_radps * kPerDegree};
  }
  return std::nullopt;
}

double fit_speed(double speed_radps, const hal::AxisInfo& axis) noexcept {
  return std::min(std::max(speed_radps, axis.speed_min_radps), axis.speed_max_radps);
}

void plan_speeds(ScanPlan& plan, const ScanConfig& config, const hal::PanTiltInfo& unit) noexcept {
  plan.pan_speed_radps = fit_speed(config.pan_speed_radps, unit.pan);
  plan.tilt_speed_radps = fit_speed(config.tilt_speed_radps, unit.tilt);
  plan.clipped.pan_speed_radps = config.pan_speed_radps - plan.pan_speed_radps;
  plan.clipped.tilt_speed_radps = config.tilt_speed_radps - plan.tilt_speed_radps;
}

std::optional<PlanProblem> plan_pan(ScanPlan& plan, const ScanConfig& config,
                                    const hal::AxisInfo& axis) noexcept {
  const Interval pan = fit_interval(config.pan_min_rad, config.pan_max_rad, axis);
  plan.pan_resolution_rad = axis.resolution_rad;
  plan.pan_min_rad = pan.min_rad;
  plan.pan_max_rad = pan.max_rad;
  plan.clipped.pan_min_rad = pan.cut_min_rad;
  plan.clipped.pan_max_rad = pan.cut_max_rad;
  if (!(pan.max_rad - pan.min_rad > 0.5 * axis.resolution_rad)) {
    const bool too_far_right = config.pan_max_rad < axis.min_rad;
    return PlanProblem{PlanLimit::PanRange,
                       (too_far_right ? config.pan_max_rad : config.pan_min_rad) * kPerDegree,
                       (too_far_right ? axis.min_rad : axis.max_rad) * kPerDegree};
  }
  plan.sweep_s = hal::MotionProfile(plan.pan_min_rad, plan.pan_max_rad, plan.pan_speed_radps, axis.dynamics)
                     .duration_s();
  return std::nullopt;
}

std::optional<PlanProblem> plan_tilt(ScanPlan& plan, const ScanConfig& config,
                                     const hal::AxisInfo& axis) noexcept {
  plan.tilt_resolution_rad = axis.resolution_rad;
  plan.tilt_step_rad = to_position_rad(config.tilt_step_rad, axis.resolution_rad);
  if (!(plan.tilt_step_rad > 0.0)) {
    return PlanProblem{PlanLimit::TiltStep, config.tilt_step_rad * kPerDegree,
                       axis.resolution_rad * kPerDegree};
  }
  const Interval tilt = fit_interval(config.tilt_min_rad, config.tilt_max_rad, axis);
  plan.tilt_min_rad = tilt.min_rad;
  plan.clipped.tilt_min_rad = tilt.cut_min_rad;
  plan.clipped.tilt_max_rad = tilt.cut_max_rad;
  const double steps = std::floor((tilt.max_rad - tilt.min_rad) / plan.tilt_step_rad + kSlack);
  if (!(steps >= 0.0)) {
    const bool too_low = config.tilt_max_rad < axis.min_rad;
    return PlanProblem{PlanLimit::TiltRange,
                       (too_low ? config.tilt_max_rad : config.tilt_min_rad) * kPerDegree,
                       (too_low ? axis.min_rad : axis.max_rad) * kPerDegree};
  }
  if (steps + 1.0 > kScanlinesMax) {
    return PlanProblem{PlanLimit::ScanlineCount, steps + 1.0, kScanlinesMax};
  }
  plan.lines = static_cast<std::uint32_t>(steps) + 1;
  const double calibration_rad = to_position_rad(config.calibration_tilt_rad, axis.resolution_rad);
  plan.calibration_tilt_rad = std::clamp(calibration_rad, lowest_rad(axis), highest_rad(axis));
  plan.clipped.calibration_tilt_rad = plan.calibration_tilt_rad - calibration_rad;
  return std::nullopt;
}

}  // namespace

bool PlanClipping::any() const noexcept {
  const std::array<double, 7> all = {pan_min_rad,     pan_max_rad,      tilt_min_rad,        tilt_max_rad,
                                     pan_speed_radps, tilt_speed_radps, calibration_tilt_rad};
  return std::any_of(all.begin(), all.end(), [](double cut) { return std::abs(cut) > 1e-9; });
}

std::string_view describe(PlanLimit limit_hit) noexcept {
  return kTexts[static_cast<std::size_t>(limit_hit)];
}

std::string to_text(const PlanProblem& problem) {
  return std::string(describe(problem.limit_hit)) + " (asked for: " + std::to_string(problem.wanted) +
         ", limit: " + std::to_string(problem.limit) + ")";
}

tl::expected<ScanPlan, PlanProblem> plan_scan(const ScanConfig& config, const hal::PanTiltInfo& unit,
                                              double rate_hz) noexcept {
  if (const auto problem = check_unit(unit)) {
    return tl::unexpected(*problem);
  }
  ScanPlan plan;
  plan_speeds(plan, config, unit);
  if (const auto problem = plan_pan(plan, config, unit.pan)) {
    return tl::unexpected(*problem);
  }
  if (const auto problem = plan_tilt(plan, config, unit.tilt)) {
    return tl::unexpected(*problem);
  }
  // What is under way around the sweep is kept as well.
  const double readings = rate_hz * (plan.sweep_s + config.late_data_s);
  if (readings > config.readings_per_line_max) {
    return tl::unexpected(
        PlanProblem{PlanLimit::ReadingsPerLine, readings, static_cast<double>(config.readings_per_line_max)});
  }
  return plan;
}

}  // namespace slamsensor::firmware
