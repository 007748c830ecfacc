#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/rangefinder/laser_machine.hpp"
#include "tools/emulator/rangefinder/tf03_frame.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::tools {

/// What the device does besides answering a command.
enum class Tf03Action : std::uint8_t { None, Retime };

struct Tf03Answer {
  std::vector<std::uint8_t> bytes;  ///< empty: none
  Tf03Action action = Tf03Action::None;
};

/// The settings of a TF03 and the commands by which a driver sets it up (TF03 manual V1.2.2, table 8): 01
/// version, 03 rate, 05 standard format, 06 line rate, 07 output, 4F over range. Changes are lost at the next
/// start; another line rate would count only after it.
class Tf03Commands {
 public:
  explicit Tf03Commands(const Tf03Settings& settings);

  /// What the device works with at present.
  [[nodiscard]] const Tf03Parameters& active() const { return active_; }

  /// The device starts: what was saved counts.
  void start_up();

  /// Does `command` (whole, sum checked). Nothing when the device does not answer: unknown, wrong length or
  /// a value that cannot be.
  [[nodiscard]] std::optional<Tf03Answer> run(std::span<const std::uint8_t> command);

  /// The factory's line rate counts from now on, and after every start.
  void reset_baud();

  /// Nothing is sent any more before a command asks for it, or a restart.
  void stop_output() { active_.output = Tf03Switch::Off; }

 private:
  using Payload = std::span<const std::uint8_t>;

  [[nodiscard]] std::optional<Tf03Answer> set_baud(Payload payload);

  const Tf03Settings& settings_;
  Tf03Parameters saved_;
  Tf03Parameters active_;
};

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

/// A Benewake TF03 (or one of its relatives) at its UART: nine-byte frames and 5A commands (TF03 manuals V0.4
/// and V1.2.2, TFmini, TFmini Plus, TFmini-S and TF02 manuals). A command that it does not take is not
/// answered.
class EmulatedTf03 final : public EmulatedSerialDevice {
 public:
  /// `sink` and `scene` outlive the device.
  EmulatedTf03(const Tf03Settings& settings, ByteSink& sink, RangeScene& scene);

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override { return engine_.next_event(); }

  /// Knows PowerCycle, Silence, BaudReset, NoReturns, WeakSignal, Saturation, BadChecksum, StreamStops,
  /// TextMessage, and of the TFmini-S DeviceError.
  bool inject(const Fault& fault) override;
  void receive(std::uint8_t byte, Stamp at) override;
  [[nodiscard]] std::uint32_t baud() const override { return line_.baud(); }

  /// Frames that were sent, and those that the line could not take.
  [[nodiscard]] std::uint64_t records_sent() const { return engine_.outbox().sent(); }
  [[nodiscard]] std::uint64_t records_dropped() const { return engine_.outbox().dropped(); }

  /// Commands that were refused: not whole, wrong sum, length, ID or value.
  [[nodiscard]] std::uint64_t refused() const { return engine_.refused(); }

 private:
  void follow_engine();

  Tf03Settings settings_;
  SerialOutboxLine line_;
  Tf03Engine engine_;
  std::uint32_t power_changes_ = 0;
};

/// A Benewake TF03 at its CAN plug: a frame for each reading, commands and answers as on the UART, cut into
/// frames (TF03 manual V1.2.2, 4.2). It is deaf and mute while its flash says UART or another bit rate than
/// the bus has.
class EmulatedTf03Can final : public EmulatedCanDevice {
 public:
  /// `sink` and `scene` outlive the device.
  EmulatedTf03Can(const Tf03Settings& settings, FrameSink& sink, RangeScene& scene);

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override { return engine_.next_event(); }

  /// Knows PowerCycle, Silence, NoReturns, WeakSignal, Saturation and StreamStops.
  bool inject(const Fault& fault) override { return engine_.inject(fault); }
  void receive(const hal::CanFrame& frame, Stamp at) override;

  [[nodiscard]] std::uint64_t records_sent() const { return engine_.outbox().sent(); }
  [[nodiscard]] std::uint64_t refused() const { return engine_.refused(); }

 private:
  class Line final : public OutboxLine {
   public:
    explicit Line(FrameSink& sink) : sink_(sink) {}
    void follow(const Tf03Parameters& parameters, bool is_on_bus);
    std::optional<Stamp> put(std::span<const std::uint8_t> bytes, Stamp at, Urgency urgency) override;

   private:
    FrameSink& sink_;
    std::uint32_t id_ = 0;
    bool extended_ = false;
    bool is_on_bus_ = true;
  };

  void follow_engine();
  [[nodiscard]] bool is_on_bus() const { return engine_.active().can_baud == settings_.bus_baud; }

  Tf03Settings settings_;
  Line line_;
  Tf03Engine engine_;
};

}  // namespace slamsensor::tools
