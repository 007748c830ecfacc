#pragma once

#include "tools/emulator/emulated_device.hpp"

#include <stdexcept>

namespace slamsensor::tools {

/// A line with the emulated devices on it: what happens on it happens in the order of time.
class DeviceLine {
 public:
  DeviceLine() = default;
  DeviceLine(const DeviceLine&) = delete;
  DeviceLine& operator=(const DeviceLine&) = delete;
  virtual ~DeviceLine() = default;

  /// The earliest time at which something happens by itself in a device or to the host's sendings;
  /// hal::kNever when nothing is due. What arrives at the host is no event: it waits to be taken.
  [[nodiscard]] virtual Stamp next_event() const = 0;

  /// When the next byte or frame arrives at the host; hal::kNever when nothing is on its way.
  [[nodiscard]] virtual Stamp next_delivery() const = 0;

  /// Everything up to and including `now` has happened. `now` never decreases.
  virtual void advance(Stamp now) = 0;

  /// Lets `fault` begin at its time, to which the line was advanced; false when neither the line nor a device
  /// on it knows the kind.
  virtual bool inject(const Fault& fault) = 0;
};

/// Ends a program whose device asks for the same moment again and again, instead of hanging.
class EventGuard {
 public:
  /// Throws std::logic_error after 100,000 events at one moment.
  void count(Stamp event) {
    repeats_ = event == last_ ? repeats_ + 1 : 0;
    last_ = event;
    if (repeats_ > kRepeatsMax) {
      throw std::logic_error("an emulated device stays at one moment: next_event() does not get on");
    }
  }

 private:
  static constexpr int kRepeatsMax = 100'000;
  Stamp last_ = Stamp::min();
  int repeats_ = 0;
};

/// Runs `step(t)` for every event of `line` up to `now`, in order.
template <typename Line, typename Step>
void run_events(const Line& line, EventGuard& guard, Stamp now, Step step) {
  for (Stamp event = line.next_event(); event <= now; event = line.next_event()) {
    guard.count(event);
    step(event);
  }
}

}  // namespace slamsensor::tools
