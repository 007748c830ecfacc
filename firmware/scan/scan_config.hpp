#pragma once

#include "core/config.hpp"
#include "core/reading.hpp"
#include "core/sweep/sweep_config.hpp"

#include <cstdint>
#include <numbers>

namespace slamsensor::firmware {

/// One position of the paper's pan-tilt unit (PTU-46, 185.1428 arc seconds), rad.
inline constexpr double kPaperStep_rad = std::numbers::pi / 3500.0;

enum class ScanMode : std::uint8_t {
  Continuous,  ///< one scan after the other
  Single,      ///< one scan for each request
  OneShot,     ///< one scan when this mode begins, then one for each request
};

/// What is swept and how (PanTilt and Rangefinder do it). Defaults: experiments I and II of the paper, 51
/// scanlines of 5 s. Angles in the frame of the unit: pan to the left and tilt up are positive.
struct ScanConfig {
  double pan_min_rad = -2500.0 * kPaperStep_rad;      ///< [-180, 180] deg: -128.57
  double pan_max_rad = 2500.0 * kPaperStep_rad;       ///< [-180, 180] deg: 128.57
  double tilt_min_rad = -350.0 * kPaperStep_rad;      ///< [-90, 90] deg: -18.0
  double tilt_max_rad = 150.0 * kPaperStep_rad;       ///< [-90, 90] deg: 7.71
  double tilt_step_rad = 10.0 * kPaperStep_rad;       ///< [0.001, 90] deg: 0.514
  double pan_speed_radps = 1000.0 * kPaperStep_rad;   ///< [0.1, 1000] deg/s: 51.43
  double tilt_speed_radps = 1000.0 * kPaperStep_rad;  ///< [0.1, 1000] deg/s: 51.43
  ScanMode mode = ScanMode::Continuous;               ///< continuous, single, one_shot
  std::uint32_t calibration_lines = 4;                ///< [0, 100], even: swept at start-up at one tilt
  double calibration_tilt_rad = 0.0;                  ///< [-90, 90] deg: where they are swept
  double settle_s = 0.05;                             ///< [0, 10] from the arrival of both axes to the sweep
  double late_data_s = 0.1;               ///< [0, 10] how long data of an ended line may be under way
  double move_margin_s = 2.0;             ///< [0.1, 60] a move that takes so much longer has stalled
  double retry_s = 1.0;                   ///< [0, 600] rest between an aborted scan and the next
  double lines_rejected_max_share = 0.2;  ///< [0, 1] a scan with more rejected lines is aborted
  double pan_sigma_max_rad =
      std::numbers::pi / 360.0;  ///< [0.01, 10] deg: 0.5; a line whose pan is known worse is left out
  std::uint32_t readings_per_line_max = 120'000;  ///< [100, 2000000] room; 56 bytes each
  std::uint32_t polls_per_line_max = 2'000;       ///< [10, 100000] room for positions of a line
};

using core::LatencyConfig;
using core::MotionConfig;
using core::PanFitConfig;
using core::PositionRounding;

/// Where the roll and pitch of the sensor come from.
enum class InclinationSource : std::uint8_t {
  None,   ///< the sensor stands upright: readings are taken as they are
  Fixed,  ///< they are settings
  Can,    ///< an inclinometer on a CAN bus
  Iio,    ///< an accelerometer of Linux IIO
};

/// How readings are turned into the horizontal.
struct LevellingConfig {
  InclinationSource source = InclinationSource::None;  ///< none, fixed, can, iio
  core::Attitude fixed;                                ///< of Fixed
  core::Attitude offset;  ///< what the inclinometer reports while the sensor stands upright
  double max_lean_rad = 20.0 * core::kDegree;  ///< [1, 45] deg: 20; a sensor that leans farther does not scan
  double moved_rad =
      1.0 * core::kDegree;  ///< [0.05, 45] deg: 1; tilted by more during a scan, the carrier moved

  [[nodiscard]] bool has_inclinometer() const noexcept {
    return source == InclinationSource::Can || source == InclinationSource::Iio;
  }
};

/// All that leads a scan.
struct SensorHeadConfig {
  ScanConfig scan;
  PanFitConfig pan_fit;
  LatencyConfig latency;
  MotionConfig motion;
  LevellingConfig levelling;
};

}  // namespace slamsensor::firmware
