#include "tools/input/text_files.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>

// Any bytes either give a trajectory by increasing time with finite poses, or a message.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto poses = slamsensor::tools::parse_tum(text, "fuzz");
  if (!poses) {
    return 0;
  }
  for (std::size_t i = 0; i < poses->size(); ++i) {
    const auto& [t, pose] = (*poses)[i];
    const bool later = i == 0 || t > (*poses)[i - 1].t;
    const bool finite = std::isfinite(pose.x_m) && std::isfinite(pose.y_m);
    if (!later || !finite || !(std::abs(pose.heading_rad) <= std::numbers::pi)) {
      __builtin_trap();
    }
  }
  return 0;
}
