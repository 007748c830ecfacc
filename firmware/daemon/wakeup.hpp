#pragma once

#include "hal/stamp.hpp"

#include <cerrno>
#include <ctime>
#include <semaphore.h>

namespace slamsensor::firmware {

/// Wakes one waiting thread. `notify` never waits and may be called on a real-time thread.
class Wakeup {
 public:
  Wakeup() { sem_init(&semaphore_, 0, 0); }
  Wakeup(const Wakeup&) = delete;
  Wakeup& operator=(const Wakeup&) = delete;
  ~Wakeup() { sem_destroy(&semaphore_); }

  void notify() noexcept { sem_post(&semaphore_); }

  /// Returns after a notify (one for each) or at `until` on CLOCK_MONOTONIC.
  void wait(hal::Stamp until) noexcept {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(until);
    const timespec at{static_cast<std::time_t>(seconds.count()),
                      static_cast<long>((until - seconds).count())};
    while (sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &at) != 0 && errno == EINTR) {
    }
  }

 private:
  sem_t semaphore_;
};

}  // namespace slamsensor::firmware
