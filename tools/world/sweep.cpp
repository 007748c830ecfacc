#include "tools/world/sweep.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr double kCountMax = 100'000.0;
constexpr double kReadingsMax = 50e6;

double pan_steps(const SweepConfig& sweep) noexcept {
  return std::round((sweep.pan_max_rad - sweep.pan_min_rad) / sweep.pan_step_rad);
}

double tilt_steps(const SweepConfig& sweep) noexcept {
  return std::round((sweep.tilt_max_rad - sweep.tilt_min_rad) / sweep.tilt_step_rad);
}

double line_duration_s(const SweepConfig& sweep) noexcept {
  return static_cast<double>(readings_per_line(sweep)) / sweep.readings_per_second + sweep.line_change_s;
}

bool within(double value, double min, double max) noexcept {
  return value >= min && value <= max;  // false for not-a-number
}

}  // namespace

SweepConfig paper_sweep_1_2() noexcept {
  return {};
}

SweepConfig paper_sweep_3_4() noexcept {
  SweepConfig sweep;
  sweep.tilt_min_rad = -340.0 * firmware::kPaperStep_rad;
  sweep.tilt_max_rad = 160.0 * firmware::kPaperStep_rad;
  sweep.tilt_step_rad = 20.0 * firmware::kPaperStep_rad;
  return sweep;
}

std::optional<WorldError> find_problem(const SweepConfig& sweep) {
  constexpr double kTurn = 2.0 * std::numbers::pi + 1e-9;
  constexpr double kUpright = 0.5 * std::numbers::pi + 1e-9;
  if (!(sweep.pan_step_rad > 0.0 && sweep.tilt_step_rad > 0.0 && sweep.readings_per_second > 0.0)) {
    return WorldError{"sweep: pan step, tilt step and readings per second must be above zero"};
  }
  if (!within(sweep.pan_max_rad - sweep.pan_min_rad, 0.0, kTurn) ||
      !within(sweep.tilt_min_rad, -kUpright, kUpright) ||
      !within(sweep.tilt_max_rad, sweep.tilt_min_rad, kUpright)) {
    return WorldError{
        "sweep: pan must span 0 to 360 deg, and tilt must rise from its least to its greatest in +-90 deg"};
  }
  if (!within(sweep.mount_height_m, 0.0, 100.0) || !within(sweep.line_change_s, 0.0, 3600.0) ||
      !within(sweep.roll_rad, -kUpright, kUpright) || !within(sweep.pitch_rad, -kUpright, kUpright)) {
    return WorldError{
        "sweep: mount height must be 0 to 100 m, line change 0 to 3600 s, roll and pitch within +-90 deg"};
  }
  const double readings = pan_steps(sweep);
  const double lines = tilt_steps(sweep) + 1.0;
  if (!within(readings, 1.0, kCountMax) || !within(lines, 1.0, kCountMax) ||
      readings * lines > kReadingsMax) {
    return WorldError{
        "sweep: 1 to 100000 scanlines of 1 to 100000 readings, 50 million in all; change the steps"};
  }
  return std::nullopt;
}

std::size_t line_count(const SweepConfig& sweep) noexcept {
  return static_cast<std::size_t>(tilt_steps(sweep)) + 1;
}

std::size_t readings_per_line(const SweepConfig& sweep) noexcept {
  return static_cast<std::size_t>(pan_steps(sweep));
}

double reading_time_s(const SweepConfig& sweep, std::size_t line, std::size_t index) noexcept {
  return static_cast<double>(line) * line_duration_s(sweep) +
         static_cast<double>(index) / sweep.readings_per_second;
}

double scan_duration_s(const SweepConfig& sweep) noexcept {
  return reading_time_s(sweep, line_count(sweep) - 1, readings_per_line(sweep) - 1);
}

double reading_pan_rad(const SweepConfig& sweep, std::size_t line, std::size_t index) noexcept {
  const bool leftwards = sweep.order == SweepOrder::BackAndForth && line % 2 == 1;
  const std::size_t step = leftwards ? index : readings_per_line(sweep) - 1 - index;
  return sweep.pan_min_rad + (static_cast<double>(step) + 0.5) * sweep.pan_step_rad;
}

SensorPlace sensor_place(const World& world, const SweepConfig& sweep, const core::Pose2& pose_W) noexcept {
  const Eigen::Vector3d position_W(pose_W.x_m, pose_W.y_m,
                                   world.ground_height_m(pose_W.x_m, pose_W.y_m) + sweep.mount_height_m);
  const Eigen::Quaterniond heading(Eigen::AngleAxisd(pose_W.heading_rad, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond pitch(Eigen::AngleAxisd(sweep.pitch_rad, Eigen::Vector3d::UnitY()));
  const Eigen::Quaterniond roll(Eigen::AngleAxisd(sweep.roll_rad, Eigen::Vector3d::UnitX()));
  return {position_W, (heading * pitch * roll).toRotationMatrix()};
}

Eigen::Vector3d direction_L(double pan_rad, double cos_tilt, double sin_tilt) noexcept {
  return {cos_tilt * std::cos(pan_rad), cos_tilt * std::sin(pan_rad), sin_tilt};
}

std::vector<std::vector<core::Reading>> scan(const World& world, const SweepConfig& sweep,
                                             const core::Pose2& pose_W, double start_s, std::uint64_t seed) {
  if (find_problem(sweep)) {
    return {};
  }
  Random rng(seed);
  const SensorPlace place = sensor_place(world, sweep, pose_W);
  const std::size_t readings = readings_per_line(sweep);
  std::vector<std::vector<core::Reading>> lines(line_count(sweep));
  for (std::size_t line = 0; line < lines.size(); ++line) {
    const double tilt_rad = sweep.tilt_min_rad + static_cast<double>(line) * sweep.tilt_step_rad;
    const double cos_tilt = std::cos(tilt_rad);
    const double sin_tilt = std::sin(tilt_rad);
    lines[line].reserve(readings);
    for (std::size_t i = 0; i < readings; ++i) {
      const double pan_rad = reading_pan_rad(sweep, line, i);
      const Eigen::Vector3d direction_W = place.R_W_L * direction_L(pan_rad, cos_tilt, sin_tilt);
      const double time_s = start_s + reading_time_s(sweep, line, i);
      const Range range = world.cast(place.position_W, direction_W, time_s, rng);
      lines[line].push_back({pan_rad, tilt_rad, range.range_m});
    }
  }
  return lines;
}

}  // namespace slamsensor::tools
