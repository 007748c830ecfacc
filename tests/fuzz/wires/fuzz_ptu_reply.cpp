#include "hal/pantilt/ptu_reply.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

// Whatever comes, a line is no longer than the buffer, and a position read from it is within its bounds.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor::hal;  // NOLINT(google-build-using-namespace)
  PtuReplyParser parser;
  for (std::size_t i = 0; i < size; ++i) {
    const auto line = parser.push(data[i], Stamp(static_cast<Stamp::rep>(i)));
    if (!line) {
      continue;
    }
    if (line->payload.size() + line->echo.size() > kPtuLineMax) {
      __builtin_trap();
    }
    const auto position = ptu_position(line->payload);
    if (position && std::abs(*position) > 1'000'000) {
      __builtin_trap();
    }
  }
  return 0;
}
