#pragma once

#include "firmware/store/map_file.hpp"

#include <charconv>
#include <cstdint>
#include <string_view>
#include <vector>

namespace slamsensor::tests {

using Bytes = std::vector<std::uint8_t>;

inline Bytes from_hex(std::string_view hex) {
  Bytes bytes(hex.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::from_chars(hex.data() + 2 * i, hex.data() + 2 * i + 2, bytes[i], 16);
  }
  return bytes;
}

inline core::MapLandmark sample_landmark(std::uint32_t id, std::uint32_t xi,
                                         std::array<std::uint32_t, 3> parents,
                                         std::array<std::uint32_t, 4> seen) {
  core::MapLandmark landmark;
  landmark.id = id;
  landmark.xi = xi;
  landmark.parents = parents;
  landmark.sightings = seen[0];
  landmark.chances = seen[1];
  landmark.first_scan = seen[2];
  landmark.last_scan = seen[3];
  return landmark;
}

/// A small sound map in which every field differs from its default: that of the golden files.
inline firmware::MapFile sample_map() {
  constexpr std::array<std::uint32_t, 3> kNone = core::MapLandmark{}.parents;
  firmware::MapFile map;
  map.about = {"orchard-7",
               1'767'225'600,
               1'795'439'109,
               12,
               firmware::Datum{59.3325, 18.0649, 28.5, 90.0},
               {0.5, 0.25, 0.009, 2, 30}};
  map.landmarks = {sample_landmark(0, 0, kNone, {21, 22, 0, 38}), sample_landmark(1, 0, kNone, {4, 4, 0, 3}),
                   sample_landmark(2, 0, kNone, {9, 30, 0, 37}),
                   sample_landmark(5, 1, {0, 1, 2}, {2, 3, 4, 39}),
                   sample_landmark(8, 2, {5, 2, 1}, {1, 1, 39, 39})};
  constexpr std::array<float, 5> kSigmas_m{0.0F, 0.0625F, 0.125F, 2.5F, 0.375F};
  for (std::size_t i = 0; i < kSigmas_m.size(); ++i) {
    map.landmarks[i].sigma_m = kSigmas_m[i];
  }
  map.landmarks[0].size = {-1.5F, 21.0F};
  map.landmarks[2].size = {0.75F, 8.0F};
  map.landmarks[3].size = {-0.125F, 1.0F};
  map.positions_W = {{1.5, -2.25}, {-7.125, 0.0}, {0.1, 12.7}, {-64000.0, 33.0}, {8.0, 8.5}};
  map.path = {{0, 0, {}}, {4, 1, {1.25, -0.5, -3.0}}, {39, 2, {2.5, 0.75, 3.125}}};
  map.numbers.weight = 5'000'000'019;
  map.numbers.landmarks_evicted = 3;
  map.numbers.path_thinnings = 1;
  map.numbers.next_id = 9;
  map.numbers.scans = 40;
  return map;
}

inline Bytes sample_bytes() {
  const firmware::MapFile map = sample_map();
  return firmware::encode_map(map.about, map.state());
}

/// A map that is `sample_map` with `weight`: enough to tell generations apart.
inline firmware::MapFile sample_map_of_weight(std::uint64_t weight) {
  firmware::MapFile map = sample_map();
  map.numbers.weight = weight;
  return map;
}

}  // namespace slamsensor::tests
