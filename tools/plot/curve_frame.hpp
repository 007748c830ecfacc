#pragma once

#include "tools/plot/curve_plot.hpp"
#include "tools/plot/svg_writer.hpp"

namespace slamsensor::tools {

/// Where a chart stands in the picture. Values of y are logarithms to base ten if the scale is logarithmic.
struct CurveFrame {
  Box area;
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
