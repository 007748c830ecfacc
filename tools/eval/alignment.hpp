#pragma once

#include "core/geometry/pose2.hpp"

#include <span>

namespace slamsensor::tools {

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

}  // namespace slamsensor::tools
