#pragma once

#include "core/geometry/pose2.hpp"

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
  std::vector<CurveSeries> series;
};

/// The chart as an SVG document. Series differ in colour, in marker and in dashes; the legend stands above
/// the chart. A linear y axis begins at zero unless values are negative or all far from it. A point that is
/// not finite, or not positive on a logarithmic axis, is left out and breaks its line. The same plot gives
/// the same bytes.
[[nodiscard]] std::string draw_curve(const CurvePlot& plot);

}  // namespace slamsensor::tools
