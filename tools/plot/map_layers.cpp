#include "tools/plot/map_layers.hpp"

#include "tools/output/number_text.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr double kSmallestPose_px = 1.4;

std::string attribute(std::string_view name, double value) {
  return ' ' + std::string(name) + "=\"" + fixed_text(value, 2) + '"';
}

std::string stroke(std::string_view colour, double width_px) {
  return "stroke=\"" + std::string(colour) + '"' + attribute("stroke-width", width_px);
}

double median_spacing_px(const std::vector<PoseMark>& poses) {
  std::vector<double> spacings;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    spacings.push_back((poses[i].at_px - poses[i - 1].at_px).norm());
  }
  if (spacings.empty()) return 100.0;
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

core::Point2 heading_end(const PoseMark& pose, double length_px) {
  return {pose.at_px.x() + length_px * std::cos(pose.heading_rad),
          pose.at_px.y() - length_px * std::sin(pose.heading_rad)};
}

// Only as many as stay apart from each other along the path.
void draw_headings(SvgWriter& svg, const std::vector<PoseMark>& poses, const MarkSizes& sizes) {
  PathData data;
  const PoseMark* previous = nullptr;
  for (const PoseMark& pose : poses) {
    const bool is_end = &pose == &poses.back();
    if (!is_end && previous && (pose.at_px - previous->at_px).norm() < sizes.heading_spacing_px) continue;
    data.segment(pose.at_px, heading_end(pose, sizes.heading_px));
    previous = &pose;
  }
  svg.path(data, stroke(kHeadingColour, 1.3));
}

void draw_line(SvgWriter& svg, const std::vector<PoseMark>& poses) {
  PathData data;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (!poses[i].follows_fix) continue;
    if (i == 1 || !poses[i - 1].follows_fix) data.move_to(poses[i - 1].at_px);
    data.line_to(poses[i].at_px);
  }
  svg.path(data, stroke(kPathColour, 1.1) + " stroke-linejoin=\"round\"");
}

void draw_dot(SvgWriter& svg, const PoseMark& pose, double radius_px) {
  if (pose.is_fix) {
    svg.circle(pose.at_px, radius_px, "fill=\"" + std::string(kPathColour) + '"');
  } else {
    svg.circle(pose.at_px, std::max(radius_px, 2.2), "fill=\"#ffffff\" " + stroke(kPathColour, 1.0));
  }
}

}  // namespace

std::vector<PoseMark> pose_marks(const MapPlot& plot, const MapFrame& frame) {
  std::vector<PoseMark> marks;
  bool previous_is_fix = false;
  for (const PlotPose& pose : plot.poses) {
    const bool is_fix = pose.status == core::FixStatus::Fix;
    if (pose.status != core::FixStatus::NoFix) {
      marks.push_back({frame.to_px(pose.pose_W.translation()), pose.pose_W.heading_rad, pose.number, is_fix,
                       is_fix && previous_is_fix});
    }
    previous_is_fix = is_fix;
  }
  return marks;
}

MarkSizes mark_sizes(const MapPlot& plot, const MapFrame& frame, const std::vector<PoseMark>& poses) {
  MarkSizes sizes;
  const double area_px2 = frame.area.width() * frame.area.height();
  const double room_px =
      std::sqrt(area_px2 / std::max<double>(1.0, static_cast<double>(plot.landmarks.size())));
  sizes.cross_half_px = std::clamp(0.17 * room_px, 1.4, 4.0);
  sizes.cross_stroke_px = std::clamp(0.3 * sizes.cross_half_px, 0.7, 1.3);
  const double spacing_px = median_spacing_px(poses);
  sizes.spacing_px = spacing_px;
  sizes.pose_px = std::clamp(0.3 * spacing_px, 0.0, 2.6);
  if (sizes.pose_px < kSmallestPose_px) sizes.pose_px = 0.0;
  sizes.heading_px = std::clamp(1.1 * spacing_px, 7.0, 11.0);
  sizes.heading_spacing_px = sizes.pose_px > 0.0 ? 9.0 : 22.0;
  return sizes;
}

void draw_landmarks(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame, const MarkSizes& sizes) {
  unsigned max_xi = 0;
  for (const PlotLandmark& landmark : plot.landmarks) max_xi = std::max(max_xi, landmark.xi);
  const std::vector<XiClass> classes = xi_classes(max_xi);
  std::vector<PathData> paths(classes.size());
  const std::uint64_t width = classes.front().last + 1;
  for (const PlotLandmark& landmark : plot.landmarks) {
    paths[landmark.xi / width].plus(frame.to_px(landmark.position_W), sizes.cross_half_px);
  }
  for (std::size_t i = 0; i < classes.size(); ++i) {
    svg.path(paths[i], stroke(classes[i].colour, sizes.cross_stroke_px));
  }
}

void draw_matches(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame, const MarkSizes& sizes,
                  const std::vector<PoseMark>& poses) {
  if (poses.empty()) return;
  PathData rays;
  svg.open_group(stroke(kMatchColour, 1.1));
  for (const PlotLandmark& landmark : plot.landmarks) {
    if (!landmark.matched) continue;
    const core::Point2 at_px = frame.to_px(landmark.position_W);
    rays.segment(poses.back().at_px, at_px);
    svg.circle(at_px, sizes.cross_half_px + 2.0);
  }
  svg.path(rays, "stroke-width=\"0.7\" stroke-opacity=\"0.75\"");
  svg.close_group();
}

void draw_truth(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame) {
  PathData data;
  for (const core::Pose2& pose : plot.truth_W) {
    const core::Point2 at_px = frame.to_px(pose.translation());
    if (data.empty()) {
      data.move_to(at_px);
    } else {
      data.line_to(at_px);
    }
  }
  svg.path(data, stroke(kTruthColour, 1.1) + " stroke-dasharray=\"4 2.5\"");
}

void draw_poses(SvgWriter& svg, const std::vector<PoseMark>& poses, const MarkSizes& sizes) {
  if (poses.empty()) return;
  draw_line(svg, poses);
  draw_headings(svg, poses, sizes);
  for (const PoseMark& pose : poses) {
    if (sizes.pose_px > 0.0 || !pose.is_fix) draw_dot(svg, pose, sizes.pose_px);
  }
  const std::string_view first_fill = poses.front().is_fix ? kPathColour : "#ffffff";
  svg.rect(box_around(poses.front().at_px, 3.2),
           "fill=\"" + std::string(first_fill) + "\" " + stroke(kPathColour, 1.0));
  draw_dot(svg, poses.back(), 3.8);
}

}  // namespace slamsensor::tools
