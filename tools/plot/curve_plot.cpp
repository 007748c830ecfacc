#include "tools/plot/curve_plot.hpp"

#include "tools/plot/curve_frame.hpp"
#include "tools/plot/heading_text.hpp"
#include "tools/plot/palette.hpp"
#include "tools/plot/svg_writer.hpp"
#include "tools/plot/xml_text.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace slamsensor::tools {
namespace {

constexpr double kLeft_px = 76.0;
constexpr double kTop_px = 12.0;
constexpr double kRight_px = 18.0;
constexpr double kBelowAxis_px = 46.0;
constexpr double kLegendRow_px = 19.0;
constexpr double kSample_px = 30.0;
constexpr std::size_t kMarkersMax = 150;
// Dashes of a line with more points than this look like noise.
constexpr std::size_t kDashedPointsMax = 200;

struct Look {
  std::string_view colour;
  std::string_view dashes;
};

// Okabe and Ito's colours in an order that also differs in lightness.
constexpr std::array<Look, 6> kLooks{{{"#0072b2", "none"},
                                      {"#d55e00", "6 3"},
                                      {"#009e73", "2 2"},
                                      {"#cc79a7", "8 3 2 3"},
                                      {"#1a1a1a", "none"},
                                      {"#e69f00", "4 2"}}};

std::string line_attributes(const CurveSeries& series, std::size_t index) {
  const Look& look = kLooks[index % kLooks.size()];
  const bool is_long = series.points.size() > kDashedPointsMax;
  const std::string_view dashes = is_long ? "none" : look.dashes;
  return "stroke=\"" + std::string(look.colour) + "\" stroke-width=\"" + (is_long ? "1" : "1.5") +
         "\" stroke-linejoin=\"round\" stroke-dasharray=\"" + std::string(dashes) + '"';
}

void draw_marker(SvgWriter& svg, const core::Point2& p, std::size_t series) {
  const std::string colour(kLooks[series % kLooks.size()].colour);
  const std::string fill = "fill=\"" + colour + '"';
  const std::string hollow = "fill=\"#ffffff\" stroke=\"" + colour + "\" stroke-width=\"1.3\"";
  PathData cross;
  switch (series % 4) {
    case 0:
      svg.circle(p, 2.8, fill);
      break;
    case 1:
      svg.rect(box_around(p, 2.5), fill);
      break;
    case 2:
      svg.circle(p, 2.8, hollow);
      break;
    default:
      cross.plus(p, 3.4);
      svg.path(cross, "stroke=\"" + colour + "\" stroke-width=\"1.4\"");
  }
}

// Markers on a line are thinned when they would hide it; without a line they are the data, and all drawn.
std::size_t marker_stride(const CurveSeries& series) {
  if (series.style == CurveStyle::Markers) return 1;
  return std::max<std::size_t>(1, (series.points.size() + kMarkersMax - 1) / kMarkersMax);
}

void draw_line(SvgWriter& svg, const CurveSeries& series, const CurveFrame& frame, std::size_t index) {
  PathData data;
  bool is_broken = true;
  for (const core::Point2& point : series.points) {
    const bool can_draw = is_drawable(point, frame.y_scale);
    if (can_draw && is_broken) data.move_to(frame.to_px(point));
    if (can_draw && !is_broken) data.line_to(frame.to_px(point));
    is_broken = !can_draw;
  }
  svg.path(data, line_attributes(series, index));
}

void draw_series(SvgWriter& svg, const CurveSeries& series, const CurveFrame& frame, std::size_t index) {
  if (series.style != CurveStyle::Markers) draw_line(svg, series, frame, index);
  if (series.style == CurveStyle::Line) return;
  for (std::size_t i = 0; i < series.points.size(); i += marker_stride(series)) {
    if (is_drawable(series.points[i], frame.y_scale)) draw_marker(svg, frame.to_px(series.points[i]), index);
  }
}

// Returns the y of the lower end.
double draw_legend(SvgWriter& svg, const CurvePlot& plot, const core::Point2& corner_px, double width_px) {
  core::Point2 at = corner_px;
  bool is_empty = true;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const CurveSeries& series = plot.series[i];
    if (series.name.empty()) continue;
    const double entry_px = kSample_px + 8.0 + text_width_px(series.name, 11.0) + 18.0;
    if (!is_empty && at.x() + entry_px > corner_px.x() + width_px) {
      at = {corner_px.x(), at.y() + kLegendRow_px};
    }
    const core::Point2 middle = at + core::Point2(0.5 * kSample_px, 0.5 * kLegendRow_px);
    const core::Point2 half{0.5 * kSample_px, 0.0};
    if (series.style != CurveStyle::Markers) {
      svg.line(middle - half, middle + half, line_attributes(series, i));
    }
    if (series.style != CurveStyle::Line) draw_marker(svg, middle, i);
    svg.text(at + core::Point2(kSample_px + 8.0, 0.5 * kLegendRow_px + 4.0), series.name, "fill=\"#1a1a1a\"");
    at.x() += entry_px;
    is_empty = false;
  }
  return is_empty ? corner_px.y() : at.y() + kLegendRow_px;
}

}  // namespace

std::string draw_curve(const CurvePlot& plot) {
  SvgWriter svg;
  const double width_px = frame_curve(plot, core::Point2::Zero()).area.width();
  const double heading_end = draw_heading(svg, plot.title, plot.summary, {kLeft_px, kTop_px}, width_px);
  const double legend_end = draw_legend(svg, plot, {kLeft_px, heading_end + 4.0}, width_px);
  const CurveFrame frame = frame_curve(plot, {kLeft_px, legend_end + 6.0});
  draw_curve_axes(svg, plot, frame);
  for (std::size_t i = 0; i < plot.series.size(); ++i) draw_series(svg, plot.series[i], frame, i);
  return svg.finish(kLeft_px + width_px + kRight_px, frame.area.bottom + kBelowAxis_px);
}

}  // namespace slamsensor::tools
