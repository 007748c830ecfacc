#pragma once

#include "firmware/config/config.hpp"

#include <cstddef>
#include <cstdint>
#include <string>

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

}  // namespace slamsensor::firmware
