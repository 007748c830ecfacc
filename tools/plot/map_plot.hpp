#pragma once

#include "core/fix.hpp"
#include "core/geometry/pose2.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// A landmark of the map as the picture shows it.
struct PlotLandmark {
  core::Point2 position_W = core::Point2::Zero();  ///< m
  unsigned xi = 0;                                 ///< triangulations between it and the origin
  bool matched = false;                            ///< by the last scan that has a pose
};

/// What one scan gave; the pose counts unless the status is NoFix.
struct PlotPose {
  core::Pose2 pose_W;
  std::int64_t number = 0;  ///< of the scan, written beside the pose
  core::FixStatus status = core::FixStatus::NoFix;
};

/// All that a picture of a map shows.
struct MapPlot {
  std::string title;
  std::vector<std::string> summary;  ///< lines under the title
  std::vector<PlotLandmark> landmarks;
  std::vector<PlotPose> poses;  ///< in the order of the scans, one for each, those without a fix included
  std::vector<core::Pose2> truth_W;  ///< true path in the map frame, if it is known
};

/// The picture as an SVG document: a map in metres with equal axes, landmarks as crosses coloured by xi, the
/// path of the sensor (broken where scans gave no fix) with headings and as many scan numbers as fit without
/// overlap, the first and the last always among them, and the matches of the last pose. Legend and scale bar
/// (of the map) stand beside it. A path too small to be read in the map is shown again, larger, in a second
/// panel. The same plot gives the same bytes; what has no finite position is left out.
[[nodiscard]] std::string draw_map(const MapPlot& plot);

}  // namespace slamsensor::tools
