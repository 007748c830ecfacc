#pragma once

#include "hal/clock.hpp"
#include "tests/contract/rig.hpp"

#include <thread>

namespace slamsensor::tests {

/// The time of a rig whose far end is the kernel's: the link is told a time that runs as the tests say, so
/// that waits of seconds take none, while the kernel has a moment of real time for each step.
template <typename R>
class RealRig : public R {
 public:
  [[nodiscard]] hal::Stamp now() const override { return now_; }
  [[nodiscard]] hal::Stamp stamping_clock() const override { return hal::monotonic_now(); }

  void pass(hal::Stamp time) override {
    now_ += time;
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }

 private:
  hal::Stamp now_ = hal::monotonic_now();
};

}  // namespace slamsensor::tests
