#include "tools/plot/map_plot.hpp"

#include "tools/output/text_output.hpp"
#include "tools/plot/scales.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace slamsensor::tools {
namespace {

/// A pose to be drawn.
struct PoseMark {
  core::Point2 at_px = core::Point2::Zero();
  double heading_rad = 0.0;
  std::int64_t number = 0;
  bool is_fix = true;        ///< else ambiguous
  bool follows_fix = false;  ///< it and the scan before it are fixes: a line joins them
};

/// Sizes of the marks, px, smaller where there is more to draw.
struct MarkSizes {
  double cross_half_px = 4.0;
  double cross_stroke_px = 1.2;
  double pose_px = 2.6;             ///< radius; 0 where poses are so close that only the path is drawn
  double heading_px = 11.0;         ///< length of its tick
  double heading_spacing_px = 9.0;  ///< at least, between two ticks along the path
  double spacing_px = 100.0;        ///< median, between poses
};

constexpr double kSmallestPose_px = 1.4;

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
  svg.path(data, stroke(kInk, 1.1) + " stroke-linejoin=\"round\"");
}

void draw_dot(SvgWriter& svg, const PoseMark& pose, double radius_px) {
  if (pose.is_fix) {
    svg.circle(pose.at_px, radius_px, "fill=\"" + std::string(kInk) + '"');
  } else {
    svg.circle(pose.at_px, std::max(radius_px, 2.2), "fill=\"#ffffff\" " + stroke(kInk, 1.0));
  }
}

/// The poses of `plot` that have a place, in order.
std::vector<PoseMark> pose_marks(const MapPlot& plot, const MapPanel& frame) {
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

MarkSizes mark_sizes(const MapPlot& plot, const MapPanel& frame, const std::vector<PoseMark>& poses) {
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

/// All landmarks as crosses, one path per class of xi.
void draw_landmarks(SvgWriter& svg, const MapPlot& plot, const MapPanel& frame, const MarkSizes& sizes) {
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

/// Lines from the last pose to the landmarks it matched, and a ring around each.
void draw_matches(SvgWriter& svg, const MapPlot& plot, const MapPanel& frame, const MarkSizes& sizes,
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

/// The true path, thin and dashed.
void draw_truth(SvgWriter& svg, const MapPlot& plot, const MapPanel& frame) {
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

/// The path, its poses and their headings; the first pose as a square, the last larger, ambiguous ones
/// hollow.
void draw_poses(SvgWriter& svg, const std::vector<PoseMark>& poses, const MarkSizes& sizes) {
  if (poses.empty()) return;
  draw_line(svg, poses);
  draw_headings(svg, poses, sizes);
  for (const PoseMark& pose : poses) {
    if (sizes.pose_px > 0.0 || !pose.is_fix) draw_dot(svg, pose, sizes.pose_px);
  }
  const std::string_view first_fill = poses.front().is_fix ? kInk : "#ffffff";
  svg.rect(box_around(poses.front().at_px, 3.2),
           "fill=\"" + std::string(first_fill) + "\" " + stroke(kInk, 1.0));
  draw_dot(svg, poses.back(), 3.8);
}

/// Which poses are numbered.
enum class Numbers : std::uint8_t { All, Ends };

constexpr double kNumber_px = 10.0;
constexpr double kDigitHeight = 0.85;  // of the size of the font: what digits take above the base line
constexpr std::size_t kNumbersMax = 60;
constexpr double kNumberSpacing_px = 24.0;  // along the path, between two numbers
constexpr double kNumberGap_px = 4.0;       // between two numbers side by side
constexpr double kFarthest_px = 60.0;       // from a pose to its number
constexpr double kLeader_px = 9.0;  // a number farther than this from its pose is tied to it by a line

struct Label {
  PixelBox box;
  core::Point2 anchor_px = core::Point2::Zero();
  std::string words;
};

/// Where `words` stand beside `anchor_px`: in `area`, off all other labels, as near as can be, up and to the
/// right first.
std::optional<PixelBox> place(const std::vector<Label>& labels, const PixelBox& area,
                              const core::Point2& anchor_px, const std::string& words) {
  const core::Point2 half{0.5 * (text_width_px(words, kNumber_px) + kNumberGap_px),
                          0.5 * kDigitHeight * kNumber_px};
  for (double gap_px = 4.5; gap_px <= kFarthest_px; gap_px += half.y()) {
    for (int eighth = 0; eighth < 8; ++eighth) {
      const double angle_rad = 0.25 * std::numbers::pi * (1.0 + eighth);
      const core::Point2 off{std::cos(angle_rad) * (half.x() + gap_px),
                             -std::sin(angle_rad) * (half.y() + gap_px)};
      const core::Point2 middle = anchor_px + off;
      const PixelBox box{middle.x() - half.x(), middle.y() - half.y(), middle.x() + half.x(),
                         middle.y() + half.y()};
      const bool is_free = std::none_of(labels.begin(), labels.end(),
                                        [&](const Label& other) { return other.box.overlaps(box); });
      if (is_free && area.contains(box)) {
        return box;
      }
    }
  }
  return std::nullopt;
}

void number(std::vector<Label>& labels, const PixelBox& area, const PoseMark& pose) {
  const std::string words = std::to_string(pose.number);
  if (const std::optional<PixelBox> box = place(labels, area, pose.at_px, words)) {
    labels.push_back({*box, pose.at_px, words});
  }
}

/// The first and the last pose, then every so many (1, 2, 5, 10, ...) that the numbers keep their distance.
std::vector<Label> number_poses(const PixelBox& area, const std::vector<PoseMark>& poses, double spacing_px,
                                Numbers numbers) {
  std::vector<Label> labels;
  if (!poses.empty()) {
    number(labels, area, poses.front());
  }
  if (poses.size() > 1) {
    number(labels, area, poses.back());
  }
  if (numbers == Numbers::Ends || poses.size() < 3) {
    return labels;
  }
  const double least = std::max(kNumberSpacing_px / std::max(spacing_px, 1e-3),
                                static_cast<double>(poses.size()) / static_cast<double>(kNumbersMax));
  const auto step = static_cast<std::int64_t>(round_step_up(std::clamp(least, 1.0, 1e9)));
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    if (poses[i].number % step == 0) {
      number(labels, area, poses[i]);
    }
  }
  return labels;
}

void write(SvgWriter& svg, const Label& label) {
  const core::Point2 nearest{std::clamp(label.anchor_px.x(), label.box.left, label.box.right),
                             std::clamp(label.anchor_px.y(), label.box.top, label.box.bottom)};
  if ((nearest - label.anchor_px).norm() > kLeader_px) {
    svg.line(label.anchor_px, nearest, stroke(kSoftInk, 0.6));
  }
  svg.text({0.5 * (label.box.left + label.box.right), label.box.bottom - 0.6}, label.words);
}

/// Writes scan numbers beside poses. No two overlap. The numbers of the first and the last pose are always
/// there; of the others, if asked for, the multiples of a round step that find a place.
void draw_labels(SvgWriter& svg, const MapPanel& frame, const MarkSizes& sizes,
                 const std::vector<PoseMark>& poses, Numbers numbers) {
  svg.open_group(
      "font-size=\"10\" text-anchor=\"middle\" fill=\"" + std::string(kInk) +
      "\" stroke=\"#ffffff\" stroke-width=\"2.4\" stroke-linejoin=\"round\" paint-order=\"stroke\"");
  for (const Label& label : number_poses(frame.area, poses, sizes.spacing_px, numbers)) write(svg, label);
  svg.close_group();
}

/// Width of the strip that the legend needs, px.
inline constexpr double kLegendWidth_px = 164.0;

constexpr double kRow_px = 19.0;
constexpr double kSample_px = 26.0;
constexpr double kSwatchWidth_px = 16.0;
constexpr double kSwatchHeight_px = 13.0;

// Writes the key from top to bottom.
class Key {
 public:
  Key(SvgWriter& svg, const core::Point2& corner_px) : svg_(svg), left_(corner_px.x()), y_(corner_px.y()) {}

  // The middle of the row's sample; the row is done.
  core::Point2 row(std::string_view words) {
    const core::Point2 middle{left_ + 0.5 * kSample_px, y_ + 0.5 * kRow_px};
    svg_.text({left_ + kSample_px + 8.0, middle.y() + 4.0}, words, "fill=\"#1a1a1a\"");
    y_ += kRow_px;
    return middle;
  }

  [[nodiscard]] double y() const { return y_; }

 private:
  SvgWriter& svg_;
  double left_;
  double y_;
};

void line_sample(SvgWriter& svg, const core::Point2& middle, std::string_view attributes) {
  const core::Point2 half{0.5 * kSample_px, 0.0};
  svg.line(middle - half, middle + half, attributes);
}

void pose_rows(SvgWriter& svg, Key& key, const MapPlot& plot) {
  const auto has = [&](core::FixStatus status) {
    return std::any_of(plot.poses.begin(), plot.poses.end(),
                       [status](const PlotPose& pose) { return pose.status == status; });
  };
  const bool has_fix = has(core::FixStatus::Fix);
  const bool has_ambiguous = has(core::FixStatus::Ambiguous);
  if (has_fix) {
    const core::Point2 path = key.row("path, pose, heading");
    line_sample(svg, path, stroke(kInk, 1.1));
    svg.circle(path, 2.6, "fill=\"#1a1a1a\"");
    svg.line(path, path + core::Point2(6.5, -7.0), stroke(kHeadingColour, 1.3));
  }
  if (has_ambiguous) svg.circle(key.row("ambiguous pose"), 2.6, "fill=\"#ffffff\" " + stroke(kInk, 1));
  if (!has_fix && !has_ambiguous) return;
  svg.rect(box_around(key.row("first pose"), 3.2), "fill=\"#1a1a1a\" " + stroke(kInk, 1));
  svg.circle(key.row("last pose"), 3.8, "fill=\"#1a1a1a\"");
}

void other_rows(SvgWriter& svg, Key& key, const MapPlot& plot) {
  if (!plot.truth_W.empty()) {
    line_sample(svg, key.row("truth"), stroke(kTruthColour, 1.1) + " stroke-dasharray=\"4 2.5\"");
  }
  const bool has_match = std::any_of(plot.landmarks.begin(), plot.landmarks.end(),
                                     [](const PlotLandmark& landmark) { return landmark.matched; });
  if (!has_match) return;
  const core::Point2 middle = key.row("matched by last pose");
  svg.line(middle - core::Point2(13.0, 0.0), middle + core::Point2(3.0, 0.0), stroke(kMatchColour, 0.7));
  svg.circle(middle + core::Point2(8.0, 0.0), 5.0, stroke(kMatchColour, 1.1));
}

// Returns the y of the lower end. The classes stand one above the other, the largest xi on top.
double colour_bar(SvgWriter& svg, const MapPlot& plot, core::Point2 corner_px) {
  if (plot.landmarks.empty()) return corner_px.y();
  unsigned max_xi = 0;
  for (const PlotLandmark& landmark : plot.landmarks) max_xi = std::max(max_xi, landmark.xi);
  const std::vector<XiClass> classes = xi_classes(max_xi);
  svg.open_group("fill=\"" + std::string(kInk) + '"');
  svg.text(corner_px + core::Point2(0.0, 10.0), "Landmark error \xCE\xBE");
  svg.text(corner_px + core::Point2(0.0, 24.0), "(triangulations)", "fill=\"" + std::string(kSoftInk) + '"');
  corner_px.y() += 33.0;
  for (std::size_t i = classes.size(); i-- > 0;) {
    const double bottom = corner_px.y() + kSwatchHeight_px;
    svg.rect({corner_px.x(), corner_px.y(), corner_px.x() + kSwatchWidth_px, bottom},
             "fill=\"" + classes[i].colour + '"');
    svg.text({corner_px.x() + kSwatchWidth_px + 8.0, bottom - 2.5}, class_text(classes[i]));
    corner_px.y() = bottom;
  }
  svg.close_group();
  return corner_px.y();
}

/// Its own scale in the lower left corner of a panel, for a picture with several.
void scale_bar_inside(SvgWriter& svg, const MapPanel& frame) {
  const core::Point2 corner(frame.area.left + 10.0, frame.area.bottom - 32.0);
  svg.rect({corner.x() - 6.0, corner.y() - 4.0, corner.x() + kScaleBarMax_px + 6.0, corner.y() + 26.0},
           "fill=\"#ffffff\" fill-opacity=\"0.85\"");
  draw_scale_bar(svg, frame.px_per_m, corner);
}

/// Draws the key of the marks that `plot` has and the colour bar of xi, with the upper left corner at
/// `corner_px`. Returns the y of its lower end, px.
double draw_map_legend(SvgWriter& svg, const MapPlot& plot, const core::Point2& corner_px) {
  Key key(svg, corner_px);
  if (!plot.landmarks.empty()) {
    PathData cross;
    cross.plus(key.row("landmark"), 4.0);
    svg.path(cross, stroke(xi_classes(0).front().colour, 1.2));
  }
  pose_rows(svg, key, plot);
  other_rows(svg, key, plot);
  return colour_bar(svg, plot, {corner_px.x(), key.y() + 16.0});
}

constexpr double kMargin_px = 12.0;
constexpr double kLegendGap_px = 22.0;
constexpr double kBelowAxis_px = 44.0;
// A path smaller than this share of the map, with poses closer than this, is shown larger beside it.
constexpr double kDetailShare = 0.4;
constexpr double kCrowded_px = 14.0;

FrameSize size_beside_detail() {
  return {{560.0, 560.0}, {340.0, 300.0}};
}

FrameSize size_of_detail(const MapPanel& map) {
  return {{400.0, map.area.height()}, {280.0, std::min(280.0, map.area.height())}};
}

// The path is so small a part of the map that its poses cannot be told apart there.
bool needs_detail(const MapPlot& plot, const MapPanel& map) {
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

void draw_panel(SvgWriter& svg, const MapPlot& plot, const MapPanel& frame, std::string_view name,
                Numbers numbers) {
  const std::vector<PoseMark> poses = pose_marks(plot, frame);
  const MarkSizes sizes = mark_sizes(plot, frame, poses);
  draw_map_axes(svg, frame);
  svg.open_clipped_group(frame.area, name);
  draw_landmarks(svg, plot, frame, sizes);
  draw_matches(svg, plot, frame, sizes, poses);
  draw_poses(svg, poses, sizes);
  draw_truth(svg, plot, frame);
  draw_labels(svg, frame, sizes, poses, numbers);
  svg.close_group();
}

// The part of the map that the detail shows, in the map.
void draw_outline(SvgWriter& svg, const MapPanel& map, const MapPanel& detail) {
  const core::Point2 low = map.to_px(detail.low_W);
  const core::Point2 high = map.to_px(detail.high_W);
  svg.rect({low.x(), high.y(), high.x(), low.y()}, stroke(kSoftInk, 0.8));
}

struct Panels {
  MapPanel map;
  std::optional<MapPanel> detail;
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
    const MapPanel detail = frame_fixes(plot, size_of_detail(panels.map));
    panels.detail = moved_to(detail, {right_px + kMargin_px + left_margin_px(detail), top_px});
    right_px = panels.detail->area.right;
  }
  panels.width_px = right_px + kLegendGap_px + kLegendWidth_px;
  return panels;
}

// The landmarks that `frame` shows; with fewer of them there is room for larger crosses.
MapPlot shown_in(const MapPanel& frame, const MapPlot& plot) {
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
  double legend_end = draw_map_legend(svg, shown, legend);
  if (panels.detail) {
    scale_bar_inside(svg, panels.map);
    scale_bar_inside(svg, *panels.detail);
  } else {
    legend_end = draw_scale_bar(svg, panels.map.px_per_m, {legend.x(), legend_end + 20.0});
  }
  return svg.finish(panels.width_px,
                    std::max(panels.map.area.bottom + kBelowAxis_px, legend_end + kMargin_px));
}

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

MapPanel frame_box(const Eigen::AlignedBox2d& box, const FrameSize& size) {
  const double room_m = kRoom * std::max(box.sizes().maxCoeff(), kRangeMin_m);
  core::Point2 range_m = (box.sizes() + core::Point2::Constant(2.0 * room_m)).cwiseMax(kRangeMin_m);
  MapPanel frame;
  frame.px_per_m = size.max_px.cwiseQuotient(range_m).minCoeff();
  // A long and narrow map gets room across, so that axes and labels keep theirs.
  range_m = range_m.cwiseMax(size.min_px / frame.px_per_m);
  frame.low_W = box.center() - 0.5 * range_m;
  frame.high_W = box.center() + 0.5 * range_m;
  frame.area = {0.0, 0.0, range_m.x() * frame.px_per_m, range_m.y() * frame.px_per_m};
  return frame;
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

MapPanel frame_map(const MapPlot& plot, const FrameSize& size) {
  return frame_box(extent(plot), size);
}

MapPanel frame_fixes(const MapPlot& plot, const FrameSize& size) {
  Eigen::AlignedBox2d box;
  for (const PlotPose& pose : plot.poses) {
    if (pose.status == core::FixStatus::Fix) box.extend(pose.pose_W.translation());
  }
  return frame_box(box, size);
}

MapPanel moved_to(const MapPanel& frame, const core::Point2& corner_px) {
  MapPanel moved = frame;
  moved.area = {corner_px.x(), corner_px.y(), corner_px.x() + frame.area.width(),
                corner_px.y() + frame.area.height()};
  return moved;
}

double left_margin_px(const MapPanel& frame) {
  const double step_m = round_step_up(kTickSpacing_px / frame.px_per_m);
  double widest_px = 0.0;
  for (const double y : linear_ticks(frame.low_W.y(), frame.high_W.y(), step_m)) {
    widest_px = std::max(widest_px, text_width_px(tick_text(y, step_m), kTickText_px));
  }
  return widest_px + kTickGap_px + kAxisTitle_px;
}

void draw_map_axes(SvgWriter& svg, const MapPanel& frame) {
  const PixelBox& area = frame.area;
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
  svg.path(grid, stroke(kGrid, 0.8));
  svg.path(ticks, stroke(kInk, 0.9));
  svg.rect(area, stroke(kInk, 0.9));
}

}  // namespace slamsensor::tools
