#pragma once

#include "tools/emulator/emulated_port.hpp"
#include "tools/emulator/lateness.hpp"
#include "tools/emulator/pseudo_terminal.hpp"

#include <cstdint>
#include <memory>

namespace slamsensor::tools {

/// Whether a host must have set the device's line rate to be understood. (A pseudo-terminal has no bits, but
/// it tells the rate that its host has set.)
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

}  // namespace slamsensor::tools
