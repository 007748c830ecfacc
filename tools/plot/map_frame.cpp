#include "tools/plot/map_frame.hpp"

#include "tools/output/number_text.hpp"
#include "tools/plot/axis_ticks.hpp"
#include "tools/plot/palette.hpp"
#include "tools/plot/xml_text.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr double kRangeMin_m = 1.0;
constexpr double kRoom = 0.05;
constexpr double kTickSpacing_px = 64.0;
constexpr double kTick_px = 4.0;
constexpr double kTickText_px = 11.0;
constexpr double kTickGap_px = 7.0;
constexpr double kAxisTitle_px = 28.0;

bool is_finite(const core::Pose2& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.heading_rad);
}

Eigen::AlignedBox2d extent(const MapPlot& plot) {
  Eigen::AlignedBox2d box;
  for (const PlotLandmark& landmark : plot.landmarks) box.extend(landmark.position_W);
  for (const core::Pose2& pose : plot.truth_W) box.extend(pose.translation());
  for (const PlotPose& pose : plot.poses) {
    if (pose.status != core::FixStatus::NoFix) box.extend(pose.pose_W.translation());
  }
  if (box.isEmpty()) box.extend(core::Point2::Zero().eval());
  return box;
}

MapFrame frame_box(const Eigen::AlignedBox2d& box, const FrameSize& size) {
  const double room_m = kRoom * std::max(box.sizes().maxCoeff(), kRangeMin_m);
  core::Point2 range_m = (box.sizes() + core::Point2::Constant(2.0 * room_m)).cwiseMax(kRangeMin_m);
  MapFrame frame;
  frame.px_per_m = size.max_px.cwiseQuotient(range_m).minCoeff();
  // A long and narrow map gets room across, so that axes and labels keep theirs.
  range_m = range_m.cwiseMax(size.min_px / frame.px_per_m);
  frame.low_W = box.center() - 0.5 * range_m;
  frame.high_W = box.center() + 0.5 * range_m;
  frame.area = {0.0, 0.0, range_m.x() * frame.px_per_m, range_m.y() * frame.px_per_m};
  return frame;
}

std::string stroke(std::string_view colour, std::string_view width) {
  return "stroke=\"" + std::string(colour) + "\" stroke-width=\"" + std::string(width) + '"';
}

}  // namespace

MapPlot drawable(const MapPlot& plot) {
  MapPlot result = plot;
  std::erase_if(result.landmarks,
                [](const PlotLandmark& landmark) { return !landmark.position_W.allFinite(); });
  std::erase_if(result.truth_W, [](const core::Pose2& pose) { return !is_finite(pose); });
  // A pose that cannot be drawn stays as a scan without a fix, so that the path is broken there.
  for (PlotPose& pose : result.poses) {
    if (!is_finite(pose.pose_W)) pose.status = core::FixStatus::NoFix;
  }
  return result;
}

MapFrame frame_map(const MapPlot& plot, const FrameSize& size) {
  return frame_box(extent(plot), size);
}

MapFrame frame_fixes(const MapPlot& plot, const FrameSize& size) {
  Eigen::AlignedBox2d box;
  for (const PlotPose& pose : plot.poses) {
    if (pose.status == core::FixStatus::Fix) box.extend(pose.pose_W.translation());
  }
  return frame_box(box, size);
}

MapFrame moved_to(const MapFrame& frame, const core::Point2& corner_px) {
  MapFrame moved = frame;
  moved.area = {corner_px.x(), corner_px.y(), corner_px.x() + frame.area.width(),
                corner_px.y() + frame.area.height()};
  return moved;
}

double left_margin_px(const MapFrame& frame) {
  const double step_m = round_step_up(kTickSpacing_px / frame.px_per_m);
  double widest_px = 0.0;
  for (const double y : linear_ticks(frame.low_W.y(), frame.high_W.y(), step_m)) {
    widest_px = std::max(widest_px, text_width_px(tick_text(y, step_m), kTickText_px));
  }
  return widest_px + kTickGap_px + kAxisTitle_px;
}

void draw_map_axes(SvgWriter& svg, const MapFrame& frame) {
  const Box& area = frame.area;
  const double step_m = round_step_up(kTickSpacing_px / frame.px_per_m);
  const std::vector<double> xs = linear_ticks(frame.low_W.x(), frame.high_W.x(), step_m);
  const std::vector<double> ys = linear_ticks(frame.low_W.y(), frame.high_W.y(), step_m);
  PathData grid;
  PathData ticks;
  svg.open_group("fill=\"" + std::string(kInk) + '"');
  for (const double x : xs) {
    const double x_px = frame.to_px({x, 0.0}).x();
    grid.segment({x_px, area.top}, {x_px, area.bottom});
    ticks.segment({x_px, area.bottom}, {x_px, area.bottom + kTick_px});
    svg.text({x_px, area.bottom + 16.0}, tick_text(x, step_m), "text-anchor=\"middle\"");
  }
  for (const double y : ys) {
    const double y_px = frame.to_px({0.0, y}).y();
    grid.segment({area.left, y_px}, {area.right, y_px});
    ticks.segment({area.left - kTick_px, y_px}, {area.left, y_px});
    svg.text({area.left - kTickGap_px, y_px + 4.0}, tick_text(y, step_m), "text-anchor=\"end\"");
  }
  const core::Point2 middle{0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)};
  svg.text({middle.x(), area.bottom + 33.0}, "x (m)", "font-size=\"12\" text-anchor=\"middle\"");
  const std::string turned = "transform=\"translate(" +
                             fixed_text(area.left - left_margin_px(frame) + 14.0, 2) + " " +
                             fixed_text(middle.y(), 2) + ") rotate(-90)\"";
  svg.text({0.0, 0.0}, "y (m)", turned + " font-size=\"12\" text-anchor=\"middle\"");
  svg.close_group();
  svg.path(grid, stroke(kGrid, "0.8"));
  svg.path(ticks, stroke(kInk, "0.9"));
  svg.rect(area, stroke(kInk, "0.9"));
}

}  // namespace slamsensor::tools
