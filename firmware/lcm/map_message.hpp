#pragma once

#include "core/mapping/landmark_map.hpp"
#include "firmware/lcm/message.hpp"
#include "hal/stamp.hpp"

namespace slamsensor::firmware {

/// Landmarks in one slamsensor.map_t.
inline constexpr std::size_t kMapChunkLandmarks = 36;

/// slamsensor.map_t (types/slamsensor_map_t.lcm): a share of the landmarks of the map, in the map frame.
/// Chunks of one `initialization` and `revision` belong together.
struct MapMessage {
  std::int64_t utime = 0;
  std::int64_t initialization = 0;
  std::int64_t revision = 0;
  std::int32_t landmarks = 0;
  std::int32_t chunk = 0;
  std::int32_t chunks = 1;
  std::int32_t count = 0;
  std::array<std::int64_t, kMapChunkLandmarks> id{};
  std::array<double, kMapChunkLandmarks> x_m{};
  std::array<double, kMapChunkLandmarks> y_m{};
  std::array<std::int32_t, kMapChunkLandmarks> xi{};
  std::array<std::int32_t, kMapChunkLandmarks> sightings{};
  std::array<std::int32_t, kMapChunkLandmarks> last_scan{};

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("initialization", m.initialization);
    visit("revision", m.revision);
    visit("landmarks", m.landmarks);
    visit("chunk", m.chunk);
    visit("chunks", m.chunks);
    visit("count", m.count);
    visit("id", m.id);
    visit("x_m", m.x_m);
    visit("y_m", m.y_m);
    visit("xi", m.xi);
    visit("sightings", m.sightings);
    visit("last_scan", m.last_scan);
  }
};

/// Whether chunk numbers and counts agree: `count` is what chunk `chunk` of `landmarks` landmarks holds.
[[nodiscard]] bool is_sound(const MapMessage& message) noexcept;

/// A map to be sent; both lists have the same length.
struct LcmMapView {
  hal::Stamp utc{};                  ///< when the lists were copied
  std::uint64_t initialization = 0;  ///< FixReport::initialization
  std::uint64_t revision = 0;        ///< SlamStatus::map_revision
  std::span<const core::MapLandmark> landmarks;
  std::span<const core::Point2> positions_W;
};

/// Messages that a map takes: at least one, even when it is empty.
[[nodiscard]] std::uint32_t map_chunks(const LcmMapView& map) noexcept;

/// Writes chunk number `chunk` (from 0, below map_chunks) into `out` and returns its length; 0 when there is
/// no such chunk or it does not fit.
[[nodiscard]] std::size_t encode_map_chunk(const LcmMapView& map, std::uint32_t chunk,
                                           std::span<std::uint8_t> out) noexcept;

}  // namespace slamsensor::firmware
