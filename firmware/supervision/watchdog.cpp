#include "firmware/supervision/watchdog.hpp"

namespace slamsensor::firmware {

std::optional<Heartbeats::Stalled> Watchdog::step(hal::Stamp now) {
  const auto stalled = heartbeats_.check(now);
  const auto period = notifier_.watchdog_period();
  if (!stalled && period && (!fed_ || now - *fed_ >= *period / 3)) {
    notifier_.feed_watchdog();
    fed_ = now;
  }
  return stalled;
}

}  // namespace slamsensor::firmware
