#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/ptu/ascii_command.hpp"
#include "tools/emulator/ptu/ptu_head.hpp"
#include "tools/world/random.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace slamsensor::tools {

/// Who gets what the unit says: the host, or its own store until it is selected.
enum class PtuAudience : std::uint8_t { Host, Store };

/// The unit's mouth: what it says and what faults make of it.
class PtuPort {
 public:
  PtuPort(ByteSink& sink, std::uint64_t seed) : sink_(sink), rng_(seed) {}

  /// From now on speaks to `audience`; the host gets what was stored.
  void turn_to(PtuAudience audience, Stamp now);

  /// Echo and banner; nothing that waits for a host who does not listen.
  void say(std::string_view bytes, Stamp now);

  /// The answer to a command: the one that the faults of replies befall.
  void answer(const std::string& bytes, Stamp now);

  /// An axis has run into a limit.
  void report(PtuAxisId axis, Stamp now);

  /// Sends nothing until `until`.
  void be_silent(Stamp until);

  /// The next answer is lost, comes twice, or has a limit report in it; false for other faults.
  bool befall(FaultKind kind);

  /// Without power: nothing is sent any more.
  void cut_power();

 private:
  void send(std::string_view bytes, Stamp now);

  ByteSink& sink_;
  Random rng_;
  PtuAudience audience_ = PtuAudience::Host;
  std::string stored_;
  Stamp silent_until_ = Stamp::min();
  unsigned swallow_ = 0;
  unsigned twice_ = 0;
  unsigned limit_inside_ = 0;
};

/// A Directed Perception / FLIR pan-tilt unit: ASCII commands (PTU-D46 User's Manual 2.14, E-Series Command
/// Reference), and two stepper axes in exact time. It reads its line byte by byte: each
/// is echoed when it is read, a delimiter makes it obey, and it reads on when it has answered.
class EmulatedPtu final : public EmulatedSerialDevice, public PointingTruth {
 public:
  /// Begins at `start` as its settings say. `sink` outlives it.
  EmulatedPtu(const PtuSettings& settings, ByteSink& sink, std::uint64_t seed, Stamp start = Stamp{});

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override;

  /// Knows PowerCycle, Silence, BaudReset and the faults of a unit that is spoken to by command and reply. Of
  /// an axis to fail it chooses a moving one, else either.
  bool inject(const Fault& fault) override;

  void receive(std::uint8_t byte, Stamp at) override;
  [[nodiscard]] std::uint32_t baud() const override { return baud_; }

  [[nodiscard]] HeadAngles angles_at(Stamp at) const override;

  /// Bytes from the host that were lost: unit off, starting, or its input full.
  [[nodiscard]] std::uint64_t dropped_bytes() const noexcept { return dropped_bytes_; }

  /// How often settings were written into the memory that wears out.
  [[nodiscard]] std::uint32_t eeprom_writes() const noexcept { return unit_.eeprom_writes; }

 private:
  // An answer on its way. Until it is given nothing more is read.
  struct Pending {
    Stamp due{};
    AsciiAnswer answer{};
    Stamp latency{};
    bool has_answered = false;  // what is left is the change of the line rate
  };
  // A reset under way.
  struct ResetRun {
    Stamp end{};
    PtuRefusal failure{};
    AsciiAnswer answer{};
    bool is_starting = false;  // of power-up: what is typed meanwhile is lost
  };

  void settle(Stamp now);
  void step(Stamp now);
  void process(Stamp now);
  [[nodiscard]] bool is_reading() const;
  [[nodiscard]] Stamp pending_due() const;
  void finish_pending(Stamp now);

  void take(std::uint8_t byte, Stamp now);
  void take_text(char c, Stamp now);
  void end_text(char delimiter, Stamp now);
  void begin_answer(const AsciiAnswer& answer, Stamp now);
  void choose_audience(Stamp now);

  void power_on(Stamp now);
  void power_off(Stamp now, Stamp until);
  void greet(Stamp now);
  void begin_reset(const PtuAxes& axes, ResetRun run, Stamp now);
  void finish_reset(Stamp now);
  void begin_monitor(Stamp now);
  void end_monitor(Stamp now);
  void report_limit(const PtuLimitHit& hit);
  void miss_steps(Stamp now);
  void fail_reset(Stamp now);

  const PtuSettings settings_;
  ByteSink& sink_;
  PtuUnit unit_;
  PtuPort port_;
  DelayDraw latency_;
  Random rng_;
  std::uint32_t baud_;

  std::deque<std::uint8_t> input_;
  std::string text_;
  bool was_return_ = false;        // the last byte read was a CR
  bool has_heard_return_ = false;  // the last byte heard was one
  std::optional<Pending> pending_;
  std::optional<ResetRun> reset_;
  std::deque<PtuLimitHit> hits_;  // of the reset, to come
  Stamp late_{};                  // what the next answer is late
  std::optional<PtuAxisId> jam_;  // in the next reset
  bool has_power_ = true;
  bool is_scan_wanted_ = false;  // when the reset has ended
  Stamp power_at_ = hal::kNever;
  Stamp greet_at_ = hal::kNever;
  std::uint64_t dropped_bytes_ = 0;
};

}  // namespace slamsensor::tools
