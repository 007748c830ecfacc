#include "hal/timing/sample_clock.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace slamsensor::hal {

void ArrivalLog::note(std::size_t count, Stamp stamp) noexcept {
  position_ += count;
  newest_ = (newest_ + 1) % kReads;
  reads_[newest_] = {position_, stamp};
  count_ = count_ < kReads ? count_ + 1 : kReads;
}

Stamp ArrivalLog::latest_begin(std::uint64_t begin, std::uint64_t end, std::uint32_t baud) const noexcept {
  Read holder = reads_[newest_];
  for (std::size_t back = 1; back < count_; ++back) {
    const Read& earlier = reads_[(newest_ + kReads - back) % kReads];
    if (earlier.end < end) {
      break;
    }
    holder = earlier;
  }
  return holder.stamp - line_time(static_cast<std::size_t>(holder.end - begin), baud);
}

namespace {

/// Whether `b` lies on or above the straight line from `a` to `c`.
bool is_above(const LowerLine::Point& a, const LowerLine::Point& b, const LowerLine::Point& c) noexcept {
  return (b.y - a.y) * (c.x - a.x) >= (c.y - a.y) * (b.x - a.x);
}

}  // namespace

void LowerLine::add(const Point& point) noexcept {
  if (count_ == kPointsMax) {
    std::copy(points_.begin() + 1, points_.end(), points_.begin());
    --count_;
  }
  points_[count_++] = point;
}

void LowerLine::shift(double dx, double dy) noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    points_[i].x += dx;
    points_[i].y += dy;
  }
}

double LowerLine::hull_slope(double fallback) const noexcept {
  std::array<Point, kPointsMax> hull{};
  std::size_t corners = 0;
  double mean_x = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    while (corners >= 2 && is_above(hull[corners - 2], hull[corners - 1], points_[i])) {
      --corners;
    }
    hull[corners++] = points_[i];
    mean_x += points_[i].x / static_cast<double>(count_);
  }
  // The edge over the mean is the line whose heights sum up to the least.
  for (std::size_t i = 1; i < corners; ++i) {
    if (hull[i].x >= mean_x) {
      return (hull[i].y - hull[i - 1].y) / (hull[i].x - hull[i - 1].x);
    }
  }
  return fallback;
}

LowerLine::Line LowerLine::fit(const Slopes& slopes) const noexcept {
  Line line;
  line.slope = std::clamp(hull_slope(slopes.otherwise), slopes.least, slopes.greatest);
  line.offset = points_[0].y - line.slope * points_[0].x;
  for (std::size_t i = 1; i < count_; ++i) {
    line.offset = std::min(line.offset, points_[i].y - line.slope * points_[i].x);
  }
  return line;
}

namespace {

constexpr double kIntervalNs = 250e6;
constexpr double kIntervalPeriods = 50.0;  // a reading more or less must not look like another rate
constexpr double kCorrectionMax = 0.002;   // steadily; less is what lumps and single gaps do
constexpr double kBeyondTolerance = 0.005;
constexpr double kSuspectPeriods = 2.5;  // in one interval: two intervals may lose some by chance
constexpr double kSettledLeast = 0.5;

/// Mean of `values` without the `extremes` greatest and least.
template <std::size_t kCount>
double trimmed_mean(std::array<double, kCount> values, std::size_t extremes) noexcept {
  std::sort(values.begin(), values.end());
  double sum = 0.0;
  for (std::size_t i = extremes; i < kCount - extremes; ++i) {
    sum += values[i];
  }
  return sum / static_cast<double>(kCount - 2 * extremes);
}

}  // namespace

void RateCheck::begin(double tolerance, double period_ns) noexcept {
  const bool was_in_doubt = in_doubt_;
  *this = {};
  in_doubt_ = was_in_doubt;
  tolerance_ = tolerance;
  period_ns_ = period_ns;
  interval_ns_ = std::max(kIntervalNs, kIntervalPeriods * period_ns);
}

RateVerdict RateCheck::add(double elapsed_ns, double correction_ns, double slope_off,
                           bool is_settled) noexcept {
  open_.elapsed_ns += elapsed_ns;
  open_.correction_ns += correction_ns;
  open_.slope_off_ns += slope_off * elapsed_ns;
  open_.unsettled_ns += is_settled ? 0.0 : elapsed_ns;
  if (open_.elapsed_ns < interval_ns_) {
    return RateVerdict::Unchanged;
  }
  const std::size_t place = closed_++ % kIntervals;
  corrections_[place] = open_.correction_ns / open_.elapsed_ns;
  periods_off_[place] = (open_.correction_ns + open_.slope_off_ns) / open_.elapsed_ns;
  const double beyond = std::max(kBeyondTolerance, kSuspectPeriods * period_ns_ / open_.elapsed_ns);
  const double off = std::abs(periods_off_[place]) > tolerance_ + beyond ? periods_off_[place] : 0.0;
  is_suspect_ = off * last_off_ > 0.0;
  last_off_ = off;
  unsettled_[place] = open_.unsettled_ns > (1.0 - kSettledLeast) * open_.elapsed_ns;
  open_ = {};
  return judge();
}

RateVerdict RateCheck::judge() noexcept {
  if (closed_ < kIntervals) {
    return in_doubt_ ? RateVerdict::InDoubt : RateVerdict::Unchanged;
  }
  const auto unsettled = std::count(unsettled_.begin(), unsettled_.end(), true);
  period_off_ = trimmed_mean(periods_off_, kExtremes);
  const bool was_in_doubt = in_doubt_;
  in_doubt_ = unsettled > static_cast<std::ptrdiff_t>(kIntervals / 2) ||
              std::abs(period_off_) > tolerance_ + kBeyondTolerance;
  if (in_doubt_) {
    return RateVerdict::InDoubt;
  }
  if (!was_in_doubt && std::abs(trimmed_mean(corrections_, kExtremes)) <= kCorrectionMax) {
    return RateVerdict::Unchanged;
  }
  std::transform(periods_off_.begin(), periods_off_.end(), corrections_.begin(),
                 [this](double off) { return off - period_off_; });  // as the new period would have needed
  return RateVerdict::Corrected;
}

namespace {

constexpr std::size_t kWindowCalls = 4;
constexpr std::size_t kWindowsToSettle = 2;
constexpr double kLateLumps = 2.0;   // what is later may have been held up
constexpr double kBucketNs = 250e6;  // holds many lumps; LowerLine keeps 16 s of them
constexpr std::size_t kBucketCalls = 8;
constexpr std::size_t kPointsToKnow = 8;  // of 0.25 s each, that give the period better than the nominal one
constexpr double kBurstShare = 0.75;      // of its time: a bucket that came in less was held up before
constexpr double kAgreeShare = 0.1;  // of its time: buckets of a queue that empties differ by more in slack
// Of a lump, or of a period: a line that has to be put so much earlier within a bucket was no phase.
constexpr double kPulledLumps = 0.25;
constexpr double kPulledPeriods = 2.0;

}  // namespace

void SampleClock::set_rate(double rate_hz) noexcept {
  nominal_ns_ = 1e9 / rate_hz;
  known_slope_ = nominal_ns_;
  line_ = {nominal_ns_, 0.0};
  running_ = false;
  check_.begin(config_.tolerance_ppm * 1e-6, nominal_ns_);
  checked_.reset();
}

void SampleClock::skip(std::size_t readings) noexcept {
  if (running_) {
    x_ += static_cast<double>(readings);
  }
}

void SampleClock::stamp(Stamp latest, std::span<Stamp> into) noexcept {
  if (into.empty()) {
    return;
  }
  const auto count = static_cast<double>(into.size());
  if (config_.timing == SampleTiming::AsArrived) {
    base_ = latest;
    emit(into, 0.0, nominal_ns_);
    return;
  }
  const auto stop_ns = static_cast<double>(config_.stop.count());
  if (!running_ || static_cast<double>((latest - base_).count()) - at(x_ + count) > stop_ns) {
    lock(latest);
  } else {
    x_ += count;
  }
  window_.readings += count;
  bucket_.readings += count;
  track(static_cast<double>((latest - base_).count()));
  emit(into, at(x_), line_.slope);
  check(latest);
}

bool SampleClock::knows_phase() const noexcept {
  return config_.timing == SampleTiming::AsArrived || (running_ && windows_ >= kWindowsToSettle && !is_late_);
}

void SampleClock::lock(Stamp latest) noexcept {
  relocks_ += ever_ran_ ? 1 : 0;
  ever_ran_ = true;
  running_ = true;
  base_ = latest;
  x_ = 0.0;
  line_.offset = 0.0;
  renew();
}

/// The phase is to be found anew; of the period what was known stays.
void SampleClock::renew() noexcept {
  points_.clear();
  set_slope(known_slope_);
  window_ = {};
  bucket_ = {};
  before_last_ = last_ = last_bucket_ = 0.0;
  windows_ = 0;
}

/// From the newest reading on.
void SampleClock::set_slope(double slope) noexcept {
  line_ = {slope, at(x_) - slope * x_};
}

void SampleClock::track(double y) noexcept {
  double slack = y - at(x_);
  if (slack < 0.0) {
    pull(-slack);
    slack = 0.0;
  }
  is_late_ = slack > kLateLumps * static_cast<double>(config_.lump.count());
  for (Window* window : {&window_, &bucket_}) {
    window->first_y = window->calls == 0 ? y : window->first_y;
    window->last_y = y;
    if (window->calls++ == 0 || slack <= window->least_slack) {
      window->least_slack = slack;
      window->least = {x_, y};
    }
  }
  if (is_full(window_, static_cast<double>(config_.lump.count()), kWindowCalls)) {
    close_window();
  }
  if (is_full(bucket_, kBucketNs, kBucketCalls)) {
    close_bucket();
  }
}

/// The newest reading cannot have been sent after it arrived: the line was too late. One that was much too
/// late was never the phase, and what it was fitted to were delays: together with them it would be taken for
/// a wrong period, and then the right one for readings that are missing.
void SampleClock::pull(double by_ns) noexcept {
  line_.offset -= by_ns;
  correction_ns_ -= by_ns;
  raise(-by_ns);
  bucket_.pulled_ns += by_ns;
  const double most_ns =
      std::max(kPulledLumps * static_cast<double>(config_.lump.count()), kPulledPeriods * nominal_ns_);
  if (bucket_.pulled_ns > most_ns) {
    renew();
  }
}

/// What the windows remember is slack over a line that has risen by `by_ns` since.
void SampleClock::raise(double by_ns) noexcept {
  for (double* slack : {&window_.least_slack, &bucket_.least_slack, &last_, &before_last_, &last_bucket_}) {
    *slack = std::max(0.0, *slack - by_ns);
  }
}

bool SampleClock::is_full(const Window& window, double length_ns, std::size_t calls) const noexcept {
  return window.calls >= calls && window.readings * nominal_ns_ >= length_ns;
}

/// A gap shows as a step in the least slack of windows: one without it, then two that agree. (After a stall
/// of the host the slack is large too, but shrinks from window to window while the queue empties.)
void SampleClock::close_window() noexcept {
  const double now = window_.least_slack;
  window_ = {};
  ++windows_;
  if (windows_ >= 3) {
    const double step = std::round((std::min(now, last_) - before_last_) / nominal_ns_);
    if (step >= 1.0 && std::abs(now - last_) < 0.5 * nominal_ns_) {
      move_on(step);
      before_last_ = last_ = std::max(0.0, now - step * nominal_ns_);
      return;
    }
  }
  before_last_ = last_;
  last_ = now;
}

/// A point that lies above the line is explained by a gap that the windows did not find. While the period is
/// not known from many points, another period within the tolerance is likelier, where it can explain it.
void SampleClock::close_bucket() noexcept {
  const Window closed = std::exchange(bucket_, {});
  const double length_ns = closed.readings * nominal_ns_;
  const bool agrees = std::abs(closed.least_slack - last_bucket_) < kAgreeShare * length_ns;
  last_bucket_ = closed.least_slack;
  const bool is_late = closed.least_slack > kLateLumps * static_cast<double>(config_.lump.count());
  const bool is_burst = closed.last_y - closed.first_y < kBurstShare * length_ns;
  if ((is_late && !agrees) || (is_burst && closed.least_slack > nominal_ns_)) {
    return;  // held up: the next bucket shows whether it stays so late
  }
  const LowerLine::Line before = line_;
  const bool knows_period = points_.size() >= kPointsToKnow || is_in_doubt();
  points_.add(closed.least);
  fit();
  const double height_ns = knows_period ? closed.least_slack : closed.least.y - at(closed.least.x);
  const double periods = std::floor(height_ns / nominal_ns_ - 0.5);
  if (periods >= 1.0) {
    points_.drop_newest();
    points_.add({closed.least.x + periods, closed.least.y});
    move_on(periods);
    fit();
  }
  const double change = at(x_) - (before.offset + before.slope * x_);
  correction_ns_ += change;
  raise(change);
  rebase();
}

void SampleClock::fit() noexcept {
  line_ = points_.fit({slope_least(), slope_greatest(), known_slope_});
  if (points_.size() >= kPointsToKnow) {
    known_slope_ = line_.slope;
  }
}

void SampleClock::move_on(double periods) noexcept {
  x_ += periods;
  missing_ += static_cast<std::uint64_t>(periods);
  correction_ns_ += periods * nominal_ns_;
  const double by_ns = periods * nominal_ns_;
  last_bucket_ = std::max(0.0, last_bucket_ - by_ns);
  if (bucket_.calls > 0 && bucket_.least_slack > by_ns - 0.5 * nominal_ns_) {
    // All of the bucket came after the gap.
    bucket_.least_slack = std::max(0.0, bucket_.least_slack - by_ns);
    bucket_.least.x += periods;
  }
}

/// While in doubt the clock runs at the nominal rate, so that its corrections show the true one.
void SampleClock::check(Stamp latest) noexcept {
  const double elapsed_ns = checked_ ? std::max(0.0, static_cast<double>((latest - *checked_).count())) : 0.0;
  checked_ = std::max(latest, checked_.value_or(latest));
  const double slope_off = line_.slope / nominal_ns_ - 1.0;
  const RateVerdict verdict =
      check_.add(elapsed_ns, std::exchange(correction_ns_, 0.0), slope_off, knows_phase());
  if (verdict != RateVerdict::Unchanged) {
    const double off = verdict == RateVerdict::Corrected ? check_.period_off() : 0.0;
    known_slope_ = std::clamp(nominal_ns_ * (1.0 + off), slope_least(), slope_greatest());
    points_.clear();
    set_slope(known_slope_);
  }
}

/// Keeps numbers small: a double holds nanoseconds of months, but not of years times counts.
void SampleClock::rebase() noexcept {
  const double whole_ns = std::floor(at(x_));
  base_ += Stamp(static_cast<Stamp::rep>(whole_ns));
  points_.shift(-x_, -whole_ns);
  line_.offset = at(x_) - whole_ns;
  x_ = 0.0;
}

void SampleClock::emit(std::span<Stamp> into, double last_ns, double period_ns) noexcept {
  const auto count = into.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double time_ns = last_ns - static_cast<double>(count - 1 - i) * period_ns;
    Stamp stamp = base_ + Stamp(static_cast<Stamp::rep>(std::floor(time_ns)));
    if (emitted_ != Stamp::min() && stamp <= emitted_) {
      stamp = emitted_ + Stamp(1);
    }
    emitted_ = stamp;
    into[i] = stamp;
  }
}

}  // namespace slamsensor::hal
