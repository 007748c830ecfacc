#pragma once

#include "hal/stamp.hpp"
#include "hal/transport/can_link.hpp"
#include "tools/emulator/fault.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/world/random.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>

namespace slamsensor::tools {

using hal::Stamp;

/// The device's end of a serial line to the host.
class ByteSink {
 public:
  ByteSink() = default;
  ByteSink(const ByteSink&) = delete;
  ByteSink& operator=(const ByteSink&) = delete;
  virtual ~ByteSink() = default;

  /// Puts `bytes` on the line, the first not before `at` and after all that was sent before; the line takes
  /// ten bit times for each at the device's line rate.
  virtual void send(std::span<const std::uint8_t> bytes, Stamp at) = 0;

  /// When the line has delivered all that was sent; a time in the past when it is idle.
  [[nodiscard]] virtual Stamp busy_until() const = 0;

  /// Forgets what was sent and not yet delivered (the device lost power).
  virtual void clear() = 0;
};

/// What every emulated device has. It knows the time only from its callers, in order: every call has a time
/// that is not before the last. Its chance is seeded: equal seeds and calls, equal bytes.
class EmulatedDevice {
 public:
  EmulatedDevice() = default;
  EmulatedDevice(const EmulatedDevice&) = delete;
  EmulatedDevice& operator=(const EmulatedDevice&) = delete;
  virtual ~EmulatedDevice() = default;

  /// Does all that happens by itself up to and including `now`.
  virtual void advance(Stamp now) = 0;

  /// The earliest time at which advance() would do something by itself; hal::kNever when nothing is due.
  [[nodiscard]] virtual Stamp next_event() const = 0;

  /// Lets `fault` begin at its time, which is now; false when the device does not know this kind.
  virtual bool inject(const Fault& fault) = 0;
};

/// A device on a serial line, given its ByteSink at construction.
class EmulatedSerialDevice : public EmulatedDevice {
 public:
  /// A byte from the host has arrived completely at `at`. advance(at) was called before.
  virtual void receive(std::uint8_t byte, Stamp at) = 0;

  /// The device's line rate at present, bit/s; a host at another rate sends and gets garbage.
  [[nodiscard]] virtual std::uint32_t baud() const = 0;
};

/// Where CAN devices send.
class FrameSink {
 public:
  FrameSink() = default;
  FrameSink(const FrameSink&) = delete;
  FrameSink& operator=(const FrameSink&) = delete;
  virtual ~FrameSink() = default;

  /// Puts `frame` on the bus, not before `at`.
  virtual void send(const hal::CanFrame& frame, Stamp at) = 0;
};

/// A device on a CAN bus, given its FrameSink at construction. It sees every frame of every other node.
class EmulatedCanDevice : public EmulatedDevice {
 public:
  virtual void receive(const hal::CanFrame& frame, Stamp at) = 0;
};

/// Where a pan-tilt unit truly points, whatever it reports.
struct HeadAngles {
  double pan_rad = 0.0;
  double tilt_rad = 0.0;
};

class PointingTruth {
 public:
  PointingTruth() = default;
  PointingTruth(const PointingTruth&) = delete;
  PointingTruth& operator=(const PointingTruth&) = delete;
  virtual ~PointingTruth() = default;

  /// The angles at `at`, which is not before the last call to the unit by more than a second.
  [[nodiscard]] virtual HeadAngles angles_at(Stamp at) const = 0;
};

/// What the emulated rangefinder sees.
enum class TargetKind : std::uint8_t { Nothing, Target, LostShot };

struct Target {
  TargetKind kind = TargetKind::Nothing;  ///< LostShot: this shot gave no result (drop-out)
  double range_m = 0.0;      ///< of a Target, noise and resolution of the world's rangefinder included
  double reflectance = 0.3;  ///< 0 to 1, of a Target
};

class RangeScene {
 public:
  RangeScene() = default;
  RangeScene(const RangeScene&) = delete;
  RangeScene& operator=(const RangeScene&) = delete;
  virtual ~RangeScene() = default;

  /// What a shot at `at` meets. Called once for each shot, in the order of time.
  [[nodiscard]] virtual Target shoot(Stamp at) = 0;

  /// Gets each reading when the device begins to put it on the wire (`on_wire`; the record that carries it
  /// alone or with others): the truth that experiments compare with.
  virtual void reported(Stamp measured, Stamp on_wire) = 0;
};

/// Delays of an emulated device between doing and saying, drawn anew for each reply or reading.
struct Delay {
  Stamp constant{};
  Stamp jitter{};  ///< standard deviation of a normal, cut at 4 of it to both sides, and the whole never
                   ///< negative
};

/// Draws the delays of one kind, one after the other.
class DelayDraw {
 public:
  DelayDraw(const Delay& delay, std::uint64_t seed) : delay_(delay), rng_(seed) {}

  /// A new delay: constant plus normal jitter cut at 4 standard deviations, at least 0. Draws nothing without
  /// jitter.
  [[nodiscard]] Stamp draw() {
    if (delay_.jitter == Stamp::zero()) {
      return std::max(delay_.constant, Stamp::zero());
    }
    const double sigmas = std::clamp(draw_normal(rng_), -4.0, 4.0);
    const Stamp jitter(std::llround(sigmas * static_cast<double>(delay_.jitter.count())));
    return std::max(delay_.constant + jitter, Stamp::zero());
  }

 private:
  Delay delay_;
  Random rng_;
};

/// A line with the emulated devices on it: what happens on it happens in the order of time.
class EmulatedLine {
 public:
  EmulatedLine() = default;
  EmulatedLine(const EmulatedLine&) = delete;
  EmulatedLine& operator=(const EmulatedLine&) = delete;
  virtual ~EmulatedLine() = default;

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

/// The time of an in-process run. Whoever runs the loop moves it, never backwards.
struct SimClock {
  hal::Stamp now{};
};

/// Whether a device runs, and when it will: power comes, a boot time passes, it runs.
class PowerSwitch {
 public:
  /// The power comes at time 0, or the device has long been running.
  PowerSwitch(DeviceBegin begin, Stamp boot_time)
      : boot_time_(boot_time), up_at_(begin == DeviceBegin::Ready ? hal::kNever : boot_time) {}

  [[nodiscard]] bool is_up() const { return up_at_ == hal::kNever; }

  /// When the device will be up; hal::kNever when it is.
  [[nodiscard]] Stamp next() const { return up_at_; }

  /// No power before `until`.
  void cut(Stamp until) { up_at_ = std::max(is_up() ? Stamp::min() : up_at_, until + boot_time_); }

  /// next() has come.
  void go_up() { up_at_ = hal::kNever; }

 private:
  Stamp boot_time_;
  Stamp up_at_;
};

}  // namespace slamsensor::tools
