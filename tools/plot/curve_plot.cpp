#include "tools/plot/curve_plot.hpp"

#include "tools/output/text_output.hpp"
#include "tools/plot/scales.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
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

namespace {

constexpr double kWidth_px = 560.0;
constexpr double kHeight_px = 340.0;
constexpr double kTicksWanted = 8.0;  // a full turn has one each 50 degrees
constexpr double kTick_px = 4.0;
// A linear axis begins at zero when the lowest value is below this share of the highest.
constexpr double kZeroShare = 0.6;
constexpr double kSlack = 1e-9;
constexpr double kRoomAbove = 0.05;  // of a step, about the size of a marker

struct Limits {
  double low;
  double high;
  double step;
};

// A range without extent gets some, in proportion to its value.
Limits with_extent(double low, double high) {
  const double least = std::max({1e-9, 1e-6 * std::abs(low), 1e-6 * std::abs(high)});
  if (high - low > least) return {low, high, 1.0};
  const double half = low == 0.0 ? 1.0 : 0.5 * std::abs(low);
  return {low - half, high + half, 1.0};
}

double tick_step(const Limits& limits, double step_min) {
  return std::max(step_min, round_step_up((limits.high - limits.low) / kTicksWanted));
}

Limits round_limits(double low, double high, double step_min) {
  Limits limits = with_extent(low, high);
  limits.step = tick_step(limits, step_min);
  limits.low = limits.step * std::floor(limits.low / limits.step + kSlack);
  limits.high = limits.step * std::ceil(limits.high / limits.step - kSlack);
  // A curve along the upper edge cannot be seen.
  if (limits.high - high < kRoomAbove * limits.step) limits.high += limits.step;
  return limits;
}

// x keeps its own range with a little room: rounding it up could leave half of the chart empty.
Limits x_limits(double low, double high, double step_min) {
  const Limits limits = with_extent(low, high);
  const double room = 0.03 * (limits.high - limits.low);
  return {limits.low - room, limits.high + room, tick_step(limits, step_min)};
}

Limits y_limits(double low, double high, const CurvePlot& plot) {
  if (plot.y_scale == AxisScale::Linear) {
    return round_limits(low >= 0.0 && low < kZeroShare * high ? 0.0 : low, high, plot.y_step_min);
  }
  const double room = std::max(0.05, 0.06 * (high - low));
  Limits limits{low - room, high + room, 1.0};
  // At least one power of ten, so that there is a tick to read from.
  if (limits.high - limits.low < 1.0) limits = {std::floor(limits.low), std::ceil(limits.high), 1.0};
  return limits;
}

Eigen::AlignedBox2d extent(const CurvePlot& plot) {
  Eigen::AlignedBox2d box;
  for (const CurveSeries& series : plot.series) {
    for (const core::Point2& point : series.points) {
      if (!is_drawable(point, plot.y_scale)) continue;
      const bool is_log = plot.y_scale == AxisScale::Logarithmic;
      box.extend(core::Point2(point.x(), is_log ? std::log10(point.y()) : point.y()));
    }
  }
  if (box.isEmpty()) return Eigen::AlignedBox2d(core::Point2(0.0, 0.0), core::Point2(1.0, 1.0));
  return box;
}

enum class LogText : std::uint8_t { Plain, Powers };

// All ticks of an axis are written in the same way.
LogText log_text(const std::vector<LogTick>& ticks) {
  const bool is_plain = std::all_of(ticks.begin(), ticks.end(), [](const LogTick& tick) {
    return tick.exponent >= -3 && tick.exponent <= 5;
  });
  return is_plain ? LogText::Plain : LogText::Powers;
}

void write_log_value(SvgWriter& svg, const core::Point2& at, const LogTick& tick, LogText style) {
  constexpr std::string_view kEnd = "text-anchor=\"end\"";
  if (style == LogText::Plain) {
    svg.text(at, fixed_text(tick.value, std::max(0, -tick.exponent)), kEnd);
    return;
  }
  const std::string factor = tick.factor == 1 ? "" : std::to_string(tick.factor) + "\xC2\xB7";
  svg.power(at, factor + "10", std::to_string(tick.exponent), kEnd);
}

// Returns the ticks' heights.
std::vector<double> write_y_values(SvgWriter& svg, const CurveFrame& frame) {
  std::vector<double> heights;
  const auto at = [&](double value) {
    heights.push_back(frame.to_px({0.0, value}).y());
    return core::Point2(frame.area.left - 7.0, heights.back() + 4.0);
  };
  if (frame.y_scale == AxisScale::Logarithmic) {
    const auto ticks = log_ticks(std::pow(10.0, frame.low.y()), std::pow(10.0, frame.high.y()));
    for (const LogTick& tick : ticks) write_log_value(svg, at(tick.value), tick, log_text(ticks));
  } else {
    for (const double y : linear_ticks(frame.low.y(), frame.high.y(), frame.y_step)) {
      svg.text(at(y), tick_text(y, frame.y_step), "text-anchor=\"end\"");
    }
  }
  return heights;
}

}  // namespace

core::Point2 CurveFrame::to_px(const core::Point2& value) const {
  const double y = y_scale == AxisScale::Logarithmic ? std::log10(value.y()) : value.y();
  return {area.left + (value.x() - low.x()) / (high.x() - low.x()) * area.width(),
          area.bottom - (y - low.y()) / (high.y() - low.y()) * area.height()};
}

bool is_drawable(const core::Point2& point, AxisScale y_scale) {
  return point.allFinite() && (y_scale == AxisScale::Linear || point.y() > 0.0);
}

CurveFrame frame_curve(const CurvePlot& plot, const core::Point2& corner_px) {
  const Eigen::AlignedBox2d box = extent(plot);
  const Limits x = x_limits(box.min().x(), box.max().x(), plot.x_step_min);
  const Limits y = y_limits(box.min().y(), box.max().y(), plot);
  CurveFrame frame;
  frame.area = {corner_px.x(), corner_px.y(), corner_px.x() + kWidth_px, corner_px.y() + kHeight_px};
  frame.low = {x.low, y.low};
  frame.high = {x.high, y.high};
  frame.y_scale = plot.y_scale;
  frame.x_step = x.step;
  frame.y_step = y.step;
  return frame;
}

void draw_curve_axes(SvgWriter& svg, const CurvePlot& plot, const CurveFrame& frame) {
  const PixelBox& area = frame.area;
  PathData grid;
  PathData ticks;
  svg.open_group("fill=\"" + std::string(kInk) + '"');
  for (const double x : linear_ticks(frame.low.x(), frame.high.x(), frame.x_step)) {
    const double x_px = area.left + (x - frame.low.x()) / (frame.high.x() - frame.low.x()) * area.width();
    grid.segment({x_px, area.top}, {x_px, area.bottom});
    ticks.segment({x_px, area.bottom}, {x_px, area.bottom + kTick_px});
    svg.text({x_px, area.bottom + 16.0}, tick_text(x, frame.x_step), "text-anchor=\"middle\"");
  }
  for (const double y_px : write_y_values(svg, frame)) {
    grid.segment({area.left, y_px}, {area.right, y_px});
    ticks.segment({area.left - kTick_px, y_px}, {area.left, y_px});
  }
  constexpr std::string_view kTitle = "font-size=\"12\" text-anchor=\"middle\"";
  svg.text({0.5 * (area.left + area.right), area.bottom + 34.0}, plot.x_label, kTitle);
  const std::string middle = fixed_text(0.5 * (area.top + area.bottom), 2);
  svg.text({0.0, 0.0}, plot.y_label,
           "transform=\"translate(16 " + middle + ") rotate(-90)\" " + std::string(kTitle));
  svg.close_group();
  svg.path(grid, stroke(kGrid, 0.8));
  svg.path(ticks, stroke(kInk, 0.9));
  svg.rect(area, stroke(kInk, 0.9));
}

}  // namespace slamsensor::tools
