#include "hal/timing/sample_clock.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::hal {
namespace {

constexpr std::size_t kWindowCalls = 4;
constexpr std::size_t kWindowsToSettle = 2;
constexpr double kBucketNs = 250e6;  // holds many lumps; LowerLine keeps 16 s of them
constexpr std::size_t kBucketCalls = 8;

}  // namespace

void SampleClock::set_rate(double rate_hz) noexcept {
  nominal_ns_ = 1e9 / rate_hz;
  line_ = {nominal_ns_, 0.0};
  running_ = false;
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
}

bool SampleClock::settled() const noexcept {
  return config_.timing == SampleTiming::AsArrived || (running_ && windows_ >= kWindowsToSettle && !is_late_);
}

void SampleClock::lock(Stamp latest) noexcept {
  relocks_ += ever_ran_ ? 1 : 0;
  ever_ran_ = true;
  running_ = true;
  base_ = latest;
  x_ = 0.0;
  line_.offset = 0.0;
  points_.clear();
  window_ = {};
  bucket_ = {};
  windows_ = 0;
}

void SampleClock::track(double y) noexcept {
  double slack = y - at(x_);
  if (slack < 0.0) {
    // The reading cannot have been sent after it arrived: the line was too late.
    line_.offset += slack;
    raise(slack);
    slack = 0.0;
  }
  is_late_ = slack > 2.0 * static_cast<double>(config_.lump.count());
  for (Window* window : {&window_, &bucket_}) {
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

/// What the windows remember is slack over a line that has risen by `by_ns` since.
void SampleClock::raise(double by_ns) noexcept {
  for (double* slack : {&window_.least_slack, &bucket_.least_slack, &last_, &before_last_}) {
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

void SampleClock::close_bucket() noexcept {
  const LowerLine::Point least = bucket_.least;
  const double periods = std::floor(bucket_.least_slack / nominal_ns_ - 0.5);
  bucket_ = {};
  if (periods >= 1.0) {
    move_on(periods);  // a gap that the windows did not find
    return;
  }
  points_.add(least);
  const double tolerance_ns = nominal_ns_ * config_.tolerance_ppm * 1e-6;
  const double before = at(x_);
  line_ = points_.fit(nominal_ns_ - tolerance_ns, nominal_ns_ + tolerance_ns);
  const double change = at(x_) - before;
  raise(change);
  rebase();
}

void SampleClock::move_on(double periods) noexcept {
  x_ += periods;
  missing_ += static_cast<std::uint64_t>(periods);
  bucket_ = {};
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
