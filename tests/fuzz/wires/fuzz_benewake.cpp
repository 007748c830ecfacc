#include "hal/rangefinder/benewake_frame.hpp"

#include <cstddef>
#include <cstdint>

// Whatever comes, a reading ends where the parser stands or before, and a reply is a whole command frame.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor::hal;  // NOLINT(google-build-using-namespace)
  RangeCounters counters;
  BenewakeParser parser(counters);
  for (std::size_t i = 0; i < size; ++i) {
    const auto found = parser.push(data[i]);
    if (found.has_reading && (parser.reading_end() < 9 || parser.reading_end() > i + 1)) {
      __builtin_trap();
    }
    if (found.has_reply && !is_benewake_command(parser.reply())) {
      __builtin_trap();
    }
  }
  return 0;
}
