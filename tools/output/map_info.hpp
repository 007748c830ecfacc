#pragma once

#include "firmware/store/map_file.hpp"
#include "tools/output/map_csv.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// What a map file holds, a line per matter, for people: name, times, counts, extent, method, datum.
/// `bytes` is the size of the file.
[[nodiscard]] std::string map_info_text(const firmware::MapFile& map, std::size_t bytes);

/// Its landmarks as rows of map.csv.
[[nodiscard]] std::vector<MapRow> map_rows(const firmware::MapFile& map);

}  // namespace slamsensor::tools
