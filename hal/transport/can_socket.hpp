#pragma once

#include "hal/init_error.hpp"
#include "hal/transport/can_link.hpp"
#include "hal/transport/can_socket_config.hpp"
#include "hal/transport/can_socket_frame.hpp"
#include "hal/transport/reopen.hpp"
#include "hal/transport/reopen_problem.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::hal {

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

  [[nodiscard]] std::span<const Counter> counters() const noexcept { return counters_.all(); }

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
