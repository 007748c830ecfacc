#include "core/localizer.hpp"

#include "core/association/associate.hpp"

#include <algorithm>

namespace slamsensor::core {

Localizer::Localizer(Arena& arena, const Config& config) noexcept
    : config_(config),
      map_(arena, config.capacities),
      delaunay_(arena, config.capacities.map_landmarks),
      search_(arena, config.association, config.capacities) {
}

bool Localizer::set_map(std::span<const Point2> map_W) noexcept {
  map_.clear();
  for (const Point2& p : map_W) {
    MapLandmark landmark;
    landmark.id = map_.size();
    if (!on_lattice(p) || !map_.try_add(landmark, p)) {
      map_.clear();
      break;
    }
  }
  map_.rebuild_index(delaunay_, config_.association);
  return map_.size() == map_W.size();
}

Fix Localizer::locate(std::span<const Point2> scan_L, const Deadline& deadline) noexcept {
  Fix fix;
  fix.landmarks_seen = static_cast<std::uint32_t>(scan_L.size());
  fix.landmarks_in_map = map_.size();
  scan_L = scan_L.first(std::min<std::size_t>(scan_L.size(), config_.capacities.scan_landmarks));
  if (scan_L.size() < std::max(3U, config_.association.landmarks_min)) {
    fix.reason = FixReason::TooFewLandmarks;
    return fix;
  }
  const MapView map = map_.view();
  const Verdict verdict = associate(scan_L, map, config_, deadline, search_, found_);
  describe(verdict, found_, 0, scan_L, map, config_, fix);
  return fix;
}

}  // namespace slamsensor::core
