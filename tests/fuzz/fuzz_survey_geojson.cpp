#include "core/graph/lattice.hpp"
#include "tools/map_files/survey_map.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

// Any bytes either give a survey, whose map a map file can hold, or a message.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto survey = slamsensor::tools::parse_survey_geojson(text, "fuzz");
  if (!survey) {
    return survey.error().message.empty() ? __builtin_trap(), 0 : 0;
  }
  if (survey->points.empty()) {
    __builtin_trap();
  }
  auto made = slamsensor::tools::map_of_survey(*survey, "fuzz", {});
  if (!made) {
    return 0;
  }
  made->map.about.name = "fuzz";
  const auto bytes = slamsensor::firmware::encode_map(made->map.about, made->map.state());
  if (!slamsensor::firmware::decode_map(bytes, slamsensor::firmware::unlimited_capacities())) {
    __builtin_trap();
  }
  return 0;
}
