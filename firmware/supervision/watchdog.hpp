#pragma once

#include "firmware/supervision/heartbeats.hpp"
#include "firmware/supervision/service_notifier.hpp"

#include <optional>

namespace slamsensor::firmware {

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
