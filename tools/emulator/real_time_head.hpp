#pragma once

#include "hal/stamp.hpp"
#include "hal/transport/can_link.hpp"
#include "hal/transport/can_socket.hpp"
#include "tools/emulator/emulated_head.hpp"
#include "tools/emulator/emulated_port.hpp"
#include "tools/emulator/memory_can_bus.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <array>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// How much later than it was due each byte (or frame) was given to the host.
class Lateness {
 public:
  void count(hal::Stamp late, std::uint64_t times = 1) noexcept;

  [[nodiscard]] hal::Stamp worst() const noexcept { return worst_; }
  [[nodiscard]] std::uint64_t total() const noexcept { return total_; }

  /// The least bound that at least `share` (0 to 1) of all stayed within; kNever when it lies beyond the last
  /// bound, 0 when there were none.
  [[nodiscard]] hal::Stamp within(double share) const noexcept;

  /// "worst 0.41 ms; up to 0.1 ms: 1234, 0.2 ms: 56, ..." without the empty ones; "nothing was sent".
  [[nodiscard]] std::string text() const;

  static constexpr std::array<double, 10> kBounds_ms = {0.1, 0.2,  0.5,  1.0,  2.0,
                                                        5.0, 10.0, 20.0, 50.0, 100.0};

 private:
  std::array<std::uint64_t, kBounds_ms.size() + 1> counts_{};
  std::uint64_t total_ = 0;
  hal::Stamp worst_{};
};

/// Emulated devices on a CAN interface: their bus in memory, on which they arbitrate and hear each other, and
/// a link to the interface, joined. While the bus's interfaces are "down" nothing passes either way.
class CanPort {
 public:
  /// Both outlive this.
  CanPort(MemoryCanBus& bus, hal::CanLink& link);

  /// Puts what has come over the bus at `now` on the interface, and what came from there on the bus. The bus
  /// was advanced to `now`; `late` counts each frame. `real_now` is the same moment on CLOCK_MONOTONIC.
  void exchange(Stamp now, Stamp real_now, Lateness& late);

  /// Frames that the interface or the bus had no room for.
  [[nodiscard]] std::uint64_t lost_frames() const noexcept { return lost_frames_; }

 private:
  MemoryCanBus& bus_;
  hal::CanLink& link_;
  std::size_t host_;
  std::uint64_t lost_frames_ = 0;
};

/// A pseudo-terminal with a stable name, a symbolic link, that a host opens like a serial port. The terminal
/// changes no byte. Unplugged it is gone, name and all; plugged in again it is a new one of the same name.
class PseudoTerminal {
 public:
  /// Plugged in at `name`, which is the link from then on; refused when a terminal cannot be had, or when
  /// `name` is anything but a link that an earlier emulator left.
  [[nodiscard]] static tl::expected<std::unique_ptr<PseudoTerminal>, WorldError> create(
      const std::filesystem::path& name);

  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// Unplugs.
  ~PseudoTerminal();

  void unplug() noexcept;

  /// False when the system has no terminal, or the name cannot be made; try again later.
  bool plug_in() noexcept;

  [[nodiscard]] bool is_plugged() const noexcept { return fd_ >= 0; }

  /// The device's end, to wait on; -1 while unplugged.
  [[nodiscard]] int fd() const noexcept { return fd_; }

  /// Whether a host has the port open.
  [[nodiscard]] bool has_host() const noexcept;

  /// The line rate that the host has set, bit/s, whatever the rate; nothing while unplugged.
  [[nodiscard]] std::optional<std::uint32_t> host_baud() const noexcept;

  /// What the host has written; how many bytes. Does not wait.
  std::size_t read(std::span<std::uint8_t> into) noexcept;

  /// Gives bytes to the host; how many it had room for. Does not wait.
  std::size_t write(std::span<const std::uint8_t> bytes) noexcept;

  [[nodiscard]] const std::filesystem::path& name() const noexcept { return name_; }

 private:
  explicit PseudoTerminal(std::filesystem::path name) : name_(std::move(name)) {}

  [[nodiscard]] std::string open_terminal() noexcept;
  [[nodiscard]] std::string make_link() noexcept;

  std::filesystem::path name_;
  std::string target_;  // the terminal that the link leads to
  int fd_ = -1;
};

/// Whether a host must have set the device's line rate to be understood. (A pseudo-terminal has no bits, but
/// it shows the rate that its host has set.)
enum class BaudRule : std::uint8_t { AsOnALine, AnyRate };

/// An emulated port on a pseudo-terminal: its bytes are given to the host when they have come over the line,
/// the host's are put on the line, and a pulled cable takes the terminal away.
class PtyPort {
 public:
  /// `port` outlives this.
  PtyPort(EmulatedPort& port, std::unique_ptr<PseudoTerminal> terminal, BaudRule rule);

  /// What to wait on for the host; -1 when there is none.
  [[nodiscard]] int fd() const noexcept { return has_host_ ? terminal_->fd() : -1; }

  /// Gives the host what has arrived at `now`, puts what the host has written on the line, pulls or plugs the
  /// cable. The port was advanced to `now`, which is the present; `late` counts each byte.
  void exchange(Stamp now, Lateness& late);

  /// Bytes that had come over the line and that the host had no room for.
  [[nodiscard]] std::uint64_t lost_bytes() const noexcept { return lost_bytes_; }

  [[nodiscard]] const PseudoTerminal& terminal() const noexcept { return *terminal_; }

 private:
  void follow_cable();
  void speak(Stamp now, Lateness& late);
  void listen(Stamp now);

  EmulatedPort& port_;
  std::unique_ptr<PseudoTerminal> terminal_;
  BaudRule rule_;
  std::uint32_t plug_count_;
  bool has_host_ = false;
  std::uint64_t lost_bytes_ = 0;
};

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
