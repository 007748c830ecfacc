#pragma once

#include "hal/counters.hpp"
#include "hal/stamp.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace slamsensor::hal {

/// Characters of a remark: an LCM status has room for 191, and more is said around it.
inline constexpr std::size_t kRemarkMax = 160;

/// How a device driver stands.
enum class DeviceState : std::uint8_t {
  Absent,    ///< the link is down
  Starting,  ///< the link is up; the driver is finding out what is there and setting it up
  Ready,     ///< the device has answered and does its work
  Faulted,   ///< it answers, but cannot work (its own report, or it is the wrong device); retried with
             ///< back-off
};

/// What every driver has: a state machine on one link that is stepped, never waits, and starts over by itself
/// after a loss, whatever was lost: the link, the power of the device, its settings, a byte. Drivers are
/// never given up; a caller that steps one regularly gets it running again when the device can.
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  /// Reads what has arrived, acts on it and on the time, writes what is due. `now` never decreases. Call it
  /// at least every 10 ms.
  virtual void step(Stamp now) noexcept = 0;

  [[nodiscard]] virtual DeviceState state() const noexcept = 0;

  /// What stands in the way, for a person, while the state is not Ready ("no reply at 9600, 38400 or 19200
  /// baud; check cable and power"); empty when nothing does. After the step that left Ready it says why.
  /// Valid until the next step().
  [[nodiscard]] virtual std::string_view problem() const noexcept = 0;

  /// Why the times of its samples cannot be relied on while it is Ready, for a person: what was seen, and
  /// what to do; empty while they can. Valid until the next step().
  [[nodiscard]] virtual std::string_view timing_doubt() const noexcept { return {}; }

  /// What the device or its line was seen to do that they should not, for a person, whether the driver works
  /// in spite of it or not: what was seen, and what to do; empty when nothing was. At most kRemarkMax
  /// characters. Valid until the next step().
  [[nodiscard]] virtual std::string_view remark() const noexcept { return {}; }

  /// Counts of everything refused, repeated, lost or out of order; names are unique within the device.
  [[nodiscard]] virtual std::span<const Counter> counters() const noexcept = 0;
};

}  // namespace slamsensor::hal
