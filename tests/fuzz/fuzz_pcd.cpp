#include "tools/input/pcd.hpp"
#include "tools/input/scan_source.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>

namespace {

void require(bool promise) {
  if (!promise) {
    __builtin_trap();
  }
}

void check_scanline(const std::vector<slamsensor::core::Reading>& scanline) {
  double before_rad = 0.0;
  for (const auto& reading : scanline) {
    require(reading.pan_rad >= before_rad && reading.pan_rad < 2.0 * std::numbers::pi);
    require(std::abs(reading.tilt_rad) <= std::numbers::pi / 2.0);
    require(!reading.has_return() || reading.range_m <= slamsensor::tools::kInputReach_m * (1.0 + 1e-12));
    before_rad = reading.pan_rad;
  }
}

}  // namespace

// Any bytes either give a cloud whose scanlines keep what they promise, or a message.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto cloud = slamsensor::tools::parse_pcd(bytes, "fuzz");
  if (!cloud) {
    require(!cloud.error().message.empty());
    return 0;
  }
  // Wide columns: a file of many rings then costs little, and the empty ones are made all the same.
  constexpr double kBearingStep_rad = 0.1;
  const auto scanlines = slamsensor::tools::scanlines_of_cloud(*cloud, {}, kBearingStep_rad, "fuzz");
  require(scanlines.has_value());
  for (const auto& scanline : *scanlines) {
    check_scanline(scanline);
  }
  return 0;
}
