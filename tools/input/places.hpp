#pragma once

#include "core/geometry/pose2.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <utility>

namespace slamsensor::tools {

/// Places of the plane, no two of them within a distance of each other: it finds a point that stands where
/// another one does already.
class Places {
 public:
  explicit Places(double one_place_m) : one_place_m_(one_place_m) {}

  /// True, and `point` (m) is a place, unless one is within the distance.
  bool is_new(const core::Point2& point) {
    const auto cell_x = std::llround(std::floor(point.x() / one_place_m_));
    const auto cell_y = std::llround(std::floor(point.y() / one_place_m_));
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto found = points_.find({cell_x + dx, cell_y + dy});
        if (found != points_.end() && (found->second - point).norm() < one_place_m_) {
          return false;
        }
      }
    }
    points_.try_emplace({cell_x, cell_y}, point);
    return true;
  }

 private:
  struct Hash {
    std::size_t operator()(const std::pair<std::int64_t, std::int64_t>& cell) const {
      const std::uint64_t mixed = static_cast<std::uint64_t>(cell.first) * 0x9E3779B97F4A7C15U;
      return std::hash<std::uint64_t>()(mixed ^ static_cast<std::uint64_t>(cell.second));
    }
  };

  double one_place_m_;
  std::unordered_map<std::pair<std::int64_t, std::int64_t>, core::Point2, Hash> points_;
};

}  // namespace slamsensor::tools
