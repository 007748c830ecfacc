#pragma once

#include "hal/counters.hpp"
#include "hal/init_error.hpp"
#include "hal/transport/can_link.hpp"
#include "hal/transport/reopen.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <linux/can.h>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::hal {

inline constexpr std::size_t kCanFiltersMax = 16;

/// Passes the data frames of one kind of identifier with (their id & mask) == (id & mask).
struct CanFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0x7FF;
  bool extended = false;
};

struct CanConfig {
  std::string interface;  ///< "can0"; up to 15 characters
  std::vector<CanFilter>
      filters;  ///< at most kCanFiltersMax; a frame must pass one of them; none: every frame passes
  ReopenConfig reopen;
};

/// What is wrong with `config`, in words that follow the interface's name; empty when nothing is.
[[nodiscard]] std::string complaint(const CanConfig& config);

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

using CanCounters = EventCounters<CanEvent, kCanEvents>;

/// The names of the enumerators, in their order.
[[nodiscard]] const std::array<std::string_view, kCanEvents>& can_event_names() noexcept;

/// What the socket delivered, decoded: the frame when it is one to hand out, else nothing and counted.
/// `bytes` is the length that was read, which distinguishes classical from FD frames (Linux:
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

/// A raw SocketCAN socket on one interface. service() opens it at its first call and, with back-off, again
/// after every loss: interface down, removed and come back, bus-off. It counts as up while the interface is
/// up and its controller on the bus. Bit rate, restart after bus-off (restart-ms) and queue length belong to
/// the system's network configuration; this needs no privilege.
class CanSocket final : public CanLink {
 public:
  /// A socket that is down until service() has opened it; an error only when the configuration cannot be
  /// right.
  [[nodiscard]] static tl::expected<std::unique_ptr<CanSocket>, InitError> create(const CanConfig& config);

  ~CanSocket() override;

  void service(Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return epoch_; }
  [[nodiscard]] bool is_up() const noexcept override { return fd_ >= 0; }

  /// As in CanLink. Never the frames sent here; those of other sockets on this machine it does. Remote and FD
  /// frames are counted and passed over, at most 64 in a call, after which it says Busy.
  [[nodiscard]] CanRead receive() noexcept override;

  /// Down also for a frame that no CAN bus takes: an identifier or a size beyond its bits.
  [[nodiscard]] LinkStatus send(const CanFrame& frame) noexcept override;

  /// What to wait on with poll() until frames arrive; -1 while the link is down.
  [[nodiscard]] int fd() const noexcept { return fd_; }

  /// Why the link is down and what to do, for a person; empty when it is up. Lives until the next call of a
  /// function that is not const.
  [[nodiscard]] std::string_view problem() const noexcept override { return problem_.view(); }

  [[nodiscard]] std::span<const Counter> counters() const noexcept override { return counters_.all(); }

 private:
  struct Received;

  explicit CanSocket(const CanConfig& config);

  [[nodiscard]] std::optional<OpenFailure> prepare(int fd) noexcept;
  [[nodiscard]] LinkStatus take(Received& received) noexcept;
  [[nodiscard]] Stamp stamp_of(const Received& received) noexcept;
  void look_for_error() noexcept;
  void lose(const OpenFailure& failure) noexcept;
  [[nodiscard]] LinkStatus failed_io(int error) noexcept;
  void close() noexcept;

  const CanConfig config_;
  int fd_ = -1;
  std::uint32_t epoch_ = 0;
  std::uint32_t dropped_ = 0;  ///< the kernel's count of this socket at last sight
  bool is_lost_ = false;       ///< found lost since the last service()
  ReopenTimer timer_;
  ReopenProblem problem_;
  CanCounters counters_;
};

}  // namespace slamsensor::hal
