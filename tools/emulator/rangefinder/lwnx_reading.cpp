#include "tools/emulator/rangefinder/lwnx_reading.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kWindow = 5;
constexpr std::int64_t kNoise = 12;
constexpr std::int64_t kTemperature = 2350;  // 1/100 degC

struct FieldSource {
  const LwnxReading& reading;
  const LwnxReader::Recent& recent;
  LwnxUnit unit;
};

std::int64_t field_word(LwnxField field, const FieldSource& source) {
  switch (field) {
    case LwnxField::Raw:
      return distance_word(source.reading, source.reading.range_m, source.unit);
    case LwnxField::Closest:
      return distance_word(source.reading, source.recent.closest_m, source.unit);
    case LwnxField::Median:
      return distance_word(source.reading, source.recent.median_m, source.unit);
    case LwnxField::Furthest:
      return distance_word(source.reading, source.recent.furthest_m, source.unit);
    case LwnxField::Strength:
      return source.reading.is_lost ? 0 : std::llround(source.reading.strength);
    case LwnxField::Noise:
      return kNoise;
    case LwnxField::Temperature:
      return kTemperature;
    case LwnxField::Yaw:
    case LwnxField::Alarm:
      return 0;
  }
  return 0;
}

void pack_fields(const LwnxProduct& product, std::uint64_t bits, const FieldSource& source,
                 std::vector<std::uint8_t>& data) {
  for (std::size_t bit = 0; bit < product.fields.size(); ++bit) {
    if ((bits >> bit & 1U) != 0) {
      append_little_endian(field_word(product.fields[bit], source), source.unit.bytes, data);
    }
  }
}

}  // namespace

std::int64_t distance_word(const LwnxReading& reading, double range_m, const LwnxUnit& unit) {
  const auto highest = (std::int64_t{1} << (8 * unit.bytes - 1)) - 1;
  const std::int64_t word = std::llround(range_m * unit.units_per_m);
  return reading.is_lost || word > highest ? unit.no_return : word;
}

double LwnxReader::strength_of(const Sight& sight) const {
  if (sight.kind == SightKind::Weak) {
    return settings_.weak_strength;
  }
  return sight.kind == SightKind::Saturated ? settings_.saturated_strength : settings_.strength.of(sight);
}

LwnxReading LwnxReader::read(const Sight& sight, const Setup& setup) {
  const bool is_miss = !sight.has_echo() || (sight.kind == SightKind::Weak && !setup.tells_strength);
  if (!is_miss) {
    misses_ = 0;
    last_ = {false, sight.range_m + setup.zero_offset_m, strength_of(sight)};
    if (ranges_m_.size() == kWindow) {
      ranges_m_.erase(ranges_m_.begin());
    }
    ranges_m_.push_back(last_.range_m);
    return last_;
  }
  ++misses_;
  const bool is_repeat = misses_ < setup.lost_counter ||
                         (misses_ == setup.lost_counter && settings_.lost_count == LwnxLostCount::Repeats);
  if (!is_repeat) {
    last_ = {};
    ranges_m_.clear();
  }
  return last_;
}

LwnxReader::Recent LwnxReader::recent(const LwnxReading& latest) const {
  if (ranges_m_.empty()) {
    return {latest.range_m, latest.range_m, latest.range_m};
  }
  std::vector<double> sorted = ranges_m_;
  std::ranges::sort(sorted);
  return {sorted.front(), sorted[sorted.size() / 2], sorted.back()};
}

void LwnxReader::clear() {
  last_ = {};
  misses_ = 0;
  ranges_m_.clear();
}

void pack_cm(const LwnxProduct& product, std::uint64_t bits, const LwnxReading& reading,
             const LwnxReader::Recent& recent, std::vector<std::uint8_t>& data) {
  const LwnxUnit unit{product.cm_units_per_m, product.cm_field_bytes, product.no_return};
  pack_fields(product, bits, {reading, recent, unit}, data);
}

void pack_mm(const LwnxProduct& product, std::uint64_t bits, const LwnxReading& reading,
             const LwnxReader::Recent& recent, std::vector<std::uint8_t>& data) {
  const LwnxUnit unit{1000.0, 4, product.no_return_mm};
  const FieldSource source{reading, recent, unit};
  if (product.mm_signals == 0) {
    pack_fields(product, bits, source, data);
    return;
  }
  for (std::uint8_t signal = 0; signal < product.mm_signals; ++signal) {
    const bool is_echo = signal == 0;
    append_little_endian(is_echo ? field_word(LwnxField::Raw, source) : unit.no_return, 4, data);
    append_little_endian(is_echo ? field_word(LwnxField::Strength, source) : 0, 4, data);
  }
  append_little_endian(kTemperature, 4, data);
}

}  // namespace slamsensor::tools
