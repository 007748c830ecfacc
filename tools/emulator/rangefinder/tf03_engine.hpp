#pragma once

#include "tools/emulator/rangefinder/laser_machine.hpp"
#include "tools/emulator/rangefinder/tf03_commands.hpp"
#include "tools/emulator/rangefinder/tf03_frame.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::tools {

/// What a TF03 is on both of its wires: it shoots at its rate, does commands, has faults. Only the wire that
/// is chosen in its flash speaks and hears.
class Tf03Engine {
 public:
  /// `settings`, `line` and `scene` outlive the engine, which sits at the plug of `wire`.
  Tf03Engine(const Tf03Settings& settings, Tf03Wire wire, OutboxLine& line, RangeScene& scene);

  [[nodiscard]] Stamp next_event() const { return machine_.next_event(); }

  /// Does what is due at `now`, which is next_event().
  void step(Stamp now);

  /// A byte of a command has come.
  void receive(std::uint8_t byte, Stamp at);

  /// Knows what both wires have in common: Silence, NoReturns, WeakSignal, Saturation, StreamStops,
  /// PowerCycle, on the TFmini-S DeviceError (too much sunlight).
  bool inject(const Fault& fault);

  /// The next frame has a wrong sum.
  void spoil_next() { machine_.faults.order(FaultKind::BadChecksum); }
  void reset_baud() { commands_.reset_baud(); }
  void put_text(std::string_view text, Stamp at);

  [[nodiscard]] const Tf03Parameters& active() const { return commands_.active(); }
  [[nodiscard]] bool is_up() const { return machine_.power.is_up(); }

  /// Grows with every start and every loss of power.
  [[nodiscard]] std::uint32_t power_changes() const { return power_changes_; }

  [[nodiscard]] const Outbox& outbox() const { return machine_.outbox; }
  [[nodiscard]] std::uint64_t refused() const { return refused_ + receiver_.refused(); }

 private:
  void start_up(Stamp now);
  void go_down(Stamp until);
  void retime(Stamp now);
  void shoot(Stamp at);
  [[nodiscard]] bool hears() const { return machine_.power.is_up() && active().wire == wire_; }
  void run(std::span<const std::uint8_t> command, Stamp at);

  const Tf03Settings& settings_;
  Tf03Wire wire_;
  RangeScene& scene_;
  LaserMachine machine_;
  Tf03Commands commands_;
  Tf03Receiver receiver_;
  std::uint32_t power_changes_ = 0;
  std::uint64_t refused_ = 0;
  std::vector<std::uint8_t> frame_;
};

}  // namespace slamsensor::tools
