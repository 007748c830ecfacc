#pragma once

#include "tools/emulator/rangefinder/sight.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// How a point laser writes a reading.
enum class PointCoding : std::uint8_t {
  Decimal,
  Hex,
  SevenBit,      ///< 14 bits of distance in two bytes, high bits first; the top bit marks the first byte
  BigEndian,     ///< 16 bits
  LittleEndian,  ///< 16 bits
};

/// What stands in a record beside the distance; the numbers are those of the LDS70A's command SD.
enum class PointExtras : std::uint8_t { None = 0, Quality = 1, Temperature = 2, Both = 3 };

struct PointFormat {
  PointCoding coding = PointCoding::Decimal;
  PointExtras extras = PointExtras::None;
  std::string prefix;
  std::uint8_t digits = 4;    ///< before the point, zeros in front
  std::uint8_t decimals = 3;  ///< behind it; 0: no point
  std::uint8_t hex_digits = 6;
  double units_per_m = 1000.0;  ///< of the number in Hex and the binary codings
  char quality_separator = ' ';
  std::uint8_t quality_digits = 4;
  std::string terminator = "\r\n";  ///< of text

  std::string no_return = "DE02";  ///< text for no echo, and for one that cannot be told from none
  std::string error = "DE04";
  std::uint16_t no_return_number = 0;  ///< the same in the binary codings
  std::uint16_t error_number = 0;
};

/// What a record is made of.
struct PointReading {
  enum class Kind : std::uint8_t { Distance, NoReturn, Error } kind = Kind::NoReturn;
  double range_m = 0.0;
  double quality = 0.0;
  double temperature_c = 23.5;
};

[[nodiscard]] constexpr bool is_text(PointCoding coding) {
  return coding == PointCoding::Decimal || coding == PointCoding::Hex;
}
[[nodiscard]] constexpr bool has_quality(PointExtras extras) {
  return (static_cast<unsigned>(extras) & 1U) != 0;
}
[[nodiscard]] constexpr bool has_temperature(PointExtras extras) {
  return (static_cast<unsigned>(extras) & 2U) != 0;
}

/// The record of `reading`. A distance that does not fit is written as if nothing had come back.
void build_point_record(const PointFormat& format, const PointReading& reading,
                        std::vector<std::uint8_t>& out);

/// Bytes of the record of a distance.
[[nodiscard]] std::size_t point_record_bytes(const PointFormat& format);

/// `value` with `decimals` digits behind the point and, sign included, at least `width` characters, zeros in
/// front.
[[nodiscard]] std::string fixed_text(double value, int decimals, int width = 0);

}  // namespace slamsensor::tools
