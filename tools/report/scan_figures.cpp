#include "tools/report/scan_figures.hpp"

#include "core/detection/landmark_detector.hpp"
#include "core/detection/polar_grid.hpp"
#include "core/detection/scanline.hpp"
#include "core/detection/spiderweb.hpp"
#include "firmware/arena_block.hpp"
#include "tools/output/text_output.hpp"
#include "tools/plot/curve_plot.hpp"
#include "tools/plot/scales.hpp"
#include "tools/plot/svg.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace slamsensor::tools {
namespace {

constexpr double kSide_px = 640.0;
constexpr double kMargin_px = 14.0;
constexpr double kLegend_px = 44.0;  // two rows
constexpr double kLegendRow_px = 19.0;
constexpr std::uint32_t kOccupiedMax = 2'000'000;  // cells: no scan is left out of its picture

/// An occupied cell of the spiderweb.
struct Cell {
  std::uint32_t row = 0;
  std::uint32_t column = 0;
  std::uint32_t count = 0;
};

struct Web {
  std::vector<Cell> cells;
  std::vector<core::ScanLandmark> landmarks;
  std::uint32_t count_max = 0;
  double reach_m = 0.0;         ///< of what is drawn
  std::size_t farther_out = 0;  ///< landmarks beyond it
};

/// Most landmarks stand near the sensor, and a few far out would make them too small to see.
void choose_reach(Web& web, const core::DetectionConfig& config) {
  constexpr double kNearShare = 0.85;
  std::vector<double> ranges_m;
  for (const core::ScanLandmark& landmark : web.landmarks) {
    ranges_m.push_back(landmark.position_L.norm());
  }
  std::sort(ranges_m.begin(), ranges_m.end());
  web.reach_m = 8.0 * config.range_step_m;
  if (!ranges_m.empty()) {
    const double near_m =
        ranges_m[static_cast<std::size_t>(kNearShare * static_cast<double>(ranges_m.size() - 1))];
    web.reach_m = std::max(web.reach_m, 1.15 * near_m + config.range_step_m);
  }
  web.farther_out = static_cast<std::size_t>(ranges_m.end() -
                                             std::upper_bound(ranges_m.begin(), ranges_m.end(), web.reach_m));
}

Web make_web(const Scanlines& scanlines, const core::DetectionConfig& config) {
  firmware::ArenaBlock<core::ScanlineGrid> line(config);
  firmware::ArenaBlock<core::Spiderweb> grid(config, kOccupiedMax);
  core::Capacities capacities;
  capacities.occupied_cells = kOccupiedMax;
  firmware::ArenaBlock<core::LandmarkDetector> detector(config, capacities);
  for (const std::vector<core::Reading>& scanline : scanlines) {
    for (const core::Sighting& sighting : line->sightings(scanline)) {
      grid->add(sighting);
    }
    detector->add_scanline(scanline);
  }
  Web web;
  const core::PolarGrid polar(config);
  for (std::uint32_t row = 0; row < polar.rows(); ++row) {
    for (std::uint32_t column = 0; column < polar.columns(); ++column) {
      if (const std::uint32_t count = grid->count(row, column); count > 0) {
        web.cells.push_back({row, column, count});
        web.count_max = std::max(web.count_max, count);
      }
    }
  }
  const std::span<const core::ScanLandmark> landmarks = detector->finish();
  web.landmarks.assign(landmarks.begin(), landmarks.end());
  choose_reach(web, config);
  return web;
}

/// Metres about the sensor, x up and y to the left: the sensor looks up the page.
class FromAbove {
 public:
  FromAbove(const core::Point2& middle_px, double px_per_m) : middle_px_(middle_px), px_per_m_(px_per_m) {}
  [[nodiscard]] core::Point2 px(const core::Point2& p_L) const {
    return {middle_px_.x() - px_per_m_ * p_L.y(), middle_px_.y() - px_per_m_ * p_L.x()};
  }
  [[nodiscard]] core::Point2 polar_px(double range_m, double bearing_rad) const {
    return px({range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad)});
  }
  [[nodiscard]] double length_px(double metres) const { return px_per_m_ * metres; }
  [[nodiscard]] const core::Point2& middle_px() const { return middle_px_; }

 private:
  core::Point2 middle_px_;
  double px_per_m_;
};

void draw_rings(SvgWriter& svg, const FromAbove& place, double reach_m) {
  const double step_m = round_step_up(reach_m / 4.0);
  for (const double ring_m : linear_ticks(step_m, reach_m, step_m)) {
    svg.circle(place.middle_px(), place.length_px(ring_m), stroke(kGrid, 1.0));
  }
  PathData spokes;
  for (int i = 0; i < 12; ++i) {
    const double bearing_rad = 30.0 * core::kDegree * i;
    spokes.segment(place.polar_px(0.06 * reach_m, bearing_rad), place.polar_px(reach_m, bearing_rad));
  }
  svg.path(spokes, stroke(kGrid, 1.0));
}

void write_rings(SvgWriter& svg, const FromAbove& place, double reach_m) {
  const double step_m = round_step_up(reach_m / 4.0);
  for (const double ring_m : linear_ticks(step_m, reach_m, step_m)) {
    svg.text(place.polar_px(ring_m, 0.0) + core::Point2(4.0, 13.0), tick_text(ring_m, step_m) + " m",
             "fill=\"#555555\" paint-order=\"stroke\" stroke=\"#ffffff\" stroke-width=\"3\"");
  }
}

void draw_cells(SvgWriter& svg, const FromAbove& place, const Web& web, const core::PolarGrid& polar,
                const std::vector<XiClass>& classes) {
  std::vector<PathData> paths(classes.size());
  for (const Cell& cell : web.cells) {
    const double near_m = polar.radius_m(cell.row);
    const double far_m = polar.radius_m(cell.row + 1);
    const double from_rad = polar.edge_rad(cell.column);
    const double to_rad =
        cell.column + 1 == polar.columns() ? 360.0 * core::kDegree : polar.edge_rad(cell.column + 1);
    PathData& path = paths[(cell.count - 1) / (classes[0].last + 1)];
    path.move_to(place.polar_px(near_m, from_rad));
    path.line_to(place.polar_px(far_m, from_rad));
    path.line_to(place.polar_px(far_m, to_rad));
    path.line_to(place.polar_px(near_m, to_rad));
  }
  for (std::size_t i = 0; i < classes.size(); ++i) {
    // The outline keeps a cell of less than a pixel visible.
    svg.path(paths[i],
             "fill=\"" + classes[i].colour + "\" stroke=\"" + classes[i].colour + "\" stroke-width=\"0.8\"");
  }
}

/// Counts begin at 1 where xi begins at 0.
std::string count_text(XiClass xi_class) {
  ++xi_class.first;
  ++xi_class.last;
  return class_text(xi_class);
}

void draw_counts(SvgWriter& svg, const core::Point2& corner_px, const std::vector<XiClass>& classes) {
  core::Point2 at = corner_px;
  // A sign of `sign_px` and what it means; a row that is full is followed by another.
  const auto put = [&](const std::string& words, double sign_px) {
    const double width_px = sign_px + text_width_px(words, 11.0);
    if (at.x() + width_px > corner_px.x() + kSide_px) at = {corner_px.x(), at.y() + kLegendRow_px};
    svg.text(at + core::Point2(sign_px, 12.0), words, "fill=\"#1a1a1a\"");
    at.x() += width_px + 10.0;
    return core::Point2(at.x() - width_px - 10.0, at.y());
  };
  put("scanlines:", 0.0);
  for (const XiClass& xi_class : classes) {
    const core::Point2 sign = put(count_text(xi_class), 16.0);
    svg.rect({sign.x(), sign.y() + 2.0, sign.x() + 12.0, sign.y() + 14.0}, "fill=\"" + xi_class.colour + '"');
  }
  svg.circle(put("landmark", 18.0) + core::Point2(6.0, 8.0), 5.5, stroke(kTruthColour, 1.6));
}

}  // namespace

std::string draw_spiderweb(const Scanlines& scanlines, const core::DetectionConfig& config,
                           const std::string& title) {
  const Web web = make_web(scanlines, config);
  const core::PolarGrid polar(config);
  const std::vector<XiClass> classes = xi_classes(std::max(web.count_max, 1U) - 1);
  SvgWriter svg;
  const std::vector<std::string> summary = {
      std::to_string(scanlines.size()) + " scanlines; " + std::to_string(web.cells.size()) +
      " occupied cells of " + fixed_text(config.range_step_m, 2) + " m by " +
      fixed_text(config.bearing_step_rad / core::kDegree, 3) + " deg; the " +
      std::to_string(web.landmarks.size()) + " heaviest groups are landmarks" +
      (web.farther_out > 0 ? ", of which " + std::to_string(web.farther_out) + " stand farther out" : "")};
  const double top = draw_heading(svg, title, summary, {kMargin_px, kMargin_px}, kSide_px);
  draw_counts(svg, {kMargin_px, top + 4.0}, classes);
  const FromAbove place({kMargin_px + 0.5 * kSide_px, top + kLegend_px + 0.5 * kSide_px},
                        0.5 * kSide_px / web.reach_m);
  svg.open_clipped_group(box_around(place.middle_px(), 0.5 * kSide_px), "web");
  draw_rings(svg, place, web.reach_m);
  draw_cells(svg, place, web, polar, classes);
  write_rings(svg, place, web.reach_m);
  for (const core::ScanLandmark& landmark : web.landmarks) {
    svg.circle(place.px(landmark.position_L), 5.5, stroke(kTruthColour, 1.6));
  }
  PathData sensor;
  sensor.move_to(place.middle_px() + core::Point2(0.0, -8.0));
  sensor.line_to(place.middle_px() + core::Point2(6.0, 6.0));
  sensor.line_to(place.middle_px() + core::Point2(-6.0, 6.0));
  svg.path(sensor, "fill=\"#1a1a1a\"");
  svg.close_group();
  return svg.finish(kSide_px + 2.0 * kMargin_px, top + kLegend_px + kSide_px + kMargin_px);
}

std::optional<std::size_t> richest_scanline(const Scanlines& scanlines, const core::DetectionConfig& config) {
  firmware::ArenaBlock<core::ScanlineGrid> grid(config);
  std::optional<std::size_t> best;
  std::size_t most = 0;
  for (std::size_t i = 0; i < scanlines.size(); ++i) {
    const std::size_t count = grid->sightings(scanlines[i]).size();
    if (!grid->left_out() && (!best || count > most)) {
      best = i;
      most = count;
    }
  }
  return best;
}

std::string draw_scanline(const std::vector<core::Reading>& scanline, const core::DetectionConfig& config,
                          const std::string& title) {
  firmware::ArenaBlock<core::ScanlineGrid> grid(config);
  const core::PolarGrid polar(config);
  const std::span<const core::Sighting> sightings = grid->sightings(scanline);
  const std::span<const std::int32_t> row = grid->row();
  std::vector<bool> is_unobstructed(row.size(), false);
  for (const core::Sighting& sighting : sightings) {
    is_unobstructed[sighting.column] = true;
  }
  CurveSeries seen{"unobstructed clusters: counted in the spiderweb", {}, CurveStyle::Markers};
  CurveSeries hidden{"other returns", {}, CurveStyle::Markers};
  CurveSeries infinite{"no return", {}, CurveStyle::Markers};
  std::int32_t farthest = 1;
  std::size_t empty = 0;
  for (const std::int32_t d_cell : row) {
    farthest = d_cell == core::kInfiniteColumn ? farthest : std::max(farthest, d_cell);
    empty += d_cell == core::kEmptyColumn ? 1 : 0;
  }
  for (std::uint32_t column = 0; column < row.size(); ++column) {
    const double bearing_deg = (polar.edge_rad(column) + 0.5 * config.bearing_step_rad) / core::kDegree;
    const double shown_deg = bearing_deg > 180.0 ? bearing_deg - 360.0 : bearing_deg;
    if (row[column] == core::kInfiniteColumn) {
      infinite.points.emplace_back(shown_deg, config.range_step_m * 1.08 * farthest);
    } else if (row[column] != core::kEmptyColumn) {
      CurveSeries& series = is_unobstructed[column] ? seen : hidden;
      series.points.emplace_back(shown_deg, config.range_step_m * (row[column] + 0.5));
    }
  }
  CurvePlot plot;
  plot.title = title;
  plot.x_label = "bearing, deg (counter-clockwise)";
  plot.y_label = "distance, m";
  plot.summary = {std::to_string(sightings.size()) + " columns in unobstructed clusters, " +
                  std::to_string(hidden.points.size()) + " with other returns, " +
                  std::to_string(infinite.points.size()) + " without a return, " + std::to_string(empty) +
                  " not looked at"};
  plot.series = {seen, hidden, infinite};
  return draw_curve(plot);
}

}  // namespace slamsensor::tools
