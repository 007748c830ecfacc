#pragma once

#include "firmware/supervision/file_descriptor.hpp"
#include "firmware/supervision/unix_address.hpp"
#include "hal/stamp.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// Tells the service manager how the daemon stands (sd_notify(3): datagrams to the socket of NOTIFY_SOCKET).
/// Without a service manager everything here does nothing. Never waits. One thread.
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

}  // namespace slamsensor::firmware
