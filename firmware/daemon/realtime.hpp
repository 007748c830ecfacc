#pragma once

#include "firmware/config/daemon_config.hpp"
#include "hal/counters.hpp"
#include "hal/stamp.hpp"

#include <tl/expected.hpp>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <functional>
#include <pthread.h>
#include <semaphore.h>
#include <span>
#include <string>

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

/// Locks all memory of the process, present and future, and has the heap keep what is freed, so that no
/// later use meets a page fault. The error says what is missing and how to get it.
[[nodiscard]] tl::expected<void, std::string> lock_memory();

/// Raises the limit of open files as far as the system allows. An error when fewer than `needed` may be open.
[[nodiscard]] tl::expected<void, std::string> raise_open_files(std::uint64_t needed);

/// How a thread is scheduled.
struct ThreadConfig {
  std::string name;                 ///< at most 15 characters, for top and gdb
  std::uint32_t fifo_priority = 0;  ///< of SCHED_FIFO; 0: the ordinary scheduler
  std::size_t stack_bytes = 512 * 1024;
};

/// A thread that runs `body` from its start and is joined by destruction. Every page of its stack has been
/// written to before, and a guard page lies below it.
class Thread {
 public:
  /// The error names the thread, and of a refused priority what to do.
  [[nodiscard]] static tl::expected<Thread, std::string> start(const ThreadConfig& config,
                                                               std::function<void()> body);

  Thread() = default;
  Thread(Thread&& other) noexcept;
  Thread& operator=(Thread&& other) noexcept;
  ~Thread() { join(); }

  void join();

 private:
  class Stack {
   public:
    Stack() = default;
    explicit Stack(std::size_t bytes);
    Stack(Stack&& other) noexcept;
    Stack& operator=(Stack&& other) noexcept;
    ~Stack();
    /// Its lowest byte; null when there was no memory.
    [[nodiscard]] std::byte* bytes() const;

   private:
    std::byte* memory_ = nullptr;
    std::size_t size_ = 0;
  };

  Stack stack_;
  pthread_t id_{};
  bool is_running_ = false;
};

enum class TimerEvent : std::uint8_t {
  Wakes,
  PeriodsSkipped,  ///< that were over before the step of an earlier one had ended
  DeadlineMisses,  ///< steps that ended later than the deadline after they were due
};

/// Calls a step at a fixed period, and keeps the books of how well that goes (slips are counted, never made
/// up for). One thread. No allocation, no lock.
class PeriodicTimer {
 public:
  /// `period` is positive. The first step is due at once.
  PeriodicTimer(hal::Stamp period, hal::Stamp deadline) noexcept;

  /// Sleeps until the next step is due and returns the time then.
  [[nodiscard]] hal::Stamp wait() noexcept;
  /// The next step is due at once: the thread was stopped meanwhile. The books go on.
  void restart() noexcept { is_first_ = true; }
  /// The step has ended at `now`.
  void end_step(hal::Stamp now) noexcept;

  /// When the step under way was due.
  [[nodiscard]] hal::Stamp due() const noexcept { return due_; }
  /// Worst time from due to awake since construction.
  [[nodiscard]] hal::Stamp wake_latency_max() const noexcept { return wake_latency_max_; }
  /// Worst time that a step took.
  [[nodiscard]] hal::Stamp step_max() const noexcept { return step_max_; }
  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept { return counters_.all(); }
  [[nodiscard]] std::uint64_t count(TimerEvent event) const noexcept { return counters_[event]; }

  /// `wait` without the sleep, for tests: the step due is begun at `now`.
  void begin_step(hal::Stamp now) noexcept;

 private:
  hal::Stamp period_;
  hal::Stamp deadline_;
  hal::Stamp due_{};
  hal::Stamp begun_{};
  bool is_first_ = true;
  hal::Stamp wake_latency_max_{};
  hal::Stamp step_max_{};
  hal::EventCounters<TimerEvent, 3> counters_;
};

}  // namespace slamsensor::firmware
