#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace slamsensor::firmware {

/// Most landmarks that a list in chunks can have; more are not sent.
inline constexpr std::size_t kChunkedLandmarksMax = 100'000'000;

/// Messages for `landmarks` at `kPerChunk` each; one for none at all, so that a reader hears of it.
template <std::size_t kPerChunk>
[[nodiscard]] constexpr std::uint32_t chunks_of(std::size_t landmarks) noexcept {
  const std::size_t sent = std::min(landmarks, kChunkedLandmarksMax);
  return static_cast<std::uint32_t>(std::max<std::size_t>(1, (sent + kPerChunk - 1) / kPerChunk));
}

/// Sets landmarks, chunk, chunks and count of `message`; false when there is no chunk of that number.
template <std::size_t kPerChunk, typename Message>
[[nodiscard]] constexpr bool number_chunk(std::size_t landmarks, std::uint32_t chunk,
                                          Message& message) noexcept {
  const std::uint32_t chunks = chunks_of<kPerChunk>(landmarks);
  if (chunk >= chunks) {
    return false;
  }
  const std::size_t sent = std::min(landmarks, kChunkedLandmarksMax);
  message.landmarks = static_cast<std::int32_t>(sent);
  message.chunk = static_cast<std::int32_t>(chunk);
  message.chunks = static_cast<std::int32_t>(chunks);
  message.count = static_cast<std::int32_t>(std::min(kPerChunk, sent - chunk * kPerChunk));
  return true;
}

/// Whether `message` is numbered as number_chunk does it.
template <std::size_t kPerChunk, typename Message>
[[nodiscard]] constexpr bool is_sound_chunk(const Message& message) noexcept {
  Message expected;
  return message.landmarks >= 0 && message.chunk >= 0 &&
         static_cast<std::size_t>(message.landmarks) <= kChunkedLandmarksMax &&
         number_chunk<kPerChunk>(static_cast<std::size_t>(message.landmarks),
                                 static_cast<std::uint32_t>(message.chunk), expected) &&
         message.chunks == expected.chunks && message.count == expected.count;
}

}  // namespace slamsensor::firmware
