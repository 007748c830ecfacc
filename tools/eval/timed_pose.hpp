#pragma once

#include "core/geometry/pose2.hpp"

namespace slamsensor::tools {

/// A pose and the time it belongs to: `t` in seconds as the file gives it, `pose` the sensor in the
/// frame of the file (metres, radians). Shared by the trajectory reader and the evaluation.
struct TimedPose {
  double t = 0.0;
  core::Pose2 pose;
};

}  // namespace slamsensor::tools
