#pragma once

#include "firmware/store/map_store.hpp"
#include "tests/unit/firmware/store/sample_map.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tests {

inline constexpr std::int64_t kNow_utc_s = 1'795'439'109;  // 2026-11-23T13:05:09Z

/// A folder and the store in it. Maps are told apart by their weight.
class StoreBench {
 public:
  [[nodiscard]] tl::expected<firmware::SavedMap, firmware::StoreError> save(std::uint64_t weight,
                                                                            std::string_view name = "m") {
    const firmware::MapFile map = sample_map_of_weight(weight);
    firmware::MapAbout about = map.about;
    about.name = name;
    return store.save(about, map.state(), kNow_utc_s);
  }
  /// Weight of the map that is loaded; 0 when none is.
  [[nodiscard]] std::uint64_t loaded_weight(std::string_view name = "m") const {
    const auto loaded = store.load(name);
    return loaded ? loaded->file.numbers.weight : 0;
  }
  [[nodiscard]] std::filesystem::path path(const std::string& file) const { return folder.path() / file; }
  [[nodiscard]] std::string content(const std::string& file) const {
    std::ifstream in(path(file), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// Names of all files but the lock, sorted.
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      if (entry.path().filename() != ".lock") {
        names.push_back(entry.path().filename().string());
      }
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  tools::TempFolder folder;
  firmware::MapStore store{folder.path(), core::Capacities{}};
};

}  // namespace slamsensor::tests
