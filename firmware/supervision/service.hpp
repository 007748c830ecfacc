#pragma once

#include "firmware/supervision/file_descriptor.hpp"
#include "hal/stamp.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// Whether each thread of the daemon still makes progress. The threads beat, one watches.
class Heartbeats {
 public:
  static constexpr std::size_t kThreadsMax = 8;

  struct Thread {
    std::string_view name;     ///< lives as long as the program
    hal::Stamp silence_max{};  ///< it must beat at least this often
  };

  struct Stalled {
    std::string_view name;
    hal::Stamp silence{};
  };

  /// Adds a thread before any of them starts, and gives its number for beat(); none when there are
  /// kThreadsMax.
  [[nodiscard]] std::optional<std::size_t> add(const Thread& thread) noexcept;

  /// The thread of that number has made progress. Waits for nothing; safe on real-time threads.
  void beat(std::size_t thread) noexcept {
    if (thread < kThreadsMax) {
      beats_[thread].count.fetch_add(1, std::memory_order_relaxed);
    }
  }

  /// Looks at all threads; the one that has been silent longest beyond what it may, if there is one. Silence
  /// counts from the first look on. One thread, `now` never decreases.
  [[nodiscard]] std::optional<Stalled> check(hal::Stamp now) noexcept;

 private:
  struct alignas(64) Beat {  // a cache line each: threads on other cores do not disturb each other
    std::atomic<std::uint64_t> count{0};
  };
  struct Watched {
    Thread thread;
    std::uint64_t count = 0;
    hal::Stamp changed = -hal::kNever;
  };

  std::array<Beat, kThreadsMax> beats_{};
  std::array<Watched, kThreadsMax> watched_{};
  std::size_t size_ = 0;
};

/// Reports to the service manager how the daemon stands (sd_notify(3): datagrams to the socket of
/// NOTIFY_SOCKET). Without a service manager everything here does nothing. Never waits. One thread.
class ServiceNotifier {
 public:
  /// As the environment says: NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID (sd_watchdog_enabled(3)).
  [[nodiscard]] static ServiceNotifier from_environment();

  /// Sends to nobody.
  ServiceNotifier() = default;

  /// The devices have answered; also the end of a reload.
  void ready() { send("READY=1"); }
  /// A reload begins at `now`; ready() ends it.
  void reloading(hal::Stamp now);
  void stopping() { send("STOPPING=1"); }
  /// One line for people; sent when it differs from the last one.
  void status(std::string_view line);
  void feed_watchdog() { send("WATCHDOG=1"); }
  /// The manager waits for the next step of start or stop this much longer.
  void extend_timeout(hal::Stamp by);

  /// Within which the watchdog must be fed; none when nobody watches this process.
  [[nodiscard]] std::optional<hal::Stamp> watchdog_period() const noexcept { return watchdog_; }
  [[nodiscard]] bool is_managed() const noexcept { return static_cast<bool>(socket_); }
  /// Messages that the manager did not take.
  [[nodiscard]] std::uint64_t unsent() const noexcept { return unsent_; }

 private:
  bool send(std::string_view message) noexcept;

  FileDescriptor socket_;
  UnixAddress address_;
  std::optional<hal::Stamp> watchdog_;
  std::string status_;
  std::uint64_t unsent_ = 0;
};

/// Feeds the service manager's watchdog while every thread makes progress, and lets it starve when one does
/// not: the manager then ends the daemon and starts it again.
class Watchdog {
 public:
  /// Both outlive this.
  Watchdog(Heartbeats& heartbeats, ServiceNotifier& notifier)
      : heartbeats_(heartbeats), notifier_(notifier) {}

  /// The main thread calls this in every turn, at least every second. Feeds three times within the period,
  /// unless a thread is stalled; that thread is returned, also when nobody watches.
  std::optional<Heartbeats::Stalled> step(hal::Stamp now);

 private:
  Heartbeats& heartbeats_;
  ServiceNotifier& notifier_;
  std::optional<hal::Stamp> fed_;
};

}  // namespace slamsensor::firmware
