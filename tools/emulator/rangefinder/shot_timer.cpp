#include "tools/emulator/rangefinder/shot_timer.hpp"

#include <cmath>

namespace slamsensor::tools {

void ShotTimer::start(hal::Stamp at, double rate_hz) {
  period_ns_ = 1e9 / (rate_hz * speed_);
  origin_ = at;
  next_ = at;
  done_ = 0;
}

void ShotTimer::start_after(hal::Stamp now, double rate_hz) {
  start(now, rate_hz);
  advance();
}

void ShotTimer::advance() {
  ++done_;
  next_ = origin_ + hal::Stamp(std::llround(static_cast<double>(done_) * period_ns_));
}

}  // namespace slamsensor::tools
