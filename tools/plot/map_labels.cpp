#include "tools/plot/map_labels.hpp"

#include "tools/plot/axis_ticks.hpp"
#include "tools/plot/label_placer.hpp"
#include "tools/plot/xml_text.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr double kNumber_px = 10.0;
constexpr double kXi_px = 8.0;
// Of the size of the font: what digits take above the base line, with a little air.
constexpr double kDigitHeight = 0.85;
constexpr std::size_t kXiLabelsMax = 60;
constexpr std::size_t kNumbersMax = 60;
constexpr double kPlacedShare = 0.7;
// Numbers that follow each other closer than this along the path read as a swarm.
constexpr double kNumberSpacing_px = 24.0;
// Between two numbers side by side, so that they are not read as one.
constexpr double kNumberGap_px = 4.0;
constexpr int kFarRings = 12;
// A label this far from its pose is tied to it by a line.
constexpr double kLeader_px = 9.0;

struct Label {
  Box box;
  core::Point2 anchor_px = core::Point2::Zero();
  std::string words;
};

LabelRequest number_request(const PoseMark& pose, const std::string& words) {
  LabelRequest request;
  request.anchor_px = pose.at_px;
  request.width_px = text_width_px(words, kNumber_px) + kNumberGap_px;
  request.height_px = kDigitHeight * kNumber_px;
  request.gap_px = 4.5;
  return request;
}

bool place_number(LabelPlacer& placer, std::vector<Label>& labels, const PoseMark& pose) {
  const std::string words = std::to_string(pose.number);
  LabelRequest request = number_request(pose, words);
  request.tolerated_from = Obstacle::Cross;
  request.rings = 3;
  const std::optional<Box> box = placer.place(request);
  if (box) labels.push_back({*box, pose.at_px, words});
  return box.has_value();
}

// The first and the last number have nothing but each other in their way at first, and may stand farther off.
void place_end(LabelPlacer& placer, std::vector<Label>& labels, const PoseMark& pose) {
  const std::string words = std::to_string(pose.number);
  LabelRequest request = number_request(pose, words);
  request.gap_px = 5.5;
  request.rings = kFarRings;
  request.tolerated_from = Obstacle::Marker;
  if (const std::optional<Box> box = placer.place(request)) labels.push_back({*box, pose.at_px, words});
}

struct Numbering {
  LabelPlacer placer;
  std::vector<Label> labels;
  std::size_t asked = 0;
};

Numbering number_every(std::int64_t step, const std::vector<PoseMark>& poses, const LabelPlacer& free_placer,
                       const std::vector<Label>& ends) {
  Numbering numbering{free_placer, ends, 0};
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    if (poses[i].number % step != 0) continue;
    ++numbering.asked;
    place_number(numbering.placer, numbering.labels, poses[i]);
  }
  return numbering;
}

// Steps are 1, 2, 5, 10, ... : the first of which most numbers find a place.
Numbering number_poses(const std::vector<PoseMark>& poses, LabelPlacer placer, double spacing_px,
                       Numbers numbers) {
  std::vector<Label> ends;
  if (!poses.empty()) place_end(placer, ends, poses.front());
  if (poses.size() > 1) place_end(placer, ends, poses.back());
  if (numbers == Numbers::Ends) return {placer, ends, 0};
  for (std::int64_t step = 1;; step = std::llround(round_step_up(1.5 * static_cast<double>(step)))) {
    Numbering numbering = number_every(step, poses, placer, ends);
    const auto placed = static_cast<double>(numbering.labels.size() - ends.size());
    const bool is_legible = numbering.asked <= kNumbersMax &&
                            static_cast<double>(step) * spacing_px >= kNumberSpacing_px &&
                            placed >= kPlacedShare * static_cast<double>(numbering.asked);
    if (is_legible || numbering.asked <= 1) return numbering;
  }
}

LabelPlacer blocked_placer(const MapPlot& plot, const MapFrame& frame, const MarkSizes& sizes,
                           const std::vector<PoseMark>& poses) {
  LabelPlacer placer(frame.area);
  for (const PlotLandmark& landmark : plot.landmarks) {
    placer.block(
        box_around(frame.to_px(landmark.position_W), sizes.cross_half_px + (landmark.matched ? 2.0 : 0.0)),
        Obstacle::Cross);
  }
  for (const PoseMark& pose : poses) {
    placer.block(box_around(pose.at_px, std::max(sizes.pose_px, 2.0)), Obstacle::Marker);
  }
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (poses[i].follows_fix) placer.block_line(poses[i - 1].at_px, poses[i].at_px);
  }
  return placer;
}

void write(SvgWriter& svg, const Label& label) {
  const core::Point2 nearest{std::clamp(label.anchor_px.x(), label.box.left, label.box.right),
                             std::clamp(label.anchor_px.y(), label.box.top, label.box.bottom)};
  if ((nearest - label.anchor_px).norm() > kLeader_px) {
    svg.line(label.anchor_px, nearest, "stroke=\"" + std::string(kSoftInk) + "\" stroke-width=\"0.6\"");
  }
  svg.text({0.5 * (label.box.left + label.box.right), label.box.bottom - 0.6}, label.words);
}

void write_xi(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame, const MarkSizes& sizes,
              LabelPlacer& placer) {
  if (plot.landmarks.size() > kXiLabelsMax) return;
  svg.open_group("font-size=\"8\" text-anchor=\"middle\" fill=\"" + std::string(kSoftInk) + '"');
  for (const PlotLandmark& landmark : plot.landmarks) {
    LabelRequest request;
    const std::string words = std::to_string(landmark.xi);
    request.anchor_px = frame.to_px(landmark.position_W);
    request.width_px = text_width_px(words, kXi_px);
    request.height_px = kDigitHeight * kXi_px;
    request.gap_px = sizes.cross_half_px + (landmark.matched ? 5.0 : 1.0);
    request.tolerated_from = Obstacle::Cross;
    const std::optional<Box> box = placer.place(request);
    if (box) svg.text({0.5 * (box->left + box->right), box->bottom - 0.5}, words);
  }
  svg.close_group();
}

}  // namespace

void draw_labels(SvgWriter& svg, const MapPlot& plot, const MapFrame& frame, const MarkSizes& sizes,
                 const std::vector<PoseMark>& poses, Numbers numbers) {
  Numbering numbering =
      number_poses(poses, blocked_placer(plot, frame, sizes, poses), sizes.spacing_px, numbers);
  write_xi(svg, plot, frame, sizes, numbering.placer);
  svg.open_group(
      "font-size=\"10\" text-anchor=\"middle\" fill=\"" + std::string(kInk) +
      "\" stroke=\"#ffffff\" stroke-width=\"2.4\" stroke-linejoin=\"round\" paint-order=\"stroke\"");
  for (const Label& label : numbering.labels) write(svg, label);
  svg.close_group();
}

}  // namespace slamsensor::tools
