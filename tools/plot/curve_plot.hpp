#pragma once

#include "core/geometry/pose2.hpp"
#include "tools/plot/svg.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace slamsensor::tools {

enum class CurveStyle : std::uint8_t { LineAndMarkers, Line, Markers };

enum class AxisScale : std::uint8_t { Linear, Logarithmic };

/// One curve of a chart.
struct CurveSeries {
  std::string name;  ///< in the legend; an unnamed series stands in none
  std::vector<core::Point2> points;
  CurveStyle style = CurveStyle::LineAndMarkers;
};

/// All that a chart shows.
struct CurvePlot {
  std::string title;
  std::vector<std::string> summary;  ///< lines under the title
  std::string x_label;
  std::string y_label;
  AxisScale y_scale = AxisScale::Linear;
  double x_step_min = 0.0;  ///< ticks are no closer than this: 1 for counts
  double y_step_min = 0.0;  ///< of a linear axis
  std::vector<CurveSeries> series;
};

/// The chart as an SVG document. Series differ in colour, in marker and in dashes; the legend stands above
/// the chart. A linear y axis begins at zero unless values are negative or all far from it. A point that is
/// not finite, or not positive on a logarithmic axis, is left out and breaks its line. The same plot gives
/// the same bytes.
[[nodiscard]] std::string draw_curve(const CurvePlot& plot);

/// Where a chart stands in the picture. Values of y are logarithms to base ten if the scale is logarithmic.
struct CurveFrame {
  PixelBox area;
  core::Point2 low = core::Point2::Zero();
  core::Point2 high = core::Point2::Ones();
  AxisScale y_scale = AxisScale::Linear;
  double x_step = 1.0;
  double y_step = 1.0;  ///< of a linear axis

  [[nodiscard]] core::Point2 to_px(const core::Point2& value) const;
};

/// Whether the chart can show `point`.
[[nodiscard]] bool is_drawable(const core::Point2& point, AxisScale y_scale);

/// A frame of fixed size with its upper left corner at `corner_px`, limits at round values, that shows all
/// drawable points.
[[nodiscard]] CurveFrame frame_curve(const CurvePlot& plot, const core::Point2& corner_px);

/// Grid, frame, ticks, tick values and axis titles.
void draw_curve_axes(SvgWriter& svg, const CurvePlot& plot, const CurveFrame& frame);

}  // namespace slamsensor::tools
