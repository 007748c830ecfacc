#pragma once

#include "core/association/map_view.hpp"
#include "core/association/point_grid.hpp"
#include "core/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/graph/delaunay.hpp"
#include "core/graph/landmark_graph.hpp"
#include "core/landmark_size.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::core {

/// A landmark of a map.
struct MapLandmark {
  static constexpr std::uint32_t kNoParent = UINT32_MAX;

  std::uint32_t id = 0;  ///< unique within the hypothesis' history, increasing
  std::uint32_t xi = 0;  ///< positional error: triangulations between it and the origin
  std::array<std::uint32_t, 3> parents{kNoParent, kNoParent,
                                       kNoParent};  ///< ids that triangulated it; none at xi 0
  std::uint32_t sightings = 1;
  std::uint32_t chances =
      1;  ///< scans that could have seen it, sightings included; counted only when pruning is on
  std::uint32_t first_scan = 0;
  std::uint32_t last_scan = 0;
  float sigma_m =
      0.0F;  ///< 1 sigma of its place in the map's frame, along each axis; 0: not known, or surveyed
  LandmarkSize size{};
};

/// Index of the landmark with `id` among `landmarks`, which are sorted by id; none when it is not there.
[[nodiscard]] std::optional<std::uint32_t> find_landmark(std::span<const MapLandmark> landmarks,
                                                         std::uint32_t id) noexcept;

/// The landmarks of one hypothesis with the index that association searches. Sorted by id.
class LandmarkMap {
 public:
  LandmarkMap(Arena& arena, const Capacities& capacities) noexcept;

  /// False, and nothing changed, when the map is full.
  [[nodiscard]] bool try_add(const MapLandmark& landmark, const Point2& position_W) noexcept;

  /// Takes out the landmarks for which `drop[i]` holds; the others keep their order. `drop` has a flag per
  /// landmark.
  void remove(std::span<const bool> drop) noexcept;

  /// Index of the landmark with `id`; none when it has been removed.
  [[nodiscard]] std::optional<std::uint32_t> find(std::uint32_t id) const noexcept {
    return find_landmark(landmarks_.span(), id);
  }

  /// Brings graph and grid up to date with the positions; `view()` is valid until the next change.
  void rebuild_index(Delaunay& delaunay, const AssociationConfig& config) noexcept;

  /// Makes this map equal to `other` (same capacities), its index included.
  void copy_from(const LandmarkMap& other) noexcept;

  void clear() noexcept;

  [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(landmarks_.size()); }
  [[nodiscard]] bool full() const noexcept { return landmarks_.full(); }
  [[nodiscard]] MapLandmark& landmark(std::uint32_t index) noexcept { return landmarks_[index]; }
  [[nodiscard]] std::span<const MapLandmark> landmarks() const noexcept { return landmarks_.span(); }
  [[nodiscard]] Point2& position_W(std::uint32_t index) noexcept { return positions_W_[index]; }
  [[nodiscard]] std::span<const Point2> positions_W() const noexcept { return positions_W_.span(); }
  [[nodiscard]] MapView view() const noexcept { return {positions_W_.span(), graph_, grid_}; }

 private:
  BoundedVector<MapLandmark> landmarks_;
  BoundedVector<Point2> positions_W_;
  LandmarkGraph graph_;
  PointGrid grid_;
};

}  // namespace slamsensor::core
