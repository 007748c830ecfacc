#include "tools/plot/map_legend.hpp"

#include "tools/plot/axis_ticks.hpp"
#include "tools/plot/palette.hpp"

#include <algorithm>

namespace slamsensor::tools {
namespace {

constexpr double kRow_px = 19.0;
constexpr double kSample_px = 26.0;
constexpr double kSwatchWidth_px = 16.0;
constexpr double kSwatchHeight_px = 13.0;
constexpr double kScaleMax_px = 120.0;

std::string ink(std::string_view width) {
  return "stroke=\"" + std::string(kPathColour) + "\" stroke-width=\"" + std::string(width) + '"';
}

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
    line_sample(svg, path, ink("1.1"));
    svg.circle(path, 2.6, "fill=\"#1a1a1a\"");
    svg.line(path, path + core::Point2(6.5, -7.0),
             "stroke=\"" + std::string(kHeadingColour) + "\" stroke-width=\"1.3\"");
  }
  if (has_ambiguous) svg.circle(key.row("ambiguous pose"), 2.6, "fill=\"#ffffff\" " + ink("1"));
  if (!has_fix && !has_ambiguous) return;
  svg.rect(box_around(key.row("first pose"), 3.2), "fill=\"#1a1a1a\" " + ink("1"));
  svg.circle(key.row("last pose"), 3.8, "fill=\"#1a1a1a\"");
}

void other_rows(SvgWriter& svg, Key& key, const MapPlot& plot) {
  if (!plot.truth_W.empty()) {
    line_sample(
        svg, key.row("truth"),
        "stroke=\"" + std::string(kTruthColour) + "\" stroke-width=\"1.1\" stroke-dasharray=\"4 2.5\"");
  }
  const bool has_match = std::any_of(plot.landmarks.begin(), plot.landmarks.end(),
                                     [](const PlotLandmark& landmark) { return landmark.matched; });
  if (!has_match) return;
  const core::Point2 middle = key.row("matched by last pose");
  const std::string colour = "stroke=\"" + std::string(kMatchColour) + '"';
  svg.line(middle - core::Point2(13.0, 0.0), middle + core::Point2(3.0, 0.0),
           colour + " stroke-width=\"0.7\"");
  svg.circle(middle + core::Point2(8.0, 0.0), 5.0, colour + " stroke-width=\"1.1\"");
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

double scale_bar(SvgWriter& svg, const MapFrame& frame, const core::Point2& corner_px) {
  const double length_m = round_step_down(kScaleMax_px / frame.px_per_m);
  const double length_px = length_m * frame.px_per_m;
  const double y = corner_px.y() + 16.0;
  PathData bar;
  bar.segment({corner_px.x(), y}, {corner_px.x() + length_px, y});
  bar.segment({corner_px.x(), y - 4.0}, {corner_px.x(), y + 4.0});
  bar.segment({corner_px.x() + length_px, y - 4.0}, {corner_px.x() + length_px, y + 4.0});
  svg.path(bar, ink("1.4"));
  svg.text({corner_px.x() + 0.5 * length_px, y - 6.0}, tick_text(length_m, length_m) + " m",
           "text-anchor=\"middle\" fill=\"#1a1a1a\"");
  return y + 6.0;
}

}  // namespace

double draw_map_legend(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame,
                       const core::Point2& corner_px) {
  Key key(svg, corner_px);
  if (!plot.landmarks.empty()) {
    PathData cross;
    cross.plus(key.row("landmark"), 4.0);
    svg.path(cross, "stroke=\"" + xi_classes(0).front().colour + "\" stroke-width=\"1.2\"");
  }
  pose_rows(svg, key, plot);
  other_rows(svg, key, plot);
  const double bar_end = colour_bar(svg, plot, {corner_px.x(), key.y() + 16.0});
  return scale_bar(svg, frame, {corner_px.x(), bar_end + 20.0});
}

}  // namespace slamsensor::tools
