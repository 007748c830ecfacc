#include "tools/emulator/rangefinder/point_format.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace slamsensor::tools {
namespace {

void append_text(std::string_view text, std::vector<std::uint8_t>& out) {
  out.insert(out.end(), text.begin(), text.end());
}

void append_decimal(const PointFormat& format, double range_m, std::vector<std::uint8_t>& out) {
  const int point = format.decimals > 0 ? 1 : 0;
  std::array<char, 48> text{};
  const int size = std::snprintf(text.data(), text.size(), "%0*.*f", format.digits + point + format.decimals,
                                 format.decimals, range_m);
  append_text({text.data(), static_cast<std::size_t>(size)}, out);
}

void append_hex(const PointFormat& format, double range_m, std::vector<std::uint8_t>& out) {
  const auto number = static_cast<std::uint32_t>(std::llround(range_m * format.units_per_m));
  const auto kept = format.hex_digits < 8 ? number & ((1U << (4U * format.hex_digits)) - 1U) : number;
  std::array<char, 16> text{};
  const int size = std::snprintf(text.data(), text.size(), "%0*X", format.hex_digits, kept);
  append_text({text.data(), static_cast<std::size_t>(size)}, out);
}

void append_extras(const PointFormat& format, const PointReading& reading, std::vector<std::uint8_t>& out) {
  std::array<char, 48> text{};
  if (has_quality(format.extras)) {
    const int size = std::snprintf(text.data(), text.size(), "%c%0*lld", format.quality_separator,
                                   format.quality_digits, std::llround(reading.quality));
    append_text({text.data(), static_cast<std::size_t>(size)}, out);
  }
  if (has_temperature(format.extras)) {
    const int size = std::snprintf(text.data(), text.size(), " %+05.1f", reading.temperature_c);
    append_text({text.data(), static_cast<std::size_t>(size)}, out);
  }
}

void build_text(const PointFormat& format, const PointReading& reading, std::vector<std::uint8_t>& out) {
  if (reading.kind == PointReading::Kind::Distance) {
    append_text(format.prefix, out);
    if (format.coding == PointCoding::Decimal) {
      append_decimal(format, reading.range_m, out);
    } else {
      append_hex(format, reading.range_m, out);
    }
    append_extras(format, reading, out);
  } else {
    append_text(reading.kind == PointReading::Kind::Error ? format.error : format.no_return, out);
  }
  append_text(format.terminator, out);
}

unsigned number_of(const PointFormat& format, const PointReading& reading) {
  if (reading.kind != PointReading::Kind::Distance) {
    return reading.kind == PointReading::Kind::Error ? format.error_number : format.no_return_number;
  }
  const double highest = format.coding == PointCoding::SevenBit ? 16'383.0 : 65'535.0;
  const double number = std::round(reading.range_m * format.units_per_m);
  return number >= 0.0 && number <= highest ? static_cast<unsigned>(number) : format.no_return_number;
}

void build_binary(const PointFormat& format, const PointReading& reading, std::vector<std::uint8_t>& out) {
  const unsigned number = number_of(format, reading);
  const auto byte = [](unsigned value) { return static_cast<std::uint8_t>(value & 0xFFU); };
  if (format.coding == PointCoding::SevenBit) {
    out.push_back(byte(0x80U | number >> 7U));
    out.push_back(byte(number & 0x7FU));
  } else {
    const bool is_big = format.coding == PointCoding::BigEndian;
    out.push_back(byte(is_big ? number >> 8U : number));
    out.push_back(byte(is_big ? number : number >> 8U));
  }
  constexpr double kQualityStep = 16.0;  // seven bits for 0 to 2047
  if (has_quality(format.extras)) {
    out.push_back(byte(static_cast<unsigned>(std::clamp(reading.quality / kQualityStep, 0.0, 127.0))));
  }
  if (has_temperature(format.extras)) {
    out.push_back(byte(static_cast<unsigned>(std::clamp(reading.temperature_c, 0.0, 127.0))));
  }
}

}  // namespace

void build_point_record(const PointFormat& format, const PointReading& reading,
                        std::vector<std::uint8_t>& out) {
  out.clear();
  if (is_text(format.coding)) {
    build_text(format, reading, out);
  } else {
    build_binary(format, reading, out);
  }
}

std::size_t point_record_bytes(const PointFormat& format) {
  std::vector<std::uint8_t> record;
  build_point_record(format, {.kind = PointReading::Kind::Distance, .range_m = 1.0}, record);
  return record.size();
}

std::string fixed_text(double value, int decimals, int width) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%0*.*f", width, decimals, value);
  return text.data();
}

}  // namespace slamsensor::tools
