#include "hal/rangefinder/lwnx_packet.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

// Whatever comes, a packet that is found can be written again from its parts, byte for byte, and lies in the
// stream where it is said to.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor::hal;  // NOLINT(google-build-using-namespace)
  RangeCounters counters;
  LwnxParser parser(counters);
  for (std::size_t i = 0; i < size; ++i) {
    parser.push(data[i]);
    while (const auto packet = parser.next()) {
      const auto access = (data[packet->begin + 1] & 1U) != 0 ? LwnxAccess::Write : LwnxAccess::Read;
      std::vector<std::uint8_t> again(kLwnxPacketMax);
      const std::size_t length = write_lwnx(packet->id, access, packet->data, again);
      const bool fits = packet->end <= i + 1 && packet->end - packet->begin == length;
      // The reserved bits of the flags are not in what the parser tells.
      if (!fits || packet->data.size() + 1 > kLwnxPayloadMax || data[packet->begin] != kLwnxStart) {
        __builtin_trap();
      }
    }
  }
  return 0;
}
