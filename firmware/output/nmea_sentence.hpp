#pragma once

#include "firmware/config/sensor_config.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// Most bytes of a regular epoch of `config`, a ZDA included, whatever it says.
[[nodiscard]] std::size_t nmea_epoch_bytes_max(const NmeaConfig& config) noexcept;

/// What the regular epochs ask of a serial line of 8 data bits without parity (10 bits a byte).
struct NmeaLineLoad {
  /// Beyond this share prompt epochs find no room between the regular ones.
  static constexpr double kShareMax = 0.9;

  std::size_t epoch_bytes = 0;  ///< at most, without the ZDA
  std::size_t zda_bytes = 0;    ///< once a second, at most
  double rate_hz = 1.0;
  std::uint32_t baud = 0;

  [[nodiscard]] double bits_per_s() const noexcept;
  [[nodiscard]] double share() const noexcept { return bits_per_s() / static_cast<double>(baud); }
  [[nodiscard]] bool fits() const noexcept { return share() <= kShareMax; }
};

/// The load of `config` at `rate_hz` epochs per second on a line of `baud` bit/s.
[[nodiscard]] NmeaLineLoad nmea_line_load(const NmeaConfig& config, double rate_hz, std::uint32_t baud);

/// The arithmetic for a person: "10 epochs/s of up to 370 bytes are 37000 bit/s, 96 % of the line's 38400;
/// at most 90 % are usable: at least 41112 baud, at most 9.34 epochs/s, or fewer sentences".
[[nodiscard]] std::string to_text(const NmeaLineLoad& load);

/// Longest NMEA 0183 sentence, "$" and CR LF included.
inline constexpr std::size_t kNmeaSentenceMax = 82;

/// XOR of all characters: of a sentence, those between "$" and "*".
[[nodiscard]] std::uint8_t nmea_checksum(std::string_view characters) noexcept;

/// One sentence in the making. Fields are appended in order, each with its comma before it; nothing is
/// allocated and no locale is asked. A sentence that grows too long is not valid and `finish` gives nothing.
class NmeaSentence {
 public:
  /// `address` as "GPRMC" or "PSLMA".
  explicit NmeaSentence(std::string_view address) noexcept;

  NmeaSentence& blank(int count = 1) noexcept;
  NmeaSentence& text(std::string_view field) noexcept;
  NmeaSentence& letter(char field) noexcept { return text({&field, 1}); }
  /// Decimal digits, with zeros in front up to `width`.
  NmeaSentence& integer(std::uint64_t field, int width = 1) noexcept;
  /// Rounded to `decimals` (0 to 9), never "-0.0". Empty when not finite or beyond 1e9 in magnitude.
  NmeaSentence& fixed(double field, int decimals) noexcept;
  /// The angle rounded and brought into [0, `period_deg`): 359.996 of 360 with two decimals is 0.00.
  NmeaSentence& wrapped(double field_deg, int period_deg, int decimals) noexcept;

  /// The whole sentence with checksum and CR LF, until this object changes; empty when it exceeds
  /// kNmeaSentenceMax.
  [[nodiscard]] std::string_view finish() noexcept;

 private:
  static constexpr std::size_t kTailLength = 5;  // "*hh" CR LF

  void put(char c) noexcept;
  void put_units(std::uint64_t units, int decimals) noexcept;

  std::array<char, kNmeaSentenceMax> characters_{};
  std::size_t size_ = 0;
  bool too_long_ = false;
};

/// A field that is formatted apart, because it holds fixed columns.
struct NmeaField {
  std::array<char, 20> characters{};
  std::size_t size = 0;

  [[nodiscard]] std::string_view text() const noexcept { return {characters.data(), size}; }
};

/// |angle| in degrees as "ddmm.mmm" with `degree_digits` (2 or 3) and `decimals` of a minute (1 to 9),
/// rounded to the nearest; sixty minutes never appear. `negative` is the sign of what was written: false when
/// it rounded to zero.
struct NmeaAngle {
  NmeaField field;
  bool negative = false;
};
[[nodiscard]] NmeaAngle nmea_angle(double angle_deg, int degree_digits, int decimals) noexcept;

/// A UTC instant rounded to the hundredth of a second, so that time and date belong together: 23:59:59.996 is
/// 00:00:00.00 of the next day.
struct NmeaTime {
  NmeaField time;  ///< hhmmss.ss
  NmeaField date;  ///< ddmmyy
  std::uint32_t day = 0;
  std::uint32_t month = 0;
  std::int32_t year = 0;
};
[[nodiscard]] NmeaTime nmea_time(std::chrono::nanoseconds utc) noexcept;

}  // namespace slamsensor::firmware
