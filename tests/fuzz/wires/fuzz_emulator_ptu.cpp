#include "tools/emulator/ptu/ascii_command.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace {

using namespace slamsensor::tools;  // NOLINT(google-build-using-namespace)

void require(bool promise) {
  if (!promise) {
    __builtin_trap();
  }
}

void check(const PtuUnit& unit, slamsensor::hal::Stamp now) {
  for (const PtuAxisId id : {PtuAxisId::Pan, PtuAxisId::Tilt}) {
    require(std::isfinite(unit.head.axis(id).speed(now)));
    require(std::isfinite(unit.head.axis(id).truth_arcsec(now)));
  }
}

}  // namespace

// The first byte picks the unit. Then come commands up to a space each. Whatever they say, the unit answers
// with text and its axes stay somewhere.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  static const PtuSettings kD46 = ptu_settings(PtuKind::D46_17_5);
  static const PtuSettings kD300E = ptu_settings(PtuKind::D300E);
  const PtuSettings& settings = (data[0] & 1U) == 0 ? kD46 : kD300E;
  PtuUnit unit(settings, 1);
  slamsensor::hal::Stamp now = std::chrono::seconds(1);
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (std::size_t at = 1; at < size;) {
    now += std::chrono::milliseconds(20);
    const std::size_t end = std::min(text.find(' ', at), size);
    if (end > at) {
      static_cast<void>(obey_ascii(unit, text.substr(at, end - at), now));
    }
    at = end + 1;
    check(unit, now);
  }
  return 0;
}
