#pragma once

#include "hal/rangefinder/lwnx_packet.hpp"
#include "hal/rangefinder/lwnx_products.hpp"
#include "hal/rangefinder/range_driver.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::hal {

/// How the fields of commands 44 and 45 are to be read.
struct LwnxLayout {
  std::uint8_t width = 2;  ///< bytes of a field: 2 or 4, signed
  double unit_m = 0.01;
  std::uint8_t fields = 2;
  std::uint8_t strength_field = 1;
};

/// A reading from the data of command 44 or 45; nothing when its size is not that of the layout.
[[nodiscard]] std::optional<Measurement> read_lwnx_reading(std::span<const std::uint8_t> data,
                                                           const LwnxLayout& layout) noexcept;

/// Readings from the data of command 40 (centimetres) into `into`; how many: 0 when the count does not agree
/// with the size.
[[nodiscard]] std::size_t read_lwnx_raw(std::span<const std::uint8_t> data,
                                        std::span<Measurement> into) noexcept;

/// `value` in `width` bytes, little-endian.
void put_lwnx_value(std::uint32_t value, std::span<std::uint8_t> into) noexcept;

}  // namespace slamsensor::hal
