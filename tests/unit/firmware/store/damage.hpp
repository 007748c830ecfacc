#pragma once

#include "tests/unit/firmware/store/sample_map.hpp"

#include <functional>
#include <string>
#include <vector>

namespace slamsensor::tests {

/// A way to break a map file, and what is said of the result.
struct Damage {
  std::string name;
  std::function<Bytes()> make;
  std::string message;  ///< without the name of the file
};

/// Files that are cut, altered or not maps at all.
[[nodiscard]] std::vector<Damage> damaged_files();

/// Files that are whole, with checksums that hold, but lie of their lengths or hold what no map can.
[[nodiscard]] std::vector<Damage> lying_files();
[[nodiscard]] std::vector<Damage> flawed_maps();

// Where things stand in the bytes of the sample map.
inline constexpr std::size_t kInfoHead = 28;
inline constexpr std::size_t kInfo = 44;
inline constexpr std::size_t kLandHead = 176;
inline constexpr std::size_t kLand = 192;
inline constexpr std::size_t kPathHead = 512;
inline constexpr std::size_t kPath = 528;
inline constexpr std::size_t kEnd = 624;

}  // namespace slamsensor::tests
