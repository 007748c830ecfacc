#include "hal/rangefinder/lwnx_reading.hpp"

namespace slamsensor::hal {
namespace {

std::int32_t signed_field(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  }
  return bytes.size() == 2 ? static_cast<std::int16_t>(value) : static_cast<std::int32_t>(value);
}

}  // namespace

std::optional<Measurement> read_lwnx_reading(std::span<const std::uint8_t> data,
                                             const LwnxLayout& layout) noexcept {
  const std::size_t width = layout.width;
  if (data.size() != width * layout.fields || layout.fields <= layout.strength_field) {
    return std::nullopt;
  }
  Measurement out;
  out.range_m = signed_field(data.first(width)) * layout.unit_m;
  out.strength = signed_field(data.subspan(layout.strength_field * width, width));
  return out;
}

std::size_t read_lwnx_raw(std::span<const std::uint8_t> data, std::span<Measurement> into) noexcept {
  if (data.empty() || data.size() != 1 + 2 * static_cast<std::size_t>(data[0]) || data[0] > into.size()) {
    return 0;
  }
  for (std::size_t i = 0; i < data[0]; ++i) {
    into[i] = {.range_m = signed_field(data.subspan(1 + 2 * i, 2)) * 0.01};
  }
  return data[0];
}

void put_lwnx_value(std::uint32_t value, std::span<std::uint8_t> into) noexcept {
  for (std::size_t i = 0; i < into.size(); ++i) {
    into[i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

}  // namespace slamsensor::hal
