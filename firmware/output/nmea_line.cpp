#include "firmware/output/nmea_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace slamsensor::firmware {
namespace {

constexpr double kBitsPerByte = 10.0;  // with start and stop bit

// The longest that each sentence gets, "$" and CR LF included.
constexpr std::size_t kRmcMax = 67;
constexpr std::size_t kGgaMax = 82;
constexpr std::size_t kGbsMax = 44;
constexpr std::size_t kHdtMax = 20;
constexpr std::size_t kThsMax = 20;
constexpr std::size_t kGstMax = 72;
constexpr std::size_t kZdaMax = 39;
constexpr std::size_t kPslmaMax = 82;

std::size_t without_zda(const NmeaSentences& sentences) noexcept {
  return (sentences.rmc ? kRmcMax : 0) + (sentences.gga ? kGgaMax : 0) + (sentences.gbs ? kGbsMax : 0) +
         (sentences.hdt ? kHdtMax : 0) + (sentences.ths ? kThsMax : 0) + (sentences.gst ? kGstMax : 0) +
         (sentences.pslma ? kPslmaMax : 0);
}

}  // namespace

std::size_t nmea_epoch_bytes_max(const NmeaConfig& config) noexcept {
  return without_zda(config.sentences) + (config.zda ? kZdaMax : 0);
}

double NmeaLineLoad::bits_per_s() const noexcept {
  const double bytes_per_s =
      static_cast<double>(epoch_bytes) * rate_hz + static_cast<double>(zda_bytes) * std::min(rate_hz, 1.0);
  return bytes_per_s * kBitsPerByte;
}

NmeaLineLoad nmea_line_load(const NmeaConfig& config, double rate_hz, std::uint32_t baud) {
  return {without_zda(config.sentences), config.zda ? kZdaMax : 0, rate_hz, baud};
}

std::string to_text(const NmeaLineLoad& load) {
  const double bits = load.bits_per_s();
  const double usable = NmeaLineLoad::kShareMax * static_cast<double>(load.baud);
  std::array<char, 320> text{};
  std::snprintf(text.data(), text.size(),
                "%g epochs/s of up to %zu bytes%s are up to %.0f bit/s, %.0f %% of the line's %lu, of which "
                "%.0f %% are usable: take at least %.0f baud, at most %.2f epochs/s, or fewer sentences",
                load.rate_hz, load.epoch_bytes, load.zda_bytes > 0 ? " and a ZDA" : "", bits,
                100.0 * load.share(), static_cast<unsigned long>(load.baud), 100.0 * NmeaLineLoad::kShareMax,
                std::ceil(bits / NmeaLineLoad::kShareMax),
                std::floor(100.0 * load.rate_hz * usable / bits) / 100.0);
  return text.data();
}

}  // namespace slamsensor::firmware
