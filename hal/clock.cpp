#include "hal/clock.hpp"

#include <ctime>

namespace slamsensor::hal {

namespace {

Stamp now_on(clockid_t clock) noexcept {
  timespec time{};
  ::clock_gettime(clock, &time);
  return std::chrono::seconds(time.tv_sec) + Stamp(time.tv_nsec);
}

}  // namespace

Stamp monotonic_now() noexcept {
  return now_on(CLOCK_MONOTONIC);
}

Stamp realtime_ahead() noexcept {
  Stamp shortest = Stamp::max();
  Stamp ahead{};
  for (int i = 0; i < 3; ++i) {
    const Stamp before = now_on(CLOCK_MONOTONIC);
    const Stamp realtime = now_on(CLOCK_REALTIME);
    const Stamp took = now_on(CLOCK_MONOTONIC) - before;
    if (took < shortest) {
      shortest = took;
      ahead = realtime - (before + took / 2);
    }
  }
  return ahead;
}

}  // namespace slamsensor::hal
