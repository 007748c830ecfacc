#pragma once

#include "core/geometry/pose2.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// A pose and the time it belongs to: `t` in seconds as the file gives it, `pose` the sensor in the
/// frame of the file (metres, radians). Shared by the trajectory reader and the evaluation.
struct TimedPose {
  double t = 0.0;
  core::Pose2 pose;
};

/// A fix and the true pose it belongs to.
struct PosePair {
  core::Pose2 truth;
  core::Pose2 estimate;
};

/// The motion that takes the first estimate exactly onto its true pose. `pairs` is not empty.
[[nodiscard]] core::Pose2 align_first(std::span<const PosePair> pairs);

/// The rigid motion that takes the estimated positions onto the true ones with the least sum of squared
/// distances (Umeyama, without scale). Where all positions of either side are one place, the rotation is the
/// mean of the heading differences. `pairs` is not empty.
[[nodiscard]] core::Pose2 align_least_squares(std::span<const PosePair> pairs);

/// When a fix is wrong, and how it finds its true pose.
struct EvaluationConfig {
  double wrong_distance_m = 1.0;                            ///< a fix farther off than this is wrong
  double wrong_heading_rad = 2.0 * std::numbers::pi / 180;  ///< a fix turned by more than this is wrong
  double time_tolerance_s =
      0.01;  ///< a fix belongs to the nearest true pose if their times differ by no more
};

/// What one fix is off by, under some alignment.
struct FixError {
  double t = 0.0;               ///< of the fix
  std::size_t truth_index = 0;  ///< rank of its true pose in time, from 0
  double distance_m = 0.0;
  double heading_rad = 0.0;  ///< signed, [-pi, pi)
  bool is_wrong = false;
};

/// Error of the fixes whose true pose lies in one tenth of the truth.
struct TenthError {
  std::size_t fixes = 0;
  double rms_m = 0.0;  ///< 0 without fixes
  double max_m = 0.0;
};

/// The errors of all fixes that have a true pose, under one alignment. ATE is the absolute trajectory error,
/// the distance of a fix from its true position.
struct AlignedErrors {
  core::Pose2 T_truth_map;  ///< takes the trajectory into the frame of the truth
  std::size_t wrong_fixes = 0;
  double ate_rms_m = 0.0;
  double ate_median_m = 0.0;
  double ate_max_m = 0.0;
  double heading_rms_rad = 0.0;
  double heading_max_rad = 0.0;  ///< without sign
  FixError worst;                ///< the fix with the largest distance, the first if there are several
  std::array<TenthError, 10> tenths{};
  std::vector<FixError> fixes;  ///< in the order of the trajectory
};

/// How good a trajectory is.
struct Evaluation {
  EvaluationConfig config;
  std::size_t scans_in_truth = 0;
  std::size_t fixes = 0;
  std::size_t fixes_without_truth = 0;     ///< in no count and no error below
  std::size_t scans_without_fix = 0;       ///< true poses that no fix belongs to
  std::optional<AlignedErrors> first_fix;  ///< official: the first fix with a true pose defines the map frame
  std::optional<AlignedErrors>
      least_squares;  ///< smallest ATE rms of all rigid motions; both absent without such a fix
};

/// Whether there are fixes, and none has a time of the truth: such an evaluation says nothing.
[[nodiscard]] bool has_nothing_in_common(const Evaluation& evaluation);

/// Why two trajectories cannot be compared, in one line.
struct EvaluationError {
  std::string message;
};

/// Compares `trajectory` (a pose per fix, in the order they were made) with `truth` (any order). The
/// least-squares alignment is Umeyama's without scale; where the positions do not determine the rotation (one
/// place only) the headings do. Refused: two poses of one file with the same time, a value that is not
/// finite, a negative limit.
[[nodiscard]] tl::expected<Evaluation, EvaluationError> evaluate(std::span<const TimedPose> truth,
                                                                 std::span<const TimedPose> trajectory,
                                                                 const EvaluationConfig& config = {});

/// The evaluation for people: a few aligned lines, metres and degrees, the official figures first.
[[nodiscard]] std::string evaluation_text(const Evaluation& evaluation);

/// The evaluation for programs: one JSON object, keys always in the same order, metres and degrees as the
/// keys say, ending in a newline. `first_fix` and `least_squares` are null without a fix that has a true
/// pose; the top level's `wrong_fixes` is the official one.
[[nodiscard]] std::string evaluation_json(const Evaluation& evaluation);

}  // namespace slamsensor::tools
