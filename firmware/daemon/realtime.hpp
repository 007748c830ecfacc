#pragma once

#include "firmware/config/daemon_config.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <pthread.h>
#include <string>

namespace slamsensor::firmware {

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

}  // namespace slamsensor::firmware
