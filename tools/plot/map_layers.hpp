#pragma once

#include "tools/plot/map_frame.hpp"
#include "tools/plot/map_plot.hpp"
#include "tools/plot/palette.hpp"
#include "tools/plot/svg_writer.hpp"

#include <vector>

namespace slamsensor::tools {

/// A pose to be drawn.
struct PoseMark {
  core::Point2 at_px = core::Point2::Zero();
  double heading_rad = 0.0;
  std::int64_t number = 0;
  bool is_fix = true;        ///< else ambiguous
  bool follows_fix = false;  ///< it and the scan before it are fixes: a line joins them
};

/// The poses of `plot` that have a place, in order.
[[nodiscard]] std::vector<PoseMark> pose_marks(const MapPlot& plot, const MapFrame& frame);

/// Sizes of the marks, px, smaller where there is more to draw.
struct MarkSizes {
  double cross_half_px = 4.0;
  double cross_stroke_px = 1.2;
  double pose_px = 2.6;             ///< radius; 0 where poses are so close that only the path is drawn
  double heading_px = 11.0;         ///< length of its tick
  double heading_spacing_px = 9.0;  ///< at least, between two ticks along the path
  double spacing_px = 100.0;        ///< median, between poses
};

[[nodiscard]] MarkSizes mark_sizes(const MapPlot& plot, const MapFrame& frame,
                                   const std::vector<PoseMark>& poses);

/// All landmarks as crosses, one path per class of xi.
void draw_landmarks(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame, const MarkSizes& sizes);

/// Lines from the last pose to the landmarks it matched, and a ring around each.
void draw_matches(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame, const MarkSizes& sizes,
                  const std::vector<PoseMark>& poses);

/// The true path, thin and dashed.
void draw_truth(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame);

/// The path, its poses and their headings; the first pose as a square, the last larger, ambiguous ones
/// hollow.
void draw_poses(SvgWriter& svg, const std::vector<PoseMark>& poses, const MarkSizes& sizes);

}  // namespace slamsensor::tools
