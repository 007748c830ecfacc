#include "hal/rangefinder/benewake_frame.hpp"
#include "hal/rangefinder/range_driver.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

// The data of CAN frames, a byte before each tells the size and the model. Whatever they are, a distance is
// finite, positive and within the configured range, nothing but a return has one, and a reply is whole.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor::hal;  // NOLINT(google-build-using-namespace)
  const RangeConfig range = {.range_max_m = 180.0, .weak_below = 40.0};
  std::span<const std::uint8_t> rest(data, size);
  while (!rest.empty()) {
    const std::size_t length = std::min<std::size_t>({rest[0] % 9U, rest.size() - 1, 8U});
    const BenewakeProduct& product = benewake_product(static_cast<BenewakeModel>(rest[0] / 9U % 5U));
    const auto frame = rest.subspan(1, length);
    rest = rest.subspan(1 + length);
    const auto reply = benewake_reply_in(frame);
    if (!reply.empty() && (reply.size() != reply[1] || reply.size() > frame.size())) {
      __builtin_trap();
    }
    const auto reading = read_benewake_can(frame);
    if (reading.has_value() != (frame.size() >= 4)) {
      __builtin_trap();
    }
    if (!reading) {
      continue;
    }
    const Measurement out = judged(measured(*reading, product, 18000), Strength::Known, range);
    const bool is_distance = std::isfinite(out.range_m) && out.range_m > 0.0 && out.range_m <= 180.0;
    if (out.echo == Echo::Return ? !is_distance || out.strength < 40.0 : out.range_m != 0.0) {
      __builtin_trap();
    }
  }
  return 0;
}
