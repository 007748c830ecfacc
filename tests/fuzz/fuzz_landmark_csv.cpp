#include "tools/input/scan_source.hpp"
#include "tools/input/text_files.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

// Any bytes either give a list whose selection keeps what it promises, or a message.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  static_cast<void>(slamsensor::tools::csv_kind(text));
  const auto list = slamsensor::tools::parse_landmark_csv(text, "fuzz");
  if (!list) {
    return 0;
  }
  using slamsensor::firmware::LandmarkOrder;
  const slamsensor::core::DetectionConfig detection;
  for (const auto order : {LandmarkOrder::Weight, LandmarkOrder::Diameter, LandmarkOrder::Nearest}) {
    const auto landmarks =
        slamsensor::tools::select_landmarks(list->rows, {order, 0.0, 0.0}, detection).landmarks;
    if (landmarks.size() > detection.listed_most()) {
      __builtin_trap();
    }
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const bool heaviest_first = i == 0 || landmarks[i].weight <= landmarks[i - 1].weight;
      if (!heaviest_first || !(landmarks[i].position_L.norm() <= detection.range_max_m)) {
        __builtin_trap();
      }
    }
  }
  return 0;
}
