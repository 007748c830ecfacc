#pragma once

#include "core/geometry/pose2.hpp"
#include "tools/output/write_file.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace slamsensor::tools {

/// A landmark of the map as map.csv holds it.
struct MapRow {
  std::uint64_t id = 0;
  core::Point2 position_W = core::Point2::Zero();  ///< m
  std::uint32_t xi = 0;                            ///< triangulations between it and the origin
  std::uint32_t sightings = 0;                     ///< scans that matched it, the one that found it included
  std::int64_t first_scan = 0;
  std::int64_t last_scan = 0;
};

/// The whole of map.csv: the heading `id,x_m,y_m,xi,sightings,first_scan,last_scan` and a line per row, in
/// the order given, metres with 6 decimals.
[[nodiscard]] std::string format_map(std::span<const MapRow> rows);

/// `path` holds `format_map(rows)`, or is as it was and the error says why.
[[nodiscard]] tl::expected<void, OutputError> write_map(const std::filesystem::path& path,
                                                        std::span<const MapRow> rows);

}  // namespace slamsensor::tools
