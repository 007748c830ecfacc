#include "core/mapping/pruning.hpp"

#include "core/geometry/convex_hull.hpp"
#include "core/limits.hpp"

namespace slamsensor::core {
namespace {

/// Whether `p` lies inside the convex polygon `corners` (counter-clockwise).
bool inside(const Point2& p, std::span<const Point2> corners) noexcept {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point2 side = corners[(i + 1) % corners.size()] - corners[i];
    const Point2 to = p - corners[i];
    if (side.x() * to.y() - side.y() * to.x() < 0.0) {
      return false;
    }
  }
  return corners.size() >= 3;
}

}  // namespace

Pruning::Pruning(Arena& arena, const MappingConfig& config, const Capacities& capacities) noexcept
    : config_(config),
      corners_W_(arena, "mapping: view outline",
                 3 * (static_cast<std::size_t>(capacities.scan_landmarks) + 1)),
      drop_(arena, "mapping: pruned", capacities.map_landmarks) {
}

void Pruning::apply(const ScanInMap& scan, LandmarkMap& map) noexcept {
  if (config_.prune_share <= 0.0) {
    return;
  }
  const std::size_t points = scan.scan_L.size() + 1;
  SLAMSENSOR_ASSERT(corners_W_.try_resize(3 * points) && drop_.try_resize(map.size()));
  for (std::size_t i = 0; i < scan.scan_L.size(); ++i) {
    corners_W_[i] = scan.pose_W * scan.scan_L[i];
  }
  corners_W_[scan.scan_L.size()] = scan.pose_W.translation();
  const std::span<Point2> outline = corners_W_.span().subspan(points);
  const std::size_t corners = convex_hull(corners_W_.span().first(points), outline);
  for (std::uint32_t i = 0; i < map.size(); ++i) {
    MapLandmark& landmark = map.landmark(i);
    const bool seen = landmark.last_scan == scan.number;
    landmark.chances += seen || inside(map.positions_W()[i], outline.first(corners)) ? 1 : 0;
    drop_[i] = landmark.chances >= config_.prune_chances_min &&
               landmark.sightings < config_.prune_share * static_cast<double>(landmark.chances);
  }
  map.remove(drop_.span());
}

}  // namespace slamsensor::core
