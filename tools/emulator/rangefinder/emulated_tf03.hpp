#pragma once

#include "hal/rangefinder/benewake_frame.hpp"
#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/rangefinder/laser_machine.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace slamsensor::tools {

using hal::BenewakeModel;

enum class Tf03Wire : std::uint8_t { Uart, Can };
enum class Tf03Switch : std::uint8_t { Off = 0, On = 1 };

/// What the commands change (TF03 manual V1.2.2, table 8). A member that only counts after save and restart
/// is marked so.
struct Tf03Parameters {
  std::uint32_t rate_hz = 100;
  Tf03Switch output = Tf03Switch::On;
  std::uint16_t over_range_cm =
      18'000;                       ///< reported when nothing, or something farther, came back; 0: no limit
  std::uint32_t baud = 115200;      ///< restart
  Tf03Wire wire = Tf03Wire::Uart;   ///< restart
  std::uint32_t can_send_id = 0x3;  ///< restart
  std::uint32_t can_receive_id = 0x3003;
  std::uint32_t can_baud = 1'000'000;  ///< restart
  Tf03Switch can_extended = Tf03Switch::Off;
};

/// How an EmulatedTf03 or EmulatedTf03Can is built and set up.
struct Tf03Settings {
  BenewakeModel model = BenewakeModel::Tf03;
  DeviceBegin begin = DeviceBegin::PowerUp;
  Tf03Parameters saved;  ///< in its flash when it is switched on
  OutboxDelays delays;
  double crystal_ppm = 0.0;
  Stamp boot_time = std::chrono::milliseconds(300);
  std::uint32_t transmit_buffer_bytes = 64;
  std::uint64_t seed = 1;

  StrengthModel strength{1.44e6, 3500.0};  ///< 40 for 90 % at 180 m, and for 10 % at 60 m
  double strength_min = 40.0;              ///< below it only "no return" is reported
  std::uint16_t strength_of_nothing = 12;
  std::uint16_t strength_of_weak = 30;       ///< while the fault WeakSignal lasts
  std::uint16_t strength_of_blinded = 4000;  ///< while the fault Saturation lasts
  std::uint16_t no_return_cm = 18'000;       ///< of the relatives; the TF03 has over_range_cm
  double temperature_c = 25.0;               ///< reported by TFmini Plus and TFmini-S

  std::uint32_t bus_baud = 1'000'000;  ///< of the bus it hangs on; at another rate it is deaf and mute
  std::array<std::uint8_t, 3> version = {2, 2, 1};  ///< 1.2.2, lowest first
};

/// The settings of `model` as it leaves the factory: its code and strength for "no return" among them.
[[nodiscard]] Tf03Settings tf03_settings(BenewakeModel model);

/// Sets the rate that is in its flash; the nearest it knows.
void set_rate(Tf03Settings& settings, double rate_hz);

/// The nearest rate of the form n x 10^k (n 1 to 9, k 0 to 3) or 10,000 Hz.
[[nodiscard]] std::uint32_t nearest_tf03_rate(double rate_hz);

/// What a frame holds: the words of distance and strength, whatever they stand for.
struct Tf03Words {
  std::uint16_t distance = 0;
  std::uint16_t strength = 0;
  bool is_trusted = false;  ///< the TF02 has it in byte 6
};

/// The words for a sight, by the codes of the model; nothing when the model has no word for an error.
[[nodiscard]] Tf03Words tf03_words(const Tf03Settings& settings, const Tf03Parameters& parameters,
                                   const Sight& sight);

/// The nine bytes 59 59 .. on a UART: distance and strength, two bytes of the model, sum of the others.
void build_tf03_frame(const Tf03Settings& settings, const Tf03Words& words, std::vector<std::uint8_t>& out);

/// The data of a CAN frame: distance, strength, zeros.
void build_tf03_can(const Tf03Words& words, std::vector<std::uint8_t>& out);

/// `body`, which begins with 5A and its length, with its sum behind it.
[[nodiscard]] std::vector<std::uint8_t> with_tf03_sum(std::vector<std::uint8_t> body);

/// Finds commands 5A LEN ID ... SUM between other bytes. One that stops for 100 ms is forgotten.
class Tf03Receiver {
 public:
  /// Takes a byte; the whole command when it completes one whose sum is right.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> push(std::uint8_t byte, Stamp at);

  void clear() { buffer_.clear(); }

  /// Commands with a wrong sum or an impossible length.
  [[nodiscard]] std::uint64_t refused() const { return refused_; }

 private:
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> take();

  std::vector<std::uint8_t> buffer_;
  Stamp last_byte_{};
  std::uint64_t refused_ = 0;
};

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
