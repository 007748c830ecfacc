#pragma once

#include "hal/stamp.hpp"
#include "hal/transport/can_link.hpp"
#include "tools/emulator/fault.hpp"

#include <cstdint>
#include <span>

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

  /// Told of each reading when the device begins to put it on the wire (`on_wire`; the record that carries it
  /// alone or with others): the truth that experiments compare with.
  virtual void reported(Stamp measured, Stamp on_wire) = 0;
};

/// Delays of an emulated device between doing and saying, drawn anew for each reply or reading.
struct Delay {
  Stamp constant{};
  Stamp jitter{};  ///< standard deviation of a normal, cut at 4 of it to both sides, and the whole never
                   ///< negative
};

}  // namespace slamsensor::tools
