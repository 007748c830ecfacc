#pragma once

#include "hal/counters.hpp"
#include "hal/stamp.hpp"

#include <chrono>
#include <cstddef>
#include <poll.h>
#include <span>
#include <string_view>

namespace slamsensor::firmware {

/// One moment on both clocks.
struct OutputTime {
  hal::Stamp monotonic{};
  std::chrono::nanoseconds utc{0};  ///< since 1970-01-01, as the system's clock has it
};

/// Somewhere that the bytes of epochs go: a serial line, network clients, a recording. It never waits and,
/// once made, never allocates; what it cannot take now is lost whole, and counted. One thread.
class EpochSink {
 public:
  EpochSink() = default;
  EpochSink(const EpochSink&) = delete;
  EpochSink& operator=(const EpochSink&) = delete;
  virtual ~EpochSink() = default;

  /// Does what is due beside sending: brings back what is lost, takes in clients, throws away input, sends
  /// the rest of earlier epochs. `now` never decreases. Call it at least every 100 ms.
  virtual void step(hal::Stamp now) noexcept = 0;

  /// All of `epoch`, whole sentences, goes out after what went before, or none of it.
  virtual void send(std::span<const char> epoch, const OutputTime& now) noexcept = 0;

  /// Puts what a poll() may wait on into `into`, as many as fit, and returns how many: when one becomes ready
  /// there is something for step() to do. They change with every call of step() and send().
  [[nodiscard]] virtual std::size_t poll_on(std::span<pollfd> into) const noexcept = 0;

  /// What stands in the way and what to do, for a person; empty when nothing does. Lives until the next call
  /// of step().
  [[nodiscard]] virtual std::string_view problem() const noexcept = 0;

  /// Names begin with that of the sink.
  [[nodiscard]] virtual std::span<const hal::Counter> counters() const noexcept = 0;
};

}  // namespace slamsensor::firmware
