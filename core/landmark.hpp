#pragma once

#include "core/geometry/pose2.hpp"

namespace slamsensor::core {

/// A landmark as one scan sees it.
struct ScanLandmark {
  Point2 position_L = Point2::Zero();  ///< in the sensor frame, m
  double weight = 0.0;                 ///< the detector's certainty: larger is better; only the order matters
};

}  // namespace slamsensor::core
