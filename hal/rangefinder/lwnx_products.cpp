#include "hal/rangefinder/lwnx_products.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamsensor::hal {
namespace {

// Command 93 of the LW20, command 66 of SF000 and LW24: the slow part of one list (LW20 and SF20 manuals).
constexpr std::array kSlowRates = {48.0, 55.0, 64.0, 77.0, 97.0, 129.0, 194.0, 388.0};
constexpr std::array kWideRates = {48.0,  55.0,  64.0,  77.0,   97.0,   129.0,
                                   194.0, 388.0, 625.0, 1250.0, 2500.0, 5000.0};
constexpr std::array kSf45Rates = {50.0,   100.0,  200.0,  400.0,  500.0,  625.0,
                                   1000.0, 1250.0, 1538.0, 2000.0, 2500.0, 5000.0};
// Known: code 8 is 78 readings a second and the full rate 20 000; each code halves it (SF30/D sample).
constexpr std::array kSf30Rates = {20000.0, 10000.0, 5000.0, 2500.0, 1250.0, 625.0, 312.5, 156.25, 78.125};

constexpr std::array kSf11Rates = {20.0};       // its only one (SF11 manual)
constexpr std::array kGrfBounds = {0.5, 10.0};  // grf-500-api

constexpr std::uint32_t kLw20Bits = 0x11;    // first raw, first strength
constexpr std::uint32_t kCommonBits = 0x05;  // first raw, first strength

constexpr LwnxProduct lw20(std::string_view name) {
  return {.name = name,
          .output_bits = kLw20Bits,
          .stream_raw = 1,
          .raw_mode_id = 70,
          .raw_rate_hz = 20000.0,
          .rate_code = LwnxRateCode::Table,
          .rate_id = 93,
          .rates = kSlowRates,
          .lost_signal_id = 95,
          .baud_id = 90};
}

constexpr LwnxProduct sf000(std::string_view name) {
  return {.name = name,
          .output_bits = kCommonBits,
          .stream_mm = 6,
          .rate_code = LwnxRateCode::Table,
          .rate_id = 66,
          .rates = kWideRates,
          .lost_signal_id = 76,
          .baud_id = 79};
}

constexpr LwnxProduct sf45() {
  LwnxProduct product = sf000("SF45");
  product.rates = kSf45Rates;
  return product;
}

constexpr LwnxProduct sf30d() {
  return {.name = "SF30",
          .output_id = 29,
          .output_bits = kCommonBits,
          .stream_raw = 11,
          .raw_rate_hz = 20000.0,
          .rate_code = LwnxRateCode::Table,
          .rate_id = 76,
          .first_code = 0,
          .rates = kSf30Rates,
          .is_documented = false};
}

constexpr LwnxProduct sf11() {
  return {.name = "SF11",
          .output_bits = kLw20Bits,
          .rates = kSf11Rates,
          .lost_signal_id = 95,
          .is_documented = false};
}

constexpr LwnxProduct grf(std::string_view name) {
  return {
      .name = name,
      .output_bits = kCommonBits,
      .reading_width = 4,
      .reading_unit_m = 0.1,
      .rate_code = LwnxRateCode::TenthHz,
      .rate_id = 74,
      .rate_width = 4,
      .rates = kGrfBounds,
      .lost_signal_id = 78,
      .baud_id = 91,
      .saturated_from = std::numeric_limits<double>::infinity()};  // its manual gives no scale of strength
}

constexpr std::array kProducts = {
    lw20("LW20"),
    lw20("SF20"),
    sf000("LW24"),
    sf000("SF000"),
    sf11(),
    sf30d(),
    LwnxProduct{.name = "SF40",
                .refused = "the SF40 turns its own mirror and cannot be aimed; connect a rangefinder that "
                           "looks one way"},
    sf45(),
    grf("GRF250"),
    grf("GRF-250"),
    grf("GRF500"),
    grf("GRF-500")};

}  // namespace

std::span<const LwnxProduct> lwnx_products() noexcept {
  return kProducts;
}

const LwnxProduct* find_lwnx_product(std::string_view name) noexcept {
  const auto found = std::find_if(kProducts.begin(), kProducts.end(), [name](const LwnxProduct& product) {
    return name.substr(0, product.name.size()) == product.name;
  });
  return found == kProducts.end() ? nullptr : &*found;
}

LwnxRate nearest_rate(const LwnxProduct& product, double wanted_hz) noexcept {
  if (product.rate_code == LwnxRateCode::TenthHz) {
    const double tenths =
        std::round(std::clamp(wanted_hz, product.rates.front(), product.rates.back()) * 10.0);
    return {static_cast<std::uint32_t>(tenths), tenths / 10.0};
  }
  LwnxRate best;
  for (std::size_t i = 0; i < product.rates.size(); ++i) {
    if (best.rate_hz == 0.0 || std::abs(product.rates[i] - wanted_hz) < std::abs(best.rate_hz - wanted_hz)) {
      best = {static_cast<std::uint32_t>(i + product.first_code), product.rates[i]};
    }
  }
  return best;
}

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
