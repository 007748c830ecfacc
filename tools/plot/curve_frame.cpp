#include "tools/plot/curve_frame.hpp"

#include "tools/output/number_text.hpp"
#include "tools/plot/axis_ticks.hpp"
#include "tools/plot/palette.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr double kWidth_px = 560.0;
constexpr double kHeight_px = 340.0;
constexpr double kTicksWanted = 7.0;
constexpr double kTick_px = 4.0;
// A linear axis begins at zero when the lowest value is below this share of the highest.
constexpr double kZeroShare = 0.6;
constexpr double kSlack = 1e-9;

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

Limits round_limits(double low, double high) {
  Limits limits = with_extent(low, high);
  limits.step = round_step_up((limits.high - limits.low) / kTicksWanted);
  limits.low = limits.step * std::floor(limits.low / limits.step + kSlack);
  limits.high = limits.step * std::ceil(limits.high / limits.step - kSlack);
  return limits;
}

// x keeps its own range with a little room: rounding it up could leave half of the chart empty.
Limits x_limits(double low, double high) {
  Limits limits = with_extent(low, high);
  limits.step = round_step_up((limits.high - limits.low) / kTicksWanted);
  const double room = 0.03 * (limits.high - limits.low);
  return {limits.low - room, limits.high + room, limits.step};
}

Limits y_limits(double low, double high, AxisScale scale) {
  if (scale == AxisScale::Linear) {
    return round_limits(low >= 0.0 && low < kZeroShare * high ? 0.0 : low, high);
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

std::string stroke(std::string_view colour, std::string_view width) {
  return "stroke=\"" + std::string(colour) + "\" stroke-width=\"" + std::string(width) + '"';
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
  const Limits x = x_limits(box.min().x(), box.max().x());
  const Limits y = y_limits(box.min().y(), box.max().y(), plot.y_scale);
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
  const Box& area = frame.area;
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
  svg.path(grid, stroke(kGrid, "0.8"));
  svg.path(ticks, stroke(kInk, "0.9"));
  svg.rect(area, stroke(kInk, "0.9"));
}

}  // namespace slamsensor::tools
