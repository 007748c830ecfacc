#include "tools/input/scan_source.hpp"
#include "tools/input/text_files.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

// Any bytes either give scanlines within the promised bounds, or a message.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto scan = slamsensor::tools::parse_readings_csv(text, "fuzz");
  if (!scan) {
    return scan.error().message.empty() ? __builtin_trap(), 0 : 0;
  }
  for (const auto& scanline : scan->scanlines) {
    for (const auto& reading : scanline) {
      const bool range_kept = !reading.has_return() || reading.range_m <= slamsensor::tools::kInputReach_m;
      if (!range_kept || !(std::abs(reading.tilt_rad) < 1.6) || !(std::abs(reading.pan_rad) < 6.3)) {
        __builtin_trap();
      }
    }
    if (scanline.empty()) {
      __builtin_trap();
    }
  }
  return 0;
}
