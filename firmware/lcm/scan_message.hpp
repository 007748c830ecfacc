#pragma once

#include "core/fix.hpp"
#include "core/landmark.hpp"
#include "firmware/lcm/message.hpp"

namespace slamsensor::firmware {

/// Landmarks in one slamsensor.scan_t.
inline constexpr std::size_t kScanChunkLandmarks = 50;

/// slamsensor.scan_t (types/slamsensor_scan_t.lcm): a share of the landmarks of one scan, in the sensor
/// frame. All of them, in the order of the chunks, are what core::Slam::process was given.
struct ScanMessage {
  std::int64_t utime = 0;
  std::int64_t initialization = 0;
  std::int64_t scan = 0;
  std::int64_t scan_start_utc_ns = 0;
  std::int64_t scan_middle_utc_ns = 0;
  std::int64_t scan_end_utc_ns = 0;
  std::int64_t scan_end_monotonic_ns = 0;
  std::int32_t landmarks = 0;
  std::int32_t chunk = 0;
  std::int32_t chunks = 1;
  std::int32_t count = 0;
  std::array<double, kScanChunkLandmarks> x_m{};
  std::array<double, kScanChunkLandmarks> y_m{};
  std::array<double, kScanChunkLandmarks> weight{};

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("initialization", m.initialization);
    visit("scan", m.scan);
    visit("scan_start_utc_ns", m.scan_start_utc_ns);
    visit("scan_middle_utc_ns", m.scan_middle_utc_ns);
    visit("scan_end_utc_ns", m.scan_end_utc_ns);
    visit("scan_end_monotonic_ns", m.scan_end_monotonic_ns);
    visit("landmarks", m.landmarks);
    visit("chunk", m.chunk);
    visit("chunks", m.chunks);
    visit("count", m.count);
    visit("x_m", m.x_m);
    visit("y_m", m.y_m);
    visit("weight", m.weight);
  }
};

/// Whether chunk numbers and counts agree: `count` is what chunk `chunk` of `landmarks` landmarks holds.
[[nodiscard]] bool is_sound(const ScanMessage& message) noexcept;

/// A scan to be sent.
struct ScanView {
  std::uint64_t initialization = 0;  ///< FixReport::initialization
  std::uint32_t scan = 0;            ///< Fix::scan
  core::ScanTime time;
  std::span<const core::ScanLandmark> landmarks;
};

/// Messages that a scan takes: at least one, even without landmarks.
[[nodiscard]] std::uint32_t scan_chunks(const ScanView& scan) noexcept;

/// Writes chunk number `chunk` (from 0, below scan_chunks) into `out` and returns its length; 0 when there is
/// no such chunk or it does not fit.
[[nodiscard]] std::size_t encode_scan_chunk(const ScanView& scan, std::uint32_t chunk,
                                            std::span<std::uint8_t> out) noexcept;

/// When the scan of a sound `message` was made.
[[nodiscard]] core::ScanTime scan_time_of(const ScanMessage& message) noexcept;

}  // namespace slamsensor::firmware
