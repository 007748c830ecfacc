#include "firmware/lcm/scan_message.hpp"

#include "firmware/lcm/chunks.hpp"

namespace slamsensor::firmware {

bool is_sound(const ScanMessage& message) noexcept {
  return is_sound_chunk<kScanChunkLandmarks>(message);
}

std::uint32_t scan_chunks(const ScanView& scan) noexcept {
  return chunks_of<kScanChunkLandmarks>(scan.landmarks.size());
}

std::size_t encode_scan_chunk(const ScanView& scan, std::uint32_t chunk,
                              std::span<std::uint8_t> out) noexcept {
  ScanMessage message;
  if (!number_chunk<kScanChunkLandmarks>(scan.landmarks.size(), chunk, message)) {
    return 0;
  }
  message.utime = scan.time.middle_utc.count() / 1000;
  message.initialization = static_cast<std::int64_t>(scan.initialization);
  message.scan = scan.scan;
  message.scan_start_utc_ns = scan.time.start_utc.count();
  message.scan_middle_utc_ns = scan.time.middle_utc.count();
  message.scan_end_utc_ns = scan.time.end_utc.count();
  message.scan_end_monotonic_ns = scan.time.end_monotonic.count();
  const std::size_t first = chunk * kScanChunkLandmarks;
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.count); ++i) {
    const core::ScanLandmark& landmark = scan.landmarks[first + i];
    message.x_m[i] = landmark.position_L.x();
    message.y_m[i] = landmark.position_L.y();
    message.weight[i] = landmark.weight;
  }
  return encode_lcm(message, out);
}

core::ScanTime scan_time_of(const ScanMessage& message) noexcept {
  return {std::chrono::nanoseconds(message.scan_start_utc_ns),
          std::chrono::nanoseconds(message.scan_middle_utc_ns),
          std::chrono::nanoseconds(message.scan_end_utc_ns),
          std::chrono::nanoseconds(message.scan_end_monotonic_ns)};
}

}  // namespace slamsensor::firmware
