#include "tools/plot/map_plot.hpp"

#include "tools/plot/heading_text.hpp"
#include "tools/plot/map_frame.hpp"
#include "tools/plot/map_labels.hpp"
#include "tools/plot/map_layers.hpp"
#include "tools/plot/map_legend.hpp"
#include "tools/plot/palette.hpp"
#include "tools/plot/svg_writer.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <optional>

namespace slamsensor::tools {
namespace {

constexpr double kMargin_px = 12.0;
constexpr double kLegendGap_px = 22.0;
constexpr double kBelowAxis_px = 44.0;
// A path smaller than this share of the map, with poses closer than this, is shown larger beside it.
constexpr double kDetailShare = 0.4;
constexpr double kCrowded_px = 14.0;

FrameSize size_beside_detail() {
  return {{560.0, 560.0}, {340.0, 300.0}};
}

FrameSize size_of_detail(const MapFrame& map) {
  return {{400.0, map.area.height()}, {280.0, std::min(280.0, map.area.height())}};
}

// The path is so small a part of the map that its poses cannot be told apart there.
bool needs_detail(const MapPlot& plot, const MapFrame& map) {
  const std::vector<PoseMark> poses = pose_marks(plot, map);
  Eigen::AlignedBox2d path;
  for (const PoseMark& pose : poses) {
    if (pose.is_fix) path.extend(pose.at_px);
  }
  if (path.isEmpty() || poses.size() < 3) return false;
  const bool is_small = path.sizes().x() < kDetailShare * map.area.width() &&
                        path.sizes().y() < kDetailShare * map.area.height();
  return is_small && path.sizes().maxCoeff() > 1.0 && mark_sizes(plot, map, poses).spacing_px < kCrowded_px;
}

void draw_panel(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame, std::string_view name,
                Numbers numbers) {
  const std::vector<PoseMark> poses = pose_marks(plot, frame);
  const MarkSizes sizes = mark_sizes(plot, frame, poses);
  draw_map_axes(svg, frame);
  svg.open_clipped_group(frame.area, name);
  draw_landmarks(svg, plot, frame, sizes);
  draw_matches(svg, plot, frame, sizes, poses);
  draw_poses(svg, poses, sizes);
  draw_truth(svg, plot, frame);
  draw_labels(svg, plot, frame, sizes, poses, numbers);
  svg.close_group();
}

// The part of the map that the detail shows, in the map.
void draw_outline(SvgWriter& svg, const MapFrame& map, const MapFrame& detail) {
  const core::Point2 low = map.to_px(detail.low_W);
  const core::Point2 high = map.to_px(detail.high_W);
  svg.rect({low.x(), high.y(), high.x(), low.y()},
           "stroke=\"" + std::string(kSoftInk) + "\" stroke-width=\"0.8\"");
}

struct Panels {
  MapFrame map;
  std::optional<MapFrame> detail;
  double width_px = 0.0;  // of the whole picture
};

// All panels at their places across, their tops at `top_px`.
Panels lay_out(const MapPlot& plot, double top_px) {
  Panels panels;
  panels.map = frame_map(plot, {});
  const bool has_detail = needs_detail(plot, panels.map);
  if (has_detail) panels.map = frame_map(plot, size_beside_detail());
  panels.map = moved_to(panels.map, {left_margin_px(panels.map), top_px});
  double right_px = panels.map.area.right;
  if (has_detail) {
    const MapFrame detail = frame_fixes(plot, size_of_detail(panels.map));
    panels.detail = moved_to(detail, {right_px + kMargin_px + left_margin_px(detail), top_px});
    right_px = panels.detail->area.right;
  }
  panels.width_px = right_px + kLegendGap_px + kLegendWidth_px;
  return panels;
}

// The landmarks that `frame` shows; with fewer of them there is room for larger crosses and for their xi.
MapPlot shown_in(const MapFrame& frame, const MapPlot& plot) {
  MapPlot part = plot;
  const Eigen::AlignedBox2d box(frame.low_W, frame.high_W);
  std::erase_if(part.landmarks, [&](const PlotLandmark& landmark) {
    return !landmark.matched && !box.contains(landmark.position_W);
  });
  return part;
}

}  // namespace

std::string draw_map(const MapPlot& plot) {
  const MapPlot shown = drawable(plot);
  SvgWriter svg;
  // The width of the panels decides how the heading wraps, and the heading's height where the panels begin.
  const Panels across = lay_out(shown, 0.0);
  const double left_px = across.map.area.left;
  const double heading_end = draw_heading(svg, plot.title, plot.summary, {left_px, kMargin_px},
                                          across.width_px - left_px - kMargin_px);
  const Panels panels = lay_out(shown, heading_end + kMargin_px);
  draw_panel(svg, shown, panels.map, "map", panels.detail ? Numbers::Ends : Numbers::All);
  if (panels.detail) {
    draw_outline(svg, panels.map, *panels.detail);
    draw_panel(svg, shown_in(*panels.detail, shown), *panels.detail, "detail", Numbers::All);
  }
  const core::Point2 legend{panels.width_px - kLegendWidth_px, panels.map.area.top};
  const double legend_end = draw_map_legend(svg, shown, panels.map, legend);
  return svg.finish(panels.width_px,
                    std::max(panels.map.area.bottom + kBelowAxis_px, legend_end + kMargin_px));
}

}  // namespace slamsensor::tools
