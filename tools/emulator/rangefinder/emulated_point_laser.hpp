#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/emulator/rangefinder/laser_machine.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// How a point laser writes a reading.
enum class PointCoding : std::uint8_t {
  Decimal,
  SevenBit,  ///< 14 bits of distance in two bytes, high bits first; the top bit marks the first byte
};

/// What stands in a text record beside the distance; the numbers are those of the LDS70A's command SD.
enum class PointExtras : std::uint8_t { None = 0, Quality = 1 };

struct PointFormat {
  PointCoding coding = PointCoding::Decimal;
  PointExtras extras = PointExtras::None;
  std::string prefix;
  std::uint8_t digits = 4;         ///< before the point, zeros in front
  std::uint8_t decimals = 3;       ///< behind it
  double units_per_m = 1000.0;     ///< of the number in SevenBit
  std::string no_return = "DE02";  ///< text for no echo, and for one that looks like none; 0 in SevenBit
  std::string error = "DE04";
};

/// What a record is made of.
struct PointReading {
  enum class Kind : std::uint8_t { Distance, NoReturn, Error } kind = Kind::NoReturn;
  double range_m = 0.0;
  double quality = 0.0;
};

/// The record of `reading`. A distance that does not fit is written as if nothing had come back.
void build_point_record(const PointFormat& format, const PointReading& reading,
                        std::vector<std::uint8_t>& out);

/// Bytes of the record of a distance.
[[nodiscard]] std::size_t point_record_bytes(const PointFormat& format);

/// Which commands a point laser takes.
enum class PointDialect : std::uint8_t {
  None,    ///< it streams from power-up on and hears nothing
  Lds70a,  ///< ASTECH LDS70A, LAM71, LDM71
};

/// How an EmulatedPointLaser is built and set up.
struct PointSettings {
  PointDialect dialect = PointDialect::None;
  PointFormat format;
  DeviceBegin begin = DeviceBegin::PowerUp;
  std::uint32_t baud = 115200;
  double rate_hz = 1000.0;  ///< LDS70A: limited by the line rate
  std::string identity = "LDS70A 1.02 EMU-000001";
  OutboxDelays delays;
  double crystal_ppm = 0.0;
  Stamp boot_time = std::chrono::milliseconds(300);
  std::uint32_t transmit_buffer_bytes = 64;
  std::uint64_t seed = 1;

  StrengthModel quality{4e5, 1500.0};
  double quality_of_weak = 5.0;        ///< while the fault WeakSignal lasts and the record holds quality
  double quality_of_blinded = 2000.0;  ///< while the fault Saturation lasts and the record holds quality
};

/// ASTECH LDS70A (user manual, pages 34 to 56). The layout of its records is chosen to have the widths of
/// table 7: 11 or 16 bytes of text.
[[nodiscard]] PointSettings lds70a_settings();

/// MDL LaserAce IM HR. Unverified: nothing is public but 1 kHz, 300 m and a resolution of 0.1 m; the record,
/// a decimal number and CR LF, is a guess.
[[nodiscard]] PointSettings laserace_im_settings();

/// What the device does besides answering a command.
enum class PointAction : std::uint8_t { None, Track };

struct PointAnswer {
  std::string text;  ///< with its line ends
  PointAction action = PointAction::None;
};

/// The commands of an LDS70A by which a driver sets it up: SD 0 n (record) and DT (measure on and on).
class PointCommands {
 public:
  explicit PointCommands(const PointSettings& settings);

  /// Does `line`, which came without its CR. Any other command is answered "?".
  [[nodiscard]] PointAnswer run(std::string_view line);

  [[nodiscard]] const PointFormat& format() const { return format_; }

  /// Readings per second at `baud`: those of the settings, of an LDS70A at most what the line carries.
  [[nodiscard]] double rate_hz(std::uint32_t baud) const;

 private:
  const PointSettings& settings_;
  PointFormat format_;
};

/// A laser that writes one record for each reading on a serial line: ASTECH LDS70A with its commands, or any
/// other that only streams (PointSettings).
class EmulatedPointLaser final : public EmulatedSerialDevice {
 public:
  /// `sink` and `scene` outlive the device.
  EmulatedPointLaser(const PointSettings& settings, ByteSink& sink, RangeScene& scene);

  void advance(Stamp now) override;
  [[nodiscard]] Stamp next_event() const override { return machine_.next_event(); }

  /// Knows PowerCycle, Silence, BaudReset, NoReturns, WeakSignal, Saturation, TextMessage, DeviceError and,
  /// if it has commands, StreamStops. Its records have no checksum.
  bool inject(const Fault& fault) override;

  /// Escape and every command stop the readings.
  void receive(std::uint8_t byte, Stamp at) override;
  [[nodiscard]] std::uint32_t baud() const override { return line_.baud(); }

  /// Records that were sent, and those that the line could not take.
  [[nodiscard]] std::uint64_t records_sent() const { return machine_.outbox.sent(); }
  [[nodiscard]] std::uint64_t records_dropped() const { return machine_.outbox.dropped(); }

 private:
  void step(Stamp now);
  void start_up(Stamp now);
  void go_down(Stamp until);
  void take_line(std::string_view line, Stamp at);
  void track(Stamp at);
  void put_text(std::string_view text, Stamp at);
  void build_record(Stamp at);
  [[nodiscard]] PointReading read(const Sight& sight) const;

  PointSettings settings_;
  RangeScene& scene_;
  SerialOutboxLine line_;
  LaserMachine machine_;
  PointCommands commands_;
  std::string text_;
  std::vector<std::uint8_t> record_;
};

}  // namespace slamsensor::tools
