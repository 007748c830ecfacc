#include "core/slam.hpp"

namespace slamsensor::core {

Slam::Slam(Arena& arena, const Config& config) noexcept
    : detector_(arena, config.detection, config.capacities), hypotheses_(arena, config) {
}

void Slam::add_scanline(std::span<const Reading> scanline) noexcept {
  detector_.add_scanline(scanline);
}

Fix Slam::finish_scan(const ScanTime& time, const Deadline& deadline) noexcept {
  scan_landmarks_ = detector_.finish();
  return process(scan_landmarks_, time, deadline);
}

Fix Slam::process(std::span<const ScanLandmark> landmarks, const ScanTime& time,
                  const Deadline& deadline) noexcept {
  Fix fix = hypotheses_.process(landmarks, deadline);
  fix.time = time;
  return fix;
}

Arena::Plan plan_memory(const Config& config, std::size_t& bytes) noexcept {
  Arena arena;
  const Slam measured(arena, config);
  bytes = arena.bytes_used();
  return arena.plan();
}

}  // namespace slamsensor::core
