#pragma once

#include "core/geometry/pose2.hpp"
#include "core/reading.hpp"
#include "firmware/scan/scan_config.hpp"
#include "tools/world/drive.hpp"
#include "tools/world/world.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

enum class SweepOrder : std::uint8_t {
  BackAndForth,  ///< the first scanline from left to right, the next back, and so on
  OneWay,        ///< every scanline from left to right
};

/// How the sensor head sweeps. Defaults: experiments I and II of the paper, 51 scanlines of 5,000 readings. A
/// scanline has a reading in the middle of each pan step; there is a scanline at both ends of the tilt range.
struct SweepConfig {
  double pan_min_rad = -2500.0 * firmware::kPaperStep_rad;  // -128.57 deg
  double pan_max_rad = 2500.0 * firmware::kPaperStep_rad;
  double pan_step_rad = firmware::kPaperStep_rad;           // 0.0514 deg
  double tilt_min_rad = -350.0 * firmware::kPaperStep_rad;  // -18.0 deg
  double tilt_max_rad = 150.0 * firmware::kPaperStep_rad;   // 7.71 deg
  double tilt_step_rad = 10.0 * firmware::kPaperStep_rad;   // 0.514 deg
  double readings_per_second = 1000.0;
  double line_change_s = 0.0;   ///< from the end of a scanline to the start of the next
  double mount_height_m = 1.5;  ///< of the sensor's origin above the ground
  SweepOrder order = SweepOrder::BackAndForth;
  double roll_rad = 0.0;   ///< error of the levelling: about x', right side down when positive
  double pitch_rad = 0.0;  ///< about y', front down when positive
};

/// Experiments I and II of the paper: pan +-128.57 deg by 0.0514, tilt -18.0 to 7.71 deg by 0.514.
[[nodiscard]] SweepConfig paper_sweep_1_2() noexcept;

/// Experiments III and IV: tilt -17.5 to 8.23 deg by 1.03, 26 scanlines.
[[nodiscard]] SweepConfig paper_sweep_3_4() noexcept;

/// What is wrong with `sweep`, if anything: a step or rate that is not positive, an empty or too wide range,
/// more than 100,000 scanlines or readings per scanline, or 50 million readings.
[[nodiscard]] std::optional<WorldError> find_problem(const SweepConfig& sweep);

[[nodiscard]] std::size_t line_count(const SweepConfig& sweep) noexcept;
[[nodiscard]] std::size_t readings_per_line(const SweepConfig& sweep) noexcept;

/// Time from the start of the scan to the reading `index` of scanline `line`, and from its first to its last
/// reading, s.
[[nodiscard]] double reading_time_s(const SweepConfig& sweep, std::size_t line, std::size_t index) noexcept;
[[nodiscard]] double scan_duration_s(const SweepConfig& sweep) noexcept;

/// Pan of the reading `index`, in the order of time, of scanline `line`, rad.
[[nodiscard]] double reading_pan_rad(const SweepConfig& sweep, std::size_t line, std::size_t index) noexcept;

/// Where the sensor is in W when its mount stands at `pose_W`.
struct SensorPlace {
  Eigen::Vector3d position_W;
  Eigen::Matrix3d R_W_L;  ///< takes directions in L (x' forward, y' left, z' up) to W
};
[[nodiscard]] SensorPlace sensor_place(const World& world, const SweepConfig& sweep,
                                       const core::Pose2& pose_W) noexcept;

/// Where a head turned by pan and tilt looks: unit vector in L (x' forward, y' left, z' up).
[[nodiscard]] Eigen::Vector3d direction_L(double pan_rad, double cos_tilt, double sin_tilt) noexcept;

/// One scan from `pose_W` that starts at `start_s`: scanlines from the lowest tilt up, each in the order of
/// the sweep, every reading of the world as it is at the reading's time. Equal arguments give equal readings.
/// A sweep that `find_problem` refuses gives no scanline.
[[nodiscard]] std::vector<std::vector<core::Reading>> scan(const World& world, const SweepConfig& sweep,
                                                           const core::Pose2& pose_W, double start_s,
                                                           std::uint64_t seed);

/// How far a simulation has come; `scans_done` of `scans` are on disk.
struct SimulateProgress {
  std::uint32_t scans_done = 0;
  std::uint32_t scans = 0;
};

struct SimulateOptions {
  std::filesystem::path world;              ///< world file (TOML)
  std::filesystem::path out;                ///< folder; made when it does not exist
  std::optional<std::uint64_t> world_seed;  ///< instead of the world file's
  std::uint64_t seed = 1;                   ///< of the drive and of everything the rangefinder does by chance
  SweepConfig sweep;
  DriveConfig drive;
  std::function<void(const SimulateProgress&)> on_progress;  ///< after every scan; may be empty
};

struct SimulateSummary {
  std::uint32_t scans = 0;
  std::uint64_t readings = 0;
  std::uint64_t returns = 0;   ///< readings with a range
  std::uint32_t objects = 0;   ///< in the world, and in stems.csv
  std::uint32_t unplaced = 0;  ///< that found no room
};

/// Drives a simulated sensor through a world and writes into `out`: `scan_0001.csv` and on
/// (`pan_deg,tilt_deg,range_m`; an empty range is no return), `truth.tum` (`t x y z qx qy qz qw`: scan number
/// and pose of the sensor, roll and pitch errors included, in the world frame, which is the map frame) and
/// `stems.csv`
/// (`id,x_m,y_m,radius_m,height_m,kind`: every tree, bush, rock and post). Equal options give equal bytes.
/// Refused when the world or an option is not valid, a file cannot be written, or `out` holds scans that
/// would be mixed with these.
[[nodiscard]] tl::expected<SimulateSummary, WorldError> simulate(const SimulateOptions& options);

/// The files that simulate() makes with `options`.
[[nodiscard]] std::vector<std::filesystem::path> simulated_files(const SimulateOptions& options);

/// "scan_0001.csv" for 1; more digits from 10000 on.
[[nodiscard]] std::string scan_file_name(std::size_t number);

/// `pan_deg,tilt_deg,range_m`, a line per reading in the order of time; angles to 1e-5 deg, ranges to 1 mm.
[[nodiscard]] std::string format_scan(const std::vector<std::vector<core::Reading>>& lines);

/// `t x y z qx qy qz qw` per stand; t counts scans from 1.
[[nodiscard]] std::string format_truth(const World& world, const SweepConfig& sweep,
                                       std::span<const Stand> stands);

/// `id,x_m,y_m,radius_m,height_m,kind` per object; id counts from 1.
[[nodiscard]] std::string format_stems(std::span<const Object> objects);

}  // namespace slamsensor::tools
