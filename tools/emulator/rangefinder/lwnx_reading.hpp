#pragma once

#include "tools/emulator/rangefinder/lwnx_settings.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace slamsensor::tools {

/// A reading as the device tells it.
struct LwnxReading {
  bool is_lost = true;
  double range_m = 0.0;   ///< zero offset included; of readings that are not lost
  double strength = 0.0;  ///< per cent
};

/// Makes readings of sights: strength, zero offset, and the lost-signal counter, which repeats the last
/// distance for some misses before it says "lost".
class LwnxReader {
 public:
  explicit LwnxReader(const LwnxSettings& settings) : settings_(settings) {}

  struct Setup {
    double zero_offset_m = 0.0;
    std::uint32_t lost_counter = 0;
    bool tells_strength = false;  ///< else a weak echo is a miss: nobody could be warned of it
  };
  [[nodiscard]] LwnxReading read(const Sight& sight, const Setup& setup);

  /// Of the last five readings with a distance; `latest` when there are none.
  struct Recent {
    double closest_m = 0.0;
    double median_m = 0.0;
    double furthest_m = 0.0;
  };
  [[nodiscard]] Recent recent(const LwnxReading& latest) const;

  void clear();

 private:
  [[nodiscard]] double strength_of(const Sight& sight) const;

  const LwnxSettings& settings_;
  LwnxReading last_;
  std::uint32_t misses_ = 0;
  std::vector<double> ranges_m_;  // oldest first
};

/// The data of ID 44 (cm, decimetres on the GRF-500) for a reading: the fields of the product that `bits`
/// selects, in their order.
void pack_cm(const LwnxProduct& product, std::uint64_t bits, const LwnxReading& reading,
             const LwnxReader::Recent& recent, std::vector<std::uint8_t>& data);

/// The data of ID 45 (mm): the same fields in four bytes each, or on the GRF-500 five pairs of distance and
/// strength, of which the first is the echo, and the temperature.
void pack_mm(const LwnxProduct& product, std::uint64_t bits, const LwnxReading& reading,
             const LwnxReader::Recent& recent, std::vector<std::uint8_t>& data);

/// A distance word of ID 40 or 44: `no_return` when there is none or it does not fit into `bytes` bytes.
struct LwnxUnit {
  double units_per_m = 100.0;
  std::uint8_t bytes = 2;
  std::int64_t no_return = -1;
};
[[nodiscard]] std::int64_t distance_word(const LwnxReading& reading, double range_m, const LwnxUnit& unit);

}  // namespace slamsensor::tools
