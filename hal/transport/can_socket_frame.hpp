#pragma once

#include "hal/counters.hpp"
#include "hal/transport/can_link.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <linux/can.h>
#include <optional>
#include <string_view>

namespace slamsensor::hal {

enum class CanEvent : std::uint8_t {
  Opened,
  OpenFailed,
  InterfaceLost,  ///< down, or gone
  IoError,        ///< a call failed otherwise; the socket is opened again
  BusOff,         ///< the controller left the bus after too many errors
  Restarted,      ///< the controller is back on the bus
  RxOverflow,     ///< the controller lost frames that arrived
  TxOverflow,     ///< the controller lost frames to be sent
  ErrorWarning,   ///< many errors: the controller is near its passive state
  ErrorPassive,   ///< too many errors: the controller may not signal errors any more
  ErrorActive,    ///< the controller is well again
  NoAck,          ///< nobody acknowledged a frame: no other node, or another bit rate
  TxTimeout,      ///< the driver gave up a frame
  BusError,       ///< protocol violations and transceiver trouble
  RemoteIgnored,  ///< remote frames
  FdIgnored,      ///< CAN FD frames
  BadFrame,       ///< frames of impossible length or size
  StampRefused,   ///< the kernel's time of arrival was missing or not plausible
  Dropped,        ///< frames that the kernel threw away because they were not taken in time
  QueueFull,      ///< frames that were not sent because the queue was full
  SendRefused,    ///< frames to send with an impossible identifier or length
};

inline constexpr std::size_t kCanEvents = static_cast<std::size_t>(CanEvent::SendRefused) + 1;

using CanCounters = Counters<CanEvent, kCanEvents>;

/// The names of the enumerators, in their order.
[[nodiscard]] const std::array<std::string_view, kCanEvents>& can_event_names() noexcept;

/// What the socket delivered, decoded: the frame when it is one to hand out, else nothing and counted.
/// `bytes` is the length that was read, which tells classical from FD frames (Linux:
/// Documentation/networking/can).
[[nodiscard]] std::optional<CanFrame> to_data_frame(const canfd_frame& raw, std::size_t bytes,
                                                    CanCounters& counters) noexcept;

/// Whether `raw`, of `bytes`, is the driver's report of an error.
[[nodiscard]] bool is_error_frame(const canfd_frame& raw, std::size_t bytes) noexcept;

/// What an error report means for the socket.
enum class BusState : std::uint8_t { On, Off };

/// Counts what an error frame reports (linux/can/error.h). Off when the controller left the bus, or came back
/// without having been seen to leave.
[[nodiscard]] BusState take_error_frame(const canfd_frame& raw, CanCounters& counters) noexcept;

/// The kernel's form of `frame`; nothing when its identifier or length is out of range.
[[nodiscard]] std::optional<can_frame> to_raw(const CanFrame& frame) noexcept;

/// The moment on CLOCK_MONOTONIC of `arrived` on CLOCK_REALTIME, which is ahead by `realtime_ahead`; nothing
/// when it would be after `now` or more than 2 s before it, as after a step of the wall clock.
[[nodiscard]] std::optional<Stamp> monotonic_stamp(Stamp arrived, Stamp realtime_ahead, Stamp now) noexcept;

}  // namespace slamsensor::hal
