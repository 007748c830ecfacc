#pragma once

#include "firmware/store/map_file.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <string>

namespace slamsensor::tools {

/// What other programs read.
enum class ExportFormat : std::uint8_t { GeoJson, Csv, Gpx, Kml };

/// The landmarks of `map` (id, xi, sightings, scans, place) and its path as the text of a file. With
/// `map.about.datum` the places are WGS 84. Without it GeoJSON and CSV hold metres in the map's frame and say
/// so, and the others, which know only latitude and longitude, are refused with what to do.
[[nodiscard]] tl::expected<std::string, std::string> export_map(const firmware::MapFile& map,
                                                                ExportFormat format);

}  // namespace slamsensor::tools
