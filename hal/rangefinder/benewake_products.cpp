#include "hal/rangefinder/benewake_products.hpp"

#include <array>

namespace slamsensor::hal {
namespace {

// As signed words: -1 too weak, -2 saturated, -4 blinded by ambient light.
constexpr std::array kMiniCodes = {RangeCode{0xFFFF, Echo::None}, RangeCode{0xFFFE, Echo::Saturated},
                                   RangeCode{0xFFFC, Echo::Fault}};
constexpr std::uint16_t kOverexposed =
    0xFFFF;  // as strength: the echo was too strong, whatever the distance says
constexpr std::uint16_t kFirstCode = 0x8000;  // no member of the family measures 327 m
constexpr std::uint8_t kReliableFrom = 7;
constexpr std::uint8_t kReliableTo = 8;

constexpr std::array kProducts = {
    BenewakeProduct{.name = "Benewake TF03",
                    .commands = BenewakeCommands::OverRange,
                    .rate_max_hz = 10000.0,
                    .weak_below = 40.0},
    BenewakeProduct{.name = "Benewake TFmini",
                    .commands = BenewakeCommands::None,
                    .rate_max_hz = 100.0,
                    .weak_below = 20.0,
                    .codes = kMiniCodes},
    BenewakeProduct{.name = "Benewake TFmini Plus", .weak_below = 100.0, .codes = kMiniCodes},
    BenewakeProduct{.name = "Benewake TFmini-S", .weak_below = 100.0, .codes = kMiniCodes},
    BenewakeProduct{.name = "Benewake TF02",
                    .commands = BenewakeCommands::None,
                    .rate_max_hz = 100.0,
                    .codes = kMiniCodes,
                    .has_reliability = true}};

}  // namespace

const BenewakeProduct& benewake_product(BenewakeModel model) noexcept {
  return kProducts[static_cast<std::size_t>(model)];
}

Measurement measured(const BenewakeReading& reading, const BenewakeProduct& product,
                     std::uint16_t over_range_cm) noexcept {
  Measurement out{.range_m = reading.distance_cm * 0.01, .strength = static_cast<double>(reading.strength)};
  for (const RangeCode& code : product.codes) {
    if (reading.distance_cm == code.word) {
      out.echo = code.echo;
    }
  }
  if (reading.strength == kOverexposed && out.echo != Echo::Fault) {
    out.echo = Echo::Saturated;
  }
  if (out.echo != Echo::Return) {
    return out;
  }
  if (reading.distance_cm == 0 || (over_range_cm > 0 && reading.distance_cm >= over_range_cm)) {
    out.echo = Echo::None;
  } else if (reading.distance_cm >= kFirstCode) {
    out.echo = Echo::Fault;
  } else if (product.has_reliability &&
             (reading.reliability < kReliableFrom || reading.reliability > kReliableTo)) {
    out.echo = Echo::Weak;
  }
  return out;
}

}  // namespace slamsensor::hal
