#include "hal/rangefinder/point_laser.hpp"
#include "hal/rangefinder/point_record.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

// The first byte picks the layout. Whatever comes, a distance is finite, positive and within the configured
// range, and nothing but a return has one.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor::hal;  // NOLINT(google-build-using-namespace)
  if (size == 0) {
    return 0;
  }
  std::array<PointLaserConfig, 4> configs = {astech_lds70a(), mdl_laserace_im_hr_unverified(),
                                             astech_lds70a(), astech_lds70a()};
  configs[2].record = PointRecord::AsciiHex;
  configs[3].record = PointRecord::Packed7;
  const PointLaserConfig& config = configs[data[0] % configs.size()];
  RangeCounters counters;
  const auto records = make_point_records(config, counters);
  for (std::size_t i = 1; i < size; ++i) {
    if (!records->push(data[i])) {
      continue;
    }
    const Measurement& reading = records->reading();
    const bool is_return = reading.echo == Echo::Return;
    const bool is_distance = std::isfinite(reading.range_m) && reading.range_m > 0.0 &&
                             reading.range_m <= config.range.range_max_m;
    if (is_return ? !is_distance : reading.range_m != 0.0) {
      __builtin_trap();
    }
    if (records->begin() > records->end() || records->end() > i) {
      __builtin_trap();
    }
  }
  return 0;
}
