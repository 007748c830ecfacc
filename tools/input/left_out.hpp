#pragma once

#include "tools/input/scan_source.hpp"

#include <cstddef>
#include <cstdint>
#include <string>

namespace slamsensor::tools {

/// What scans held that was not used, counted over a run.
struct LeftOut {
  std::uint64_t landmarks_beyond_max = 0;  ///< of lists longer than detection.landmarks_max
  std::uint64_t scans_beyond_max = 0;      ///< those lists
  std::size_t landmarks_most = 0;          ///< in the longest of them
  std::uint64_t landmarks_at_one_place = 0;
  std::uint64_t zero_ranges = 0;  ///< readings of 0 m or less

  void see(const InputScan& scan);
  /// A list of which `used` landmarks were used and `beyond_max` were too many.
  void see_list(std::size_t used, std::size_t beyond_max);
  void add(const LeftOut& other);

  /// For a summary: a line per kind, each with its number and what can be done; empty when nothing was left
  /// out.
  [[nodiscard]] std::string text() const;
};

}  // namespace slamsensor::tools
