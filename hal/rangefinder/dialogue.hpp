#pragma once

#include "hal/device.hpp"
#include "hal/rangefinder/rangefinder.hpp"
#include "hal/transport/byte_link.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace slamsensor::hal {

/// What a start-up needs of the line to its device, whichever kind it is.
class DeviceLine {
 public:
  DeviceLine() = default;
  DeviceLine(const DeviceLine&) = delete;
  DeviceLine& operator=(const DeviceLine&) = delete;
  virtual ~DeviceLine() = default;

  virtual void service(Stamp now) noexcept = 0;
  [[nodiscard]] virtual bool is_up() const noexcept = 0;
  [[nodiscard]] virtual std::string_view problem() const noexcept = 0;
  [[nodiscard]] virtual std::uint32_t epoch() const noexcept = 0;

  /// Sends a request whole (Ok) or not at all.
  [[nodiscard]] virtual LinkStatus send(std::span<const std::uint8_t> bytes) noexcept = 0;

  /// Goes on to the next of the line rates at which the device may be, from the last to the first; does
  /// nothing on a line that has one. A rate that was kept comes before each of the others: what was lost is
  /// more often an answer than the rate.
  virtual void next_rate() noexcept = 0;

  /// The device is at work at the present rate.
  virtual void keep_rate() noexcept = 0;
};

/// What follows when a request was not answered in all its tries.
enum class IfSilent : std::uint8_t {
  NextRate,   ///< the device may be at another line rate: start over there
  StartOver,  ///< start over after a pause
  GoOn,       ///< not every device of the family knows it
};

/// One step of a start-up.
struct Request {
  static constexpr std::size_t kBytesMax = 64;

  std::array<std::uint8_t, kBytesMax> bytes{};
  std::size_t size = 0;  ///< 0: only waits
  Stamp patience = std::chrono::milliseconds(200);
  unsigned tries = 3;
  IfSilent if_silent = IfSilent::StartOver;
  std::string_view problem;  ///< shown from the first time-out on

  /// Takes the first kBytesMax of `from`.
  void say(std::span<const std::uint8_t> from) noexcept;
};

enum class StepKind : std::uint8_t {
  Ask,            ///< sends the request until answered() is called
  AwaitReadings,  ///< ends when readings come; sends nothing
  Skip,           ///< nothing to do at this step
  Done,           ///< the device is at work
};

/// What a driver says to its device, step by step.
class Script {
 public:
  Script() = default;
  Script(const Script&) = delete;
  Script& operator=(const Script&) = delete;
  virtual ~Script() = default;

  /// A start-up begins: what was known of the device is no longer.
  virtual void begin() noexcept = 0;
  /// Writes the request of `step` (0, 1, ...) into the fresh `into`.
  [[nodiscard]] virtual StepKind compose(unsigned step, Request& into) noexcept = 0;
  /// The step that lets readings flow again.
  [[nodiscard]] virtual unsigned resume_step() const noexcept = 0;
};

/// Start-up, time-outs, supervision of the stream and starting over, for any rangefinder. Never gives up.
class Dialogue {
 public:
  Dialogue(DeviceLine& line, Script& script, RangeCounters& counters) noexcept
      : line_(line), script_(script), counters_(counters) {}

  /// At the start of a step: brings the line back and starts when it is new. False: nothing to read.
  [[nodiscard]] bool open(Stamp now) noexcept;
  /// At the end of a step, after all that arrived was acted on: sends, repeats, gives up, watches.
  void close(Stamp now) noexcept;

  /// The device answered the request under way.
  void answered(Stamp now) noexcept;
  /// The device works, but not for us: Faulted, and a new try later.
  void fault(Stamp now, std::string_view problem) noexcept;
  /// The device answers at a line rate at which it cannot be used: Faulted, and it is looked for at the other
  /// rates, for where the line rate means nothing (USB, network) it answers at every one. `problem` stays
  /// until it works.
  void fault_of_rate(Stamp now, std::string_view problem) noexcept;
  /// `count` readings came in.
  void heard(Stamp now, std::size_t count) noexcept;
  /// Starts over at once: the device is known to restart.
  void start(Stamp now) noexcept;

  /// From the next Ready on a pause of `silence` is a fault of the stream, and so is less than half or more
  /// than twice `rate_hz`.
  void expect(double rate_hz, Stamp silence) noexcept;

  /// Whether `step` waits for its answer.
  [[nodiscard]] bool is_asking(unsigned step) const noexcept {
    return phase_ == Phase::Asking && step_ == step;
  }
  [[nodiscard]] DeviceState state() const noexcept;
  [[nodiscard]] std::string_view problem() const noexcept;

 private:
  enum class Phase : std::uint8_t { Absent, Resting, Asking, Awaiting, Running };

  void go_to(unsigned step, Stamp now) noexcept;
  void ask(Stamp now) noexcept;
  void give_up(Stamp now) noexcept;
  void rest(Stamp now) noexcept;
  void run(Stamp now) noexcept;
  void watch(Stamp now) noexcept;
  void open_window(Stamp now) noexcept;

  DeviceLine& line_;
  Script& script_;
  RangeCounters& counters_;
  Phase phase_ = Phase::Absent;
  std::uint32_t epoch_ = 0;
  unsigned step_ = 0;
  Request request_;
  unsigned sent_ = 0;
  Stamp due_{};
  Stamp back_off_{};
  bool faulted_ = false;
  bool is_rate_at_fault_ = false;
  std::string_view problem_;
  std::size_t heard_ = 0;  ///< readings since the step or the window began
  Stamp last_heard_{};
  Stamp window_begun_{};
  Stamp running_since_{};
  Stamp stepped_{};  ///< last
  Stamp silence_ = std::chrono::seconds(1);
  double rate_hz_ = 0.0;
};

}  // namespace slamsensor::hal
