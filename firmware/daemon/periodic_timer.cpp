#include "firmware/daemon/periodic_timer.hpp"

#include "hal/clock.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <string_view>

namespace slamsensor::firmware {
namespace {

constexpr std::array<std::string_view, 3> kNames = {"wakes", "periods_skipped", "deadline_misses"};

void sleep_until(hal::Stamp time) noexcept {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  const timespec at{static_cast<std::time_t>(seconds.count()), static_cast<long>((time - seconds).count())};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr) == EINTR) {
  }
}

}  // namespace

PeriodicTimer::PeriodicTimer(hal::Stamp period, hal::Stamp deadline) noexcept
    : period_(period), deadline_(deadline), counters_(kNames) {
}

hal::Stamp PeriodicTimer::wait() noexcept {
  if (!is_first_) {
    sleep_until(due_ + period_);
  }
  begin_step(hal::monotonic_now());
  return begun_;
}

void PeriodicTimer::begin_step(hal::Stamp now) noexcept {
  counters_.count(TimerEvent::Wakes);
  due_ = is_first_ ? now : due_ + period_;
  is_first_ = false;
  begun_ = now;
  wake_latency_max_ = std::max(wake_latency_max_, now - due_);
}

void PeriodicTimer::end_step(hal::Stamp now) noexcept {
  step_max_ = std::max(step_max_, now - begun_);
  if (now - due_ > deadline_) {
    counters_.count(TimerEvent::DeadlineMisses);
  }
  if (now > due_ + period_) {
    const auto skipped = (now - due_ - hal::Stamp(1)) / period_;
    counters_.count(TimerEvent::PeriodsSkipped, static_cast<std::uint64_t>(skipped));
    due_ += skipped * period_;
  }
}

}  // namespace slamsensor::firmware
