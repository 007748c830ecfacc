#pragma once

#include "core/fix.hpp"
#include "core/geometry/pose2.hpp"
#include "tools/plot/svg.hpp"

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
/// stand beside it. A path too small to be read in the map is shown again, larger, in a second panel; then
/// each panel has its scale bar inside. The same plot gives the same bytes; what has no finite position is
/// left out.
[[nodiscard]] std::string draw_map(const MapPlot& plot);

/// Where the map stands in the picture, with the same scale in both directions.
struct MapPanel {
  PixelBox area;  ///< of the map, px
  double px_per_m = 1.0;
  core::Point2 low_W = core::Point2::Zero();  ///< at the area's lower left corner, m
  core::Point2 high_W = core::Point2::Zero();

  [[nodiscard]] core::Point2 to_px(const core::Point2& p_W) const {
    return {area.left + (p_W.x() - low_W.x()) * px_per_m, area.bottom - (p_W.y() - low_W.y()) * px_per_m};
  }
};

/// `plot` without what has no finite position.
[[nodiscard]] MapPlot drawable(const MapPlot& plot);

/// How large a map may and must be, px.
struct FrameSize {
  core::Point2 max_px{760.0, 600.0};
  core::Point2 min_px{340.0, 300.0};
};

/// A frame with its upper left corner at (0, 0) that shows everything in `plot` (drawable) with some room
/// around.
[[nodiscard]] MapPanel frame_map(const MapPlot& plot, const FrameSize& size);

/// The same for the poses that are fixes alone, of which there is at least one.
[[nodiscard]] MapPanel frame_fixes(const MapPlot& plot, const FrameSize& size);

/// `frame` with its upper left corner at `corner_px`.
[[nodiscard]] MapPanel moved_to(const MapPanel& frame, const core::Point2& corner_px);

/// What the tick values and the title of the y axis need left of the map, px.
[[nodiscard]] double left_margin_px(const MapPanel& frame);

/// Grid, frame, ticks, tick values and axis titles of the map.
void draw_map_axes(SvgWriter& svg, const MapPanel& frame);

}  // namespace slamsensor::tools
