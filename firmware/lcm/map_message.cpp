#include "firmware/lcm/map_message.hpp"

#include "firmware/lcm/chunks.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

std::int32_t clamped(std::uint32_t value) noexcept {
  return static_cast<std::int32_t>(std::min<std::uint32_t>(value, INT32_MAX));
}

std::size_t landmarks_in(const LcmMapView& map) noexcept {
  return std::min(map.landmarks.size(), map.positions_W.size());
}

}  // namespace

bool is_sound(const MapMessage& message) noexcept {
  return is_sound_chunk<kMapChunkLandmarks>(message);
}

std::uint32_t map_chunks(const LcmMapView& map) noexcept {
  return chunks_of<kMapChunkLandmarks>(landmarks_in(map));
}

std::size_t encode_map_chunk(const LcmMapView& map, std::uint32_t chunk,
                             std::span<std::uint8_t> out) noexcept {
  MapMessage message;
  if (!number_chunk<kMapChunkLandmarks>(landmarks_in(map), chunk, message)) {
    return 0;
  }
  message.utime = map.utc.count() / 1000;
  message.initialization = static_cast<std::int64_t>(map.initialization);
  message.revision = static_cast<std::int64_t>(map.revision);
  const std::size_t first = chunk * kMapChunkLandmarks;
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.count); ++i) {
    const core::MapLandmark& landmark = map.landmarks[first + i];
    message.id[i] = landmark.id;
    message.x_m[i] = map.positions_W[first + i].x();
    message.y_m[i] = map.positions_W[first + i].y();
    message.xi[i] = clamped(landmark.xi);
    message.sightings[i] = clamped(landmark.sightings);
    message.last_scan[i] = clamped(landmark.last_scan);
  }
  return encode_lcm(message, out);
}

}  // namespace slamsensor::firmware
