#pragma once

#include "hal/transport/can_socket.hpp"
#include "tools/emulator/can_port.hpp"
#include "tools/emulator/emulated_head.hpp"
#include "tools/emulator/pty_port.hpp"

#include <tl/expected.hpp>

#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// Where the devices of a head are put.
struct RealTimeConfig {
  std::filesystem::path ptu = "ptu0";  ///< names of the pseudo-terminals of devices on a serial line
  std::filesystem::path rangefinder = "rangefinder0";
  std::string can{};  ///< interface of devices on a CAN bus; not needed when there is none
  BaudRule baud = BaudRule::AsOnALine;
  Stamp granule = std::chrono::microseconds(200);  ///< bytes are given to the host no later than this after
                                                   ///< they are due, all that are due together
};

/// An emulated head in real time: its devices on pseudo-terminals and a CAN interface.
class RealTimeHead {
 public:
  /// Every device is at its place; refused when a place cannot be had. `head` outlives this. Its time starts
  /// with the first run().
  [[nodiscard]] static tl::expected<std::unique_ptr<RealTimeHead>, WorldError> create(
      EmulatedHead& head, const RealTimeConfig& config);

  /// What comes of signals.
  struct Orders {
    volatile std::sig_atomic_t stop = 0;        ///< end the run
    volatile std::sig_atomic_t next_stand = 0;  ///< go to the next stand; reset when done
  };

  /// Runs the head until its time is `end` or `orders.stop` is set, which wakes it when a signal handler set
  /// it and the signals are blocked outside of this call.
  void run(Stamp end, Orders& orders);

  /// CLOCK_MONOTONIC at the head's time 0.
  [[nodiscard]] Stamp origin() const noexcept { return origin_; }

  [[nodiscard]] const Lateness& lateness() const noexcept { return lateness_; }

  /// Bytes and frames that a host did not take in time.
  [[nodiscard]] std::uint64_t lost() const noexcept;

 private:
  RealTimeHead(EmulatedHead& head, const RealTimeConfig& config) : head_(head), config_(config) {}

  [[nodiscard]] tl::expected<void, WorldError> open_port(EmulatedPort* port,
                                                         const std::filesystem::path& name);
  [[nodiscard]] tl::expected<void, WorldError> open_can();
  void exchange(Stamp real_now);
  void wait(Stamp real_now) const;

  EmulatedHead& head_;
  RealTimeConfig config_;
  std::vector<std::unique_ptr<PtyPort>> ports_;
  std::unique_ptr<hal::CanSocket> socket_;
  std::unique_ptr<CanPort> can_;
  Lateness lateness_;
  Stamp origin_ = hal::kNever;
};

}  // namespace slamsensor::tools
