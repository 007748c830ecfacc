#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/rangefinder/laser_machine.hpp"
#include "tools/emulator/rangefinder/lwnx_product.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// How an EmulatedLwnx is built and set up.
struct LwnxSettings {
  LightWareProduct product = lwnx_product(LwnxModel::Lw20);
  DeviceBegin begin = DeviceBegin::PowerUp;
  std::uint32_t baud = 0;  ///< 0: the product's
  double full_speed_hz = 20'000.0;
  std::uint8_t raw_readings = 200;  ///< in a packet of ID 40, at most 255
  OutboxDelays delays;
  double crystal_ppm = 0.0;
  Stamp boot_time = std::chrono::milliseconds(300);
  Stamp restart_delay = std::chrono::milliseconds(20);  ///< from the reset command to the restart
  std::uint32_t transmit_buffer_bytes = 512;
  std::uint64_t seed = 1;

  StrengthModel strength{1.5e5, 100.0};  ///< per cent
  double weak_strength = 1.0;            ///< per cent, while the fault WeakSignal lasts
  double saturated_strength = 120.0;     ///< per cent, while the fault Saturation lasts
};

/// Sets the update rate that the device has from the beginning: the nearest the product knows, or the full
/// speed of its raw stream from half of that on (LW20: high-speed mode).
void set_rate(LwnxSettings& settings, double rate_hz);

/// A reading as the device reports it.
struct LwnxReading {
  bool is_lost = true;
  double range_m = 0.0;   ///< of readings that are not lost
  double strength = 0.0;  ///< per cent
};

/// Makes readings of sights: strength, and the lost-signal counter, which repeats the last distance for some
/// misses before it says "lost".
class LwnxReader {
 public:
  explicit LwnxReader(const LwnxSettings& settings) : settings_(settings) {}

  struct Setup {
    std::uint32_t lost_counter = 0;
    bool tells_strength = false;  ///< else a weak echo is a miss: nobody could be warned of it
  };
  [[nodiscard]] LwnxReading read(const Sight& sight, const Setup& setup);

  void clear();

 private:
  [[nodiscard]] double strength_of(const Sight& sight) const;

  const LwnxSettings& settings_;
  LwnxReading last_;
  std::uint32_t misses_ = 0;
};

/// The data of ID 44 (cm, decimetres on the GRF-500) for a reading: the fields of the product that `bits`
/// selects, in their order.
void pack_cm(const LightWareProduct& product, std::uint64_t bits, const LwnxReading& reading,
             std::vector<std::uint8_t>& data);

/// The data of ID 45 (mm): the same fields in four bytes each.
void pack_mm(const LightWareProduct& product, std::uint64_t bits, const LwnxReading& reading,
             std::vector<std::uint8_t>& data);

/// A distance word of ID 40 or 44: `no_return` when there is none or it does not fit into `bytes` bytes.
struct LwnxUnit {
  double units_per_m = 100.0;
  std::uint8_t bytes = 2;
  std::int64_t no_return = -1;
};
[[nodiscard]] std::int64_t distance_word(const LwnxReading& reading, double range_m, const LwnxUnit& unit);

/// A LightWare rangefinder that speaks LWNX packets (LW20 manual revision 10, LW24, SF000, SF11 and SF20
/// manuals, LightWare's sample library and grf-500-api). A line of text chooses its interface, as a packet
/// does; it is not answered.
///
/// It measures while something streams, and once for each distance that is asked for. Requests that are not
/// whole, have a wrong CRC, a wrong length or an unknown ID are not answered, and neither is a save or reset
/// with a wrong token. A write of a value that the product does not take is answered with the value it keeps.
class EmulatedLwnx final : public EmulatedSerialDevice {
 public:
  /// `sink` and `scene` outlive the device.
  EmulatedLwnx(const LwnxSettings& settings, ByteSink& sink, RangeScene& scene);

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override;

  /// Knows PowerCycle, Silence, BaudReset, NoReturns, WeakSignal, Saturation, BadChecksum, StreamStops,
  /// TextMessage and DeviceError (text instead of readings).
  bool inject(const Fault& fault) override;
  void receive(std::uint8_t byte, Stamp at) override;
  [[nodiscard]] std::uint32_t baud() const override { return line_.baud(); }

  /// Streamed packets that were sent, and those that the line could not take.
  [[nodiscard]] std::uint64_t records_sent() const { return machine_.outbox.sent(); }
  [[nodiscard]] std::uint64_t records_dropped() const { return machine_.outbox.dropped(); }

  /// Requests that were refused: not whole, wrong CRC, length, ID, token.
  [[nodiscard]] std::uint64_t refused() const { return refused_ + receiver_.refused(); }

 private:
  // Life
  void step(Stamp now);
  void start_up(Stamp now);
  void go_down(Stamp until);
  void say(std::string_view text, Stamp at);
  [[nodiscard]] bool error_is_on(Stamp now) const {
    return machine_.faults.is_open(FaultKind::DeviceError, now);
  }

  // Requests
  void take_request(const LwnxRequest& request, Stamp at);
  void enter_lwnx(Stamp at);
  void answer_read(const LwnxRegister& command, Stamp at);
  void answer_write(const LwnxRegister& command, const LwnxRequest& request, Stamp at);
  [[nodiscard]] bool write(const LwnxRequest& request, Stamp at);
  [[nodiscard]] bool write_common(const LwnxRequest& request, Stamp at);
  [[nodiscard]] bool use_token(const LwnxRequest& request);
  void answer_distance(std::uint8_t id, Stamp at);
  void put_packet(std::uint8_t id, RequestAccess access, Stamp at);

  // Readings
  void retime(Stamp now);
  [[nodiscard]] double rate_hz(LwnxStream stream) const;
  [[nodiscard]] LwnxStream stream() const;
  [[nodiscard]] bool tells_strength() const;
  [[nodiscard]] LwnxReading measure(Stamp at);
  void shoot(Stamp at);
  void stream_packet(LwnxStream stream, const LwnxReading& reading, Stamp at);
  void stream_raw(const LwnxReading& reading, Stamp at);
  void put_record(std::uint8_t id, std::span<const Stamp> measured, Stamp at);

  LwnxSettings settings_;
  const LightWareProduct& product_;
  RangeScene& scene_;
  SerialOutboxLine line_;
  LaserMachine machine_;
  LwnxRegisters registers_;
  LwnxReader reader_;
  LwnxReceiver receiver_;

  std::uint8_t unanswered_first_ = 0;
  std::uint8_t unanswered_packets_ = 0;
  bool is_lwnx_ = false;  // a packet has come
  std::uint16_t token_;
  std::uint64_t tokens_ = 0;
  std::uint64_t refused_ = 0;
  Stamp error_text_at_ = hal::kNever;

  std::vector<std::uint8_t> data_;  // of the packet that is being made
  std::vector<std::uint8_t> packet_;
  std::vector<std::uint8_t> raw_;  // words of the packet of ID 40 that is being filled
  std::vector<Stamp> raw_measured_;
};

}  // namespace slamsensor::tools
