#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/rangefinder/laser_machine.hpp"
#include "tools/emulator/rangefinder/lwnx_packet.hpp"
#include "tools/emulator/rangefinder/lwnx_reading.hpp"
#include "tools/emulator/rangefinder/lwnx_registers.hpp"
#include "tools/emulator/rangefinder/lwnx_settings.hpp"
#include "tools/emulator/rangefinder/lwnx_text.hpp"
#include "tools/emulator/rangefinder/serial_outbox_line.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// A LightWare rangefinder: LWNX packets, the ASCII commands that precede them, and on demand the two-byte
/// stream of the old SF30 (LW20 manual revision 10, LW24, SF000, SF11 and SF20 manuals, LightWare's sample
/// library and grf-500-api).
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
  // Life (emulated_lwnx.cpp)
  void step(Stamp now);
  void start_up(Stamp now);
  void go_down(Stamp until);
  void say(std::string_view text, Stamp at);
  void say_due_text(Stamp now);
  [[nodiscard]] bool error_is_on(Stamp now) const {
    return machine_.faults.is_open(FaultKind::DeviceError, now);
  }

  // Requests (emulated_lwnx_requests.cpp)
  void take_request(const LwnxRequest& request, Stamp at);
  void enter_lwnx(Stamp at);
  void answer_read(const LwnxRegister& command, Stamp at);
  void answer_write(const LwnxRegister& command, const LwnxRequest& request, Stamp at);
  [[nodiscard]] bool write(const LwnxRequest& request, Stamp at);
  [[nodiscard]] bool write_common(const LwnxRequest& request, Stamp at);
  [[nodiscard]] bool use_token(const LwnxRequest& request);
  void answer_distance(std::uint8_t id, Stamp at);
  void put_packet(std::uint8_t id, LwnxAccess access, Stamp at);

  // Text (emulated_lwnx_text.cpp)
  void take_text(std::uint8_t byte, Stamp at);
  void take_line(std::string_view line, Stamp at);
  void answer_text(const LwnxTextCommand& command, Stamp at);
  void set_baud_by_text(const LwnxTextCommand& command);
  void put_text(std::string_view text, Stamp at, std::span<const Stamp> measured = {});
  [[nodiscard]] double text_range_m(const LwnxReading& reading) const;

  // Readings (emulated_lwnx_stream.cpp)
  void retime(Stamp now);
  [[nodiscard]] double rate_hz(LwnxStream stream) const;
  [[nodiscard]] LwnxStream stream() const;
  [[nodiscard]] bool tells_strength() const;
  [[nodiscard]] LwnxReading measure(Stamp at);
  void shoot(Stamp at);
  void stream_packet(LwnxStream stream, const LwnxReading& reading, Stamp at);
  void stream_raw(const LwnxReading& reading, Stamp at);
  void stream_text(const LwnxReading& reading, Stamp at);
  void put_record(std::uint8_t id, std::span<const Stamp> measured, Stamp at);
  void send_statistics(Stamp now);

  LwnxSettings settings_;
  const LwnxProduct& product_;
  RangeScene& scene_;
  SerialOutboxLine line_;
  LaserMachine machine_;
  LwnxRegisters registers_;
  LwnxReader reader_;
  LwnxReceiver receiver_;

  std::uint8_t unanswered_first_ = 0;
  std::uint8_t unanswered_packets_ = 0;
  bool is_lwnx_ = false;  // a packet has come: no more text
  std::string text_;
  std::optional<LwnxTextCommand> text_stream_;
  std::uint16_t token_;
  std::uint64_t tokens_ = 0;
  std::uint64_t refused_ = 0;
  Stamp statistics_at_ = hal::kNever;
  Stamp text_at_ = hal::kNever;

  std::vector<std::uint8_t> data_;  // of the packet that is being made
  std::vector<std::uint8_t> packet_;
  std::vector<std::uint8_t> raw_;  // words of the packet of ID 40 that is being filled
  std::vector<Stamp> raw_measured_;
};

}  // namespace slamsensor::tools
