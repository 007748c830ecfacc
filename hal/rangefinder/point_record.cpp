#include "hal/rangefinder/point_record.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

constexpr unsigned kStreakMost = 1000;

}  // namespace

PointRecords::PointRecords(const PointLaserConfig& config, RangeCounters& counters)
    : counters_(counters),
      range_(config.range),
      unit_m_(config.unit_m),
      offset_m_(config.offset_m),
      codes_count_(std::min(config.codes.size(), kPointCodesMax)) {
  std::copy_n(config.codes.begin(), codes_count_, codes_.begin());
}

bool PointRecords::push(std::uint8_t byte) noexcept {
  ++position_;
  switch (take(byte)) {
    case Outcome::Nothing:
      return false;
    case Outcome::Unsound:
      if (streak_ >= streak_needed()) {
        counters_.count(RangeEvent::LocksLost);
      }
      streak_ = 0;
      return false;
    case Outcome::Sound:
      break;
  }
  streak_ = std::min(streak_ + 1, kStreakMost);
  if (streak_ < streak_needed()) {
    counters_.count(RangeEvent::ReadingsWithheld);
    return false;
  }
  return true;
}

void PointRecords::interrupt() noexcept {
  if (forget()) {
    streak_ = 0;
  }
}

void PointRecords::accept(const Measurement& raw, Strength strength, std::size_t bytes,
                          std::size_t bytes_after) noexcept {
  reading_ = judged(raw, strength, range_);
  end_ = position_ - bytes_after;
  begin_ = end_ - bytes;
}

Measurement PointRecords::measured(std::int64_t number, double scale) const noexcept {
  Measurement out;
  for (std::size_t i = 0; i < codes_count_; ++i) {
    if (codes_[i].number == number) {
      out.echo = codes_[i].echo;
      return out;
    }
  }
  out.range_m = static_cast<double>(number) * scale * unit_m_ + offset_m_;
  // What the device itself calls nothing must not become something by the offset.
  out.echo = number > 0 ? Echo::Return : Echo::None;
  return out;
}

bool PointRecords::is_plausible(std::int64_t number) const noexcept {
  const Measurement raw = measured(number, 1.0);
  return raw.echo != Echo::Return || (raw.range_m > 0.0 && raw.range_m <= range_.range_max_m);
}

}  // namespace slamsensor::hal
