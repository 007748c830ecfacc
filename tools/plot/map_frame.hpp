#pragma once

#include "core/geometry/pose2.hpp"
#include "tools/plot/map_plot.hpp"
#include "tools/plot/svg_writer.hpp"

#include <vector>

namespace slamsensor::tools {

/// Where the map stands in the picture, with the same scale in both directions.
struct MapFrame {
  Box area;  ///< of the map, px
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
[[nodiscard]] MapFrame frame_map(const MapPlot& plot, const FrameSize& size);

/// The same for the poses that are fixes alone, of which there is at least one.
[[nodiscard]] MapFrame frame_fixes(const MapPlot& plot, const FrameSize& size);

/// `frame` with its upper left corner at `corner_px`.
[[nodiscard]] MapFrame moved_to(const MapFrame& frame, const core::Point2& corner_px);

/// What the tick values and the title of the y axis need left of the map, px.
[[nodiscard]] double left_margin_px(const MapFrame& frame);

/// Grid, frame, ticks, tick values and axis titles of the map.
void draw_map_axes(SvgWriter& svg, const MapFrame& frame);

}  // namespace slamsensor::tools
