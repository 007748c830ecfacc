#include "core/graph/delaunay.hpp"
#include "tools/input/text_files.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

// Any bytes either give landmarks that a map can take, or a message.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto rows = slamsensor::tools::parse_map_csv(text, "fuzz");
  if (!rows) {
    return 0;
  }
  for (const auto& row : *rows) {
    if (row.id < 0 || !(row.position_W.cwiseAbs().maxCoeff() <= slamsensor::core::kLatticeReach_m)) {
      __builtin_trap();
    }
  }
  return 0;
}
