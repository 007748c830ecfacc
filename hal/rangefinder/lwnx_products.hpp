#pragma once

#include "hal/rangefinder/lwnx_packet.hpp"
#include "hal/rangefinder/range_driver.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace slamsensor::hal {

/// Commands that mean the same on every LWNX device (LW20 serial manual).
namespace lwnx_id {
inline constexpr std::uint8_t kProductName = 0;
inline constexpr std::uint8_t kToken = 10;
inline constexpr std::uint8_t kSave = 12;
inline constexpr std::uint8_t kReset = 14;
inline constexpr std::uint8_t kStream = 30;
inline constexpr std::uint8_t kRawReadings = 40;
inline constexpr std::uint8_t kReading = 44;    ///< centimetres on most
inline constexpr std::uint8_t kReadingMm = 45;  ///< millimetres, 32 bits
inline constexpr std::uint8_t kLaser = 50;
}  // namespace lwnx_id

enum class LwnxRateCode : std::uint8_t {
  None,     ///< cannot be set
  Table,    ///< place in `rates`, from `first_code` on
  TenthHz,  ///< ten times the rate, 32 bits; `rates` are its bounds
};

/// What differs between products: command numbers, widths, codes. Command 0 gives the name by which a row is
/// found. 0 stands for a command that the product does not have.
struct LwnxProduct {
  std::string_view name;       ///< the product's name begins with this
  std::string_view refused{};  ///< why it cannot be used here; empty when it can
  std::uint8_t output_id = 27;
  std::uint32_t output_bits = 0;    ///< first return raw and its strength
  std::uint8_t strength_field = 1;  ///< place among the fields sent; the distance is field 0
  std::uint8_t fields = 2;
  std::uint8_t reading_width = 2;  ///< bytes of a field in command 44
  double reading_unit_m = 0.01;    ///< of a distance in command 44
  std::uint8_t stream_mm = 0;      ///< value of command 30 for command 45
  std::uint8_t stream_raw = 0;     ///< value of command 30 for command 40
  std::uint8_t raw_mode_id = 0;    ///< command that switches 20 kHz on and off
  double raw_rate_hz = 0.0;
  LwnxRateCode rate_code = LwnxRateCode::None;
  std::uint8_t rate_id = 0;
  std::uint8_t rate_width = 1;
  std::uint8_t first_code = 1;
  std::span<const double> rates{};
  std::uint8_t lost_signal_id = 0;
  std::uint8_t baud_id = 0;
  /// Strength from which an echo counts as saturated: it is given in per cent of the full scale (LW20 manual,
  /// LightWare's samples), so what is above 100 was too bright to be measured.
  double saturated_from = 101.0;
  /// Whether its command numbers are published; else a setting that is not answered is gone without.
  bool is_documented = true;
};

inline constexpr std::uint8_t kLwnxStreamOff = 0;
inline constexpr std::uint8_t kLwnxStreamReadings = 5;  ///< command 44, on every product

/// Line rates by their code in the baud command.
inline constexpr std::array<std::uint32_t, 8> kLwnxBauds = {9600,   19200,  38400,  57600,
                                                            115200, 230400, 460800, 921600};

/// All products known, those with longer names before those whose name they begin with.
[[nodiscard]] std::span<const LwnxProduct> lwnx_products() noexcept;

/// The row of a product by the name that it gives; nullptr when there is none.
[[nodiscard]] const LwnxProduct* find_lwnx_product(std::string_view name) noexcept;

struct LwnxRate {
  std::uint32_t code = 0;
  double rate_hz = 0.0;
};
/// The rate nearest to `wanted_hz` that the product can be set to; code 0 when it cannot be set.
[[nodiscard]] LwnxRate nearest_rate(const LwnxProduct& product, double wanted_hz) noexcept;

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
