#include "firmware/daemon/realtime.hpp"

#include "hal/clock.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <malloc.h>
#include <memory>
#include <sched.h>
#include <string_view>
#include <sys/mman.h>
#include <sys/resource.h>
#include <utility>

namespace slamsensor::firmware {
namespace {

constexpr std::size_t kGuard_bytes = 4096;

void* run(void* argument) {
  const std::unique_ptr<std::function<void()>> body(static_cast<std::function<void()>*>(argument));
  (*body)();
  return nullptr;
}

/// Attributes of a thread, freed at the end.
class Attributes {
 public:
  Attributes() { pthread_attr_init(&attributes_); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
  ~Attributes() { pthread_attr_destroy(&attributes_); }

  [[nodiscard]] int set(const ThreadConfig& config, std::byte* stack) {
    int error = pthread_attr_setstack(&attributes_, stack, config.stack_bytes);
    if (error == 0 && config.fifo_priority > 0) {
      sched_param parameters{};
      parameters.sched_priority = static_cast<int>(config.fifo_priority);
      error = pthread_attr_setinheritsched(&attributes_, PTHREAD_EXPLICIT_SCHED);
      error = error != 0 ? error : pthread_attr_setschedpolicy(&attributes_, SCHED_FIFO);
      error = error != 0 ? error : pthread_attr_setschedparam(&attributes_, &parameters);
    }
    return error;
  }
  [[nodiscard]] const pthread_attr_t* get() const { return &attributes_; }

 private:
  pthread_attr_t attributes_{};
};

std::string refusal(const ThreadConfig& config, int error) {
  std::string text = "thread " + config.name + ": ";
  if (error == EPERM && config.fifo_priority > 0) {
    return text + "no right to SCHED_FIFO priority " + std::to_string(config.fifo_priority) +
           "; give the service LimitRTPRIO=" + std::to_string(config.fifo_priority) +
           " (or CAP_SYS_NICE), or set realtime.mode = \"optional\"";
  }
  return text + "cannot be started: " + std::strerror(error);
}

constexpr std::array<std::string_view, 3> kNames = {"wakes", "periods_skipped", "deadline_misses"};

void sleep_until(hal::Stamp time) noexcept {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  const timespec at{static_cast<std::time_t>(seconds.count()), static_cast<long>((time - seconds).count())};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr) == EINTR) {
  }
}

}  // namespace

tl::expected<void, std::string> lock_memory() {
  // Freed memory stays in the process, and no allocation becomes a mapping of its own.
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_ARENA_MAX, 1);  // each further heap would lock 64 MiB of addresses; the threads hardly allocate
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    return tl::unexpected(std::string("memory cannot be locked: ") + std::strerror(errno) +
                          "; give the service LimitMEMLOCK=infinity (or CAP_IPC_LOCK), or set "
                          "realtime.mode = \"optional\"");
  }
  return {};
}

tl::expected<void, std::string> raise_open_files(std::uint64_t needed) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) {
    return tl::unexpected(std::string("the limit of open files cannot be read: ") + std::strerror(errno));
  }
  if (limit.rlim_cur < limit.rlim_max) {
    rlimit raised = limit;
    raised.rlim_cur = limit.rlim_max;
    limit = ::setrlimit(RLIMIT_NOFILE, &raised) == 0 ? raised : limit;
  }
  if (limit.rlim_cur < needed) {
    return tl::unexpected("only " + std::to_string(limit.rlim_cur) + " files may be open and up to " +
                          std::to_string(needed) +
                          " are needed; give the service LimitNOFILE=" + std::to_string(needed) + " or more");
  }
  return {};
}

tl::expected<Thread, std::string> Thread::start(const ThreadConfig& config, std::function<void()> body) {
  Thread thread;
  thread.stack_ = Stack(config.stack_bytes);
  Attributes attributes;
  int error = thread.stack_.bytes() == nullptr ? ENOMEM : attributes.set(config, thread.stack_.bytes());
  if (error == 0) {
    auto owned = std::make_unique<std::function<void()>>(std::move(body));
    error = pthread_create(&thread.id_, attributes.get(), run, owned.get());
    if (error == 0) {
      static_cast<void>(owned.release());  // the thread's
      thread.is_running_ = true;
      pthread_setname_np(thread.id_, config.name.c_str());
    }
  }
  if (error != 0) {
    return tl::unexpected(refusal(config, error));
  }
  return thread;
}

Thread::Thread(Thread&& other) noexcept
    : stack_(std::move(other.stack_)), id_(other.id_), is_running_(std::exchange(other.is_running_, false)) {
}

Thread& Thread::operator=(Thread&& other) noexcept {
  join();
  stack_ = std::move(other.stack_);
  id_ = other.id_;
  is_running_ = std::exchange(other.is_running_, false);
  return *this;
}

void Thread::join() {
  if (std::exchange(is_running_, false)) {
    pthread_join(id_, nullptr);
  }
}

Thread::Stack::Stack(std::size_t bytes) : size_(bytes + kGuard_bytes) {
  void* const memory =
      mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK, -1, 0);
  if (memory == MAP_FAILED) {
    return;
  }
  memory_ = static_cast<std::byte*>(memory);
  std::memset(this->bytes(), 0, bytes);
  mprotect(memory_, kGuard_bytes, PROT_NONE);
}

Thread::Stack::Stack(Stack&& other) noexcept
    : memory_(std::exchange(other.memory_, nullptr)), size_(other.size_) {
}

Thread::Stack& Thread::Stack::operator=(Stack&& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(size_, other.size_);
  return *this;
}

Thread::Stack::~Stack() {
  if (memory_ != nullptr) {
    munmap(memory_, size_);
  }
}

std::byte* Thread::Stack::bytes() const {
  return memory_ == nullptr ? nullptr : memory_ + kGuard_bytes;
}

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
