#include "firmware/scan/mark_tracks.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::firmware {
namespace {

constexpr std::size_t kTracksMax = 3 * kMarksMax;
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

MarkTracks::MarkTracks() {
  tracks_.reserve(kTracksMax);
  shifts_.reserve(kMarksMax);
  pairs_.reserve(kMarksMax);
  nearest_mark_.reserve(kTracksMax);
  clear();
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
  pairs_.assign(marks.size(), kNoTrack);
  nearest_mark_.assign(tracks_.size(), {kNoTrack, 1.0});
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
  if (tracks_.size() == kTracksMax) {
    ++dropped_;
    return false;
  }
  tracks_.emplace_back();
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
  if (track.times < kTimesStanding || shifts_.size() == shifts_.capacity()) {
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
  shifts_.push_back(shift);
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
  tracks_.erase(gone, tracks_.end());
}

}  // namespace slamsensor::firmware
