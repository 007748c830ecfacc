#include "core/slam.hpp"

#include <algorithm>

namespace slamsensor::core {

Slam::Slam(Arena& arena, const Config& config) noexcept
    : detector_(arena, config.detection, config.capacities) {
  if (config.acceptance.rule == AcceptanceRule::Paper) {
    paper_.emplace(arena, config);
  } else {
    atlas_.emplace(arena, config);
  }
}

void Slam::add_scanline(std::span<const Reading> scanline) noexcept {
  detector_.add_scanline(scanline);
}

Fix Slam::finish_scan(const ScanTime& time, const Deadline& deadline) noexcept {
  scan_landmarks_ = detector_.finish();
  return process(scan_landmarks_, detector_.view(), time, deadline);
}

Fix Slam::process(std::span<const ScanLandmark> landmarks, const ScanView& view, const ScanTime& time,
                  const Deadline& deadline) noexcept {
  Fix fix = atlas_ ? atlas_->process(landmarks, view, deadline) : paper_->process(landmarks, deadline);
  fix.time = time;
  return fix;
}

void Slam::reset() noexcept {
  if (atlas_) {
    atlas_->reset();
  } else {
    paper_->reset();
  }
}

MapCheck Slam::restore(const MapState& state) noexcept {
  return atlas_ ? atlas_->restore(state) : paper_->restore(state);
}

void Slam::drop_rivals() noexcept {
  if (paper_) {
    paper_->drop_rivals();
  }
}

void Slam::set_frozen(Frozen frozen) noexcept {
  if (atlas_) {
    atlas_->set_frozen(frozen);
  } else {
    paper_->set_frozen(frozen);
  }
}

MapState Slam::copy_map(const MapRoom& room) const noexcept {
  if (atlas_) {
    return atlas_->copy_home(room);
  }
  MapState state = paper_->state();
  const auto copy = [](auto from, auto to) {
    const std::size_t count = std::min(from.size(), to.size());
    std::copy_n(from.begin(), count, to.begin());
    return to.first(count);
  };
  state.landmarks = copy(state.landmarks, room.landmarks);
  state.positions_W = copy(state.positions_W, room.positions_W);
  state.path = copy(state.path, room.path);
  return state;
}

MapsSummary Slam::maps() const noexcept {
  MapsSummary summary;
  if (paper_) {
    summary.hypotheses = static_cast<std::uint32_t>(paper_->size());
    summary.home_landmarks = paper_->empty() ? 0 : paper_->best().map.size();
    return summary;
  }
  for (const MapEntry& map : atlas_->maps()) {
    if (&map == atlas_->home()) {
      summary.home_landmarks = map.landmarks;
      ++summary.hypotheses;
    } else if (map.number != 0) {
      ++summary.local_maps;
      summary.local_landmarks += map.landmarks;
      summary.hypotheses += static_cast<std::uint32_t>(map.places.size());
    }
  }
  return summary;
}

Arena::Plan plan_memory(const Config& config, std::size_t& bytes) noexcept {
  Arena arena;
  const Slam measured(arena, config);
  bytes = arena.bytes_used();
  return arena.plan();
}

}  // namespace slamsensor::core
