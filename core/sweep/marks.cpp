#include "core/sweep/marks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace slamsensor::core {
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

constexpr double kAside_m = 0.7;       // a mark may be this far from where its track was last ...
constexpr double kDeep_m = 1.0;        // ... and a post this much nearer or farther
constexpr std::uint32_t kMissMax = 4;  // lines that a track may be hidden for
constexpr std::uint32_t kTimesStanding = 3;
constexpr double kLean = 0.5;          // a surface that recedes by more of its rise is a bank ...
constexpr double kLeanNoise_m = 0.06;  // ... or ground, beyond what is noise
constexpr double kBefore_m = 1.0;

/// How far a mark is from where its track was last, as a share of what is allowed; 1 or more: another thing.
double distance(const Mark& last, const Mark& mark) noexcept {
  if (last.kind != mark.kind) {
    return 1.0;
  }
  const double deep_m = std::abs(last.range_m - mark.range_m);
  if (mark.kind == MarkKind::Face) {
    return last.bin == mark.bin ? deep_m / kAside_m : 1.0;
  }
  const double aside_m = std::abs(last.bearing_rad - mark.bearing_rad) * mark.range_m;
  return std::max(deep_m / kDeep_m, aside_m / kAside_m);
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
    const Reading& reading = line.readings[leftwards ? i : count - 1 - i];
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
      marks_.truncate(faces_begin_);
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
  static_cast<void>(marks_.try_push_back(mark));
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
  static_cast<void>(marks_.try_push_back(mark));
}

double LineMarks::nearest_m(const NearestRanges& nearest, double bearing_rad) noexcept {
  const std::size_t middle = bin_of(bearing_rad, kNearestBin_rad, kNearestBins);
  const std::size_t first = middle > 0 ? middle - 1 : 0;
  const std::size_t last = std::min(middle + 1, kNearestBins - 1);
  return *std::min_element(nearest.begin() + static_cast<std::ptrdiff_t>(first),
                           nearest.begin() + static_cast<std::ptrdiff_t>(last) + 1);
}

void MarkTracks::clear() noexcept {
  tracks_.clear();
  shifts_.clear();
  tally_ = {};
  lines_ = 0;
}

void MarkTracks::add(const LineMarks& line) noexcept {
  ++lines_;
  line_ = &line;
  shifts_.clear();
  tally_ = {};
  pair_up(line.marks());
  for (std::size_t i = 0; i < line.marks().size(); ++i) {
    take(line.marks()[i], pairs_[i]);
  }
  count_tracks();
  forget_old();
  nearest_ = line.nearest();
  line_ = nullptr;
}

/// Each mark's track: the one nearest to it, when it is also the nearest to that track. Among things that
/// stand close together any other choice would lean to one side.
void MarkTracks::pair_up(std::span<const Mark> marks) noexcept {
  pairs_.fill(kNoTrack);
  nearest_mark_.fill({kNoTrack, 1.0});
  for (std::size_t i = 0; i < marks.size(); ++i) {
    double nearest = 1.0;
    for (std::size_t j = 0; j < tracks_.size(); ++j) {
      const double off = distance(tracks_[j].last, marks[i]);
      if (off < nearest) {
        nearest = off;
        pairs_[i] = j;
      }
      if (off < nearest_mark_[j].distance) {
        nearest_mark_[j] = {i, off};
      }
    }
  }
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (pairs_[i] != kNoTrack && nearest_mark_[pairs_[i]].mark != i) {
      pairs_[i] = kNoTrack;
    }
  }
}

void MarkTracks::take(const Mark& mark, std::size_t track) noexcept {
  const bool is_told = mark.kind == MarkKind::Post || line_->tilt_rad() > 0.0;  // or it may be ground
  tally_.seen += is_told && lines_ > 1 ? 1 : 0;
  if (track != kNoTrack) {
    tally_.known += is_told ? 1 : 0;
    meet(tracks_[track], mark);
  } else if (begin(mark) && is_told) {
    ++tally_.risen_now;
  }
}

void MarkTracks::meet(Track& track, const Mark& mark) noexcept {
  if (!stands(track, mark)) {
    start(track, mark);
    return;
  }
  ++track.times;
  const auto side = static_cast<std::size_t>(line_->direction());
  if (track.has_first[side]) {
    tell(track, mark);
  } else {
    track.has_first[side] = true;
    track.first[side] = mark;
    track.first_line[side] = lines_;
    track.first_tilt_rad[side] = line_->tilt_rad();
  }
  track.last = mark;
  track.last_line = lines_;
  track.last_tilt_rad = line_->tilt_rad();
}

/// Whether a surface has not receded as ground and banks do when one looks higher. That it came nearer only
/// motion can have done.
bool MarkTracks::stands(const Track& track, const Mark& mark) const noexcept {
  const auto recedes_from = [&](const Mark& earlier, double tilt_rad) {
    const double rise_m = mark.range_m * std::max(0.0, std::tan(line_->tilt_rad()) - std::tan(tilt_rad));
    return mark.range_m - earlier.range_m > kLean * rise_m + kLeanNoise_m;
  };
  const auto side = static_cast<std::size_t>(line_->direction());
  return mark.kind == MarkKind::Post ||
         !(recedes_from(track.last, track.last_tilt_rad) ||
           (track.has_first[side] && recedes_from(track.first[side], track.first_tilt_rad[side])));
}

/// Whether it stands before what the line before saw there.
bool MarkTracks::begin(const Mark& mark) noexcept {
  if (!tracks_.try_push_back({})) {
    ++dropped_;
    return false;
  }
  start(tracks_.back(), mark);
  const bool was_free = LineMarks::nearest_m(nearest_, mark.bearing_rad) > mark.range_m + kBefore_m;
  tracks_.back().has_risen = lines_ > 1 && was_free;
  return tracks_.back().has_risen;
}

void MarkTracks::start(Track& track, const Mark& mark) const noexcept {
  const auto side = static_cast<std::size_t>(line_->direction());
  track = {};
  track.last = track.first[side] = mark;
  track.has_first[side] = true;
  track.born = track.last_line = track.first_line[side] = lines_;
  track.times = 1;
  track.last_tilt_rad = track.first_tilt_rad[side] = line_->tilt_rad();
}

void MarkTracks::tell(const Track& track, const Mark& mark) noexcept {
  const auto side = static_cast<std::size_t>(line_->direction());
  const Mark& first = track.first[side];
  if (track.times < kTimesStanding) {
    return;
  }
  MarkShift shift;
  shift.kind = mark.kind;
  shift.bearing_rad = first.bearing_rad;
  shift.range_m = first.range_m;
  shift.slope_mprad = 0.5 * (first.slope_mprad + mark.slope_mprad);
  shift.bearing_off_rad = mark.bearing_rad - first.bearing_rad;
  shift.range_off_m = mark.range_m - first.range_m;
  shift.bearing_sigma = std::hypot(first.bearing_sigma, mark.bearing_sigma);
  shift.range_sigma_m = std::hypot(first.range_sigma_m, mark.range_sigma_m);
  shift.rise_m = mark.range_m * (std::tan(line_->tilt_rad()) - std::tan(track.first_tilt_rad[side]));
  shift.lines = lines_ - track.first_line[side];
  static_cast<void>(shifts_.try_push_back(shift));
}

void MarkTracks::count_tracks() noexcept {
  for (const Track& track : tracks_) {
    const bool stood = track.times >= kTimesStanding && track.born + kTimesStanding + 2 <= lines_;
    if (stood && track.last_line + 3 >= lines_) {
      ++tally_.standing;
      tally_.lost += track.last_line + 2 <= lines_ ? 1 : 0;
    }
    tally_.risen += track.has_risen && track.born + 2 == lines_ && track.times == 3 ? 1 : 0;
  }
}

void MarkTracks::forget_old() noexcept {
  const auto gone = std::remove_if(tracks_.begin(), tracks_.end(), [this](const Track& track) {
    return track.last_line + kMissMax < lines_;
  });
  tracks_.truncate(static_cast<std::size_t>(gone - tracks_.begin()));
}

}  // namespace slamsensor::core
