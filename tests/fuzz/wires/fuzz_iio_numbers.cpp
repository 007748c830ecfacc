#include "hal/inclination/iio_accelerometer.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

// Whatever a file holds, a number is finite and a mount matrix keeps lengths.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto number = slamsensor::hal::parse_iio_number(text); number && !std::isfinite(*number)) {
    __builtin_trap();
  }
  if (const auto matrix = slamsensor::hal::parse_mount_matrix(text)) {
    const double length =
        std::hypot((*matrix)[0] + (*matrix)[1] + (*matrix)[2], (*matrix)[3] + (*matrix)[4] + (*matrix)[5],
                   (*matrix)[6] + (*matrix)[7] + (*matrix)[8]);
    if (!(std::abs(length - std::sqrt(3.0)) < 0.1)) {
      __builtin_trap();
    }
  }
  return 0;
}
