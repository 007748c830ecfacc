#include "tools/emulator/rangefinder/emulated_point_laser.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

// Lines of commands. Whatever they set, the laser measures at a rate that there can be.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamsensor::tools;  // NOLINT(google-build-using-namespace)
  static const PointSettings kLds70a = lds70a_settings();
  PointCommands commands(kLds70a);
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\r'), rest.size());
    static_cast<void>(commands.run(rest.substr(0, end)));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const double rate_hz = commands.rate_hz(kLds70a.baud);
    if (!(std::isfinite(rate_hz) && rate_hz > 0.0)) {
      __builtin_trap();
    }
  }
  return 0;
}
