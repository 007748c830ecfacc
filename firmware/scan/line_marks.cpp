#include "firmware/scan/line_marks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace slamsensor::firmware {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kJoin_m = 0.5;       // neighbours nearer to each other than this ...
constexpr double kJoinShare = 0.02;   // ... and this share of their range are one surface
constexpr double kBehind_m = 1.0;     // what bounds a post is farther by this
constexpr double kPostWidth_m = 3.0;  // at most
constexpr double kPostReadings = 3.0;
constexpr double kPostRough_m = 0.3;  // scatter of its range, at most: leaves are no post
constexpr double kFaceReadings = 6.0;
constexpr double kFaceCovered = 0.7;    // of its bin
constexpr double kFaceRough_m = 0.4;    // scatter about its straight line, at most
constexpr double kGapPitches = 4.0;     // readings farther apart are not neighbours
constexpr double kGap_rad = 0.006;      // or this, when it is more
constexpr double kShapeShare = 0.1;     // of a post's width: how its middle and front may differ with height
constexpr double kRangeSigma_m = 0.03;  // what the readings of one mark err together
constexpr double kFaceBin_rad = 2.0 * std::numbers::pi / kFaceBins;
constexpr double kNearestBin_rad = 2.0 * std::numbers::pi / kNearestBins;

std::size_t bin_of(double bearing_rad, double bin_rad, std::size_t bins) noexcept {
  const double bin = std::floor((bearing_rad + std::numbers::pi) / bin_rad);
  return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(bins - 1)));
}

bool are_joined(double a_m, double b_m) noexcept {
  return std::abs(a_m - b_m) <= kJoin_m + kJoinShare * std::min(a_m, b_m);
}

}  // namespace

void LineMarks::Sums::add(double bearing_rad, double range_m) noexcept {
  if (count == 0.0) {
    first_rad = bearing_rad;
  }
  const double off_rad = bearing_rad - first_rad;
  count += 1.0;
  bearing += off_rad;
  range += range_m;
  bearing2 += off_rad * off_rad;
  range2 += range_m * range_m;
  product += off_rad * range_m;
  last_rad = bearing_rad;
}

LineMarks::LineMarks() {
  marks_.reserve(kMarksMax);
}

void LineMarks::build(const Scanline& line, double range_max_m) noexcept {
  marks_.clear();
  nearest_.fill(kInfinite);
  posts_ = faces_begin_ = 0;
  tilt_rad_ = line.tilt_rad;
  direction_ = line.direction;
  line_ = line.line;
  run_ = piece_ = {};
  const std::size_t count = line.readings.size();
  if (count < 2) {
    return;
  }
  pitch_rad_ =
      std::abs(line.readings.back().pan_rad - line.readings.front().pan_rad) / static_cast<double>(count - 1);
  const bool leftwards = line.direction == SweepDirection::Leftwards;
  const double level = std::cos(line.tilt_rad);
  before_ = {-10.0, kInfinite};
  for (std::size_t i = 0; i < count; ++i) {
    const core::Reading& reading = line.readings[leftwards ? i : count - 1 - i];
    const double range_m = reading.has_return() ? reading.range_m * level : kInfinite;
    take({reading.pan_rad, range_m <= range_max_m ? range_m : kInfinite});
  }
  end_run(0.0);  // the end of the sweep bounds no post
}

void LineMarks::take(const Step& step) noexcept {
  const bool follows = step.bearing_rad - before_.bearing_rad <= std::max(kGapPitches * pitch_rad_, kGap_rad);
  if (!follows || !are_joined(before_.range_m, step.range_m)) {
    end_run(follows ? step.range_m : 0.0);
    before_run_m_ = follows ? before_.range_m : 0.0;
  }
  before_ = step;
  if (std::isinf(step.range_m)) {
    return;
  }
  const std::size_t bin = bin_of(step.bearing_rad, kFaceBin_rad, kFaceBins);
  if (bin != bin_) {
    end_piece();
    bin_ = bin;
  }
  run_.add(step.bearing_rad, step.range_m);
  piece_.add(step.bearing_rad, step.range_m);
  double& nearest_m = nearest_[bin_of(step.bearing_rad, kNearestBin_rad, kNearestBins)];
  nearest_m = std::min(nearest_m, step.range_m);
}

/// A run is a post when what is beside it is farther on both sides; else its faces count.
void LineMarks::end_run(double next_m) noexcept {
  end_piece();
  if (run_.count > 0.0) {
    const double mean_m = run_.range / run_.count;
    const double width_m = mean_m * (run_.last_rad - run_.first_rad + pitch_rad_);
    if (width_m <= kPostWidth_m) {
      marks_.erase(marks_.begin() + static_cast<std::ptrdiff_t>(faces_begin_), marks_.end());
      const bool is_bounded = std::min(before_run_m_, next_m) > mean_m + kBehind_m;
      if (is_bounded && run_.count >= kPostReadings) {
        add_post(run_);
      }
    }
  }
  run_ = {};
  faces_begin_ = marks_.size();
}

void LineMarks::end_piece() noexcept {
  const double covered_rad = piece_.last_rad - piece_.first_rad + pitch_rad_;
  if (piece_.count >= kFaceReadings && covered_rad >= kFaceCovered * kFaceBin_rad) {
    add_face(piece_, bin_);
  }
  piece_ = {};
}

void LineMarks::add_post(const Sums& run) noexcept {
  if (posts_ == kPostsMax || marks_.size() == kMarksMax) {
    return;
  }
  const double mean_m = run.range / run.count;
  const double width_m = mean_m * (run.last_rad - run.first_rad + pitch_rad_);
  const double scatter_m2 = std::max(0.0, run.range2 / run.count - mean_m * mean_m);
  if (scatter_m2 > kPostRough_m * kPostRough_m) {
    return;
  }
  ++posts_;
  Mark mark;
  mark.kind = MarkKind::Post;
  mark.bearing_rad = 0.5 * (run.first_rad + run.last_rad);
  mark.range_m = mean_m;
  mark.bearing_sigma = std::hypot(pitch_rad_, kShapeShare * width_m / mean_m);
  mark.range_sigma_m = std::sqrt(scatter_m2 / run.count + kRangeSigma_m * kRangeSigma_m +
                                 kShapeShare * kShapeShare * width_m * width_m);
  marks_.push_back(mark);
}

void LineMarks::add_face(const Sums& piece, std::size_t bin) noexcept {
  const double spread = piece.bearing2 - piece.bearing * piece.bearing / piece.count;
  if (marks_.size() == kMarksMax || !(spread > 0.0)) {
    return;
  }
  const double mean_m = piece.range / piece.count;
  const double slope = (piece.product - piece.bearing * mean_m) / spread;
  const double scatter_m2 =
      std::max(0.0, piece.range2 / piece.count - mean_m * mean_m - slope * slope * spread / piece.count);
  if (scatter_m2 > kFaceRough_m * kFaceRough_m) {
    return;
  }
  Mark mark;
  mark.kind = MarkKind::Face;
  mark.bin = static_cast<std::uint16_t>(bin);
  mark.bearing_rad = (static_cast<double>(bin) + 0.5) * kFaceBin_rad - std::numbers::pi;
  mark.slope_mprad = slope;
  mark.range_m = mean_m + slope * (mark.bearing_rad - piece.first_rad - piece.bearing / piece.count);
  mark.range_sigma_m = std::sqrt(scatter_m2 / piece.count + kRangeSigma_m * kRangeSigma_m);
  marks_.push_back(mark);
}

double LineMarks::nearest_m(const NearestRanges& nearest, double bearing_rad) noexcept {
  const std::size_t middle = bin_of(bearing_rad, kNearestBin_rad, kNearestBins);
  const std::size_t first = middle > 0 ? middle - 1 : 0;
  const std::size_t last = std::min(middle + 1, kNearestBins - 1);
  return *std::min_element(nearest.begin() + static_cast<std::ptrdiff_t>(first),
                           nearest.begin() + static_cast<std::ptrdiff_t>(last) + 1);
}

}  // namespace slamsensor::firmware
