#pragma once

#include "core/geometry/pose2.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace slamsensor::core {

/// Where a scan has landmarks: a bit for each cell of a square that repeats itself, set within a gate of a
/// landmark. Answers for any place by one look; where it says no, there is none.
class ScanMask {
 public:
  /// Cells of a third of `gate_m`.
  void draw(std::span<const Point2> scan, double gate_m) noexcept;

  [[nodiscard]] bool has(float x_m, float y_m) const noexcept {
    const std::uint32_t column = cell(x_m);
    const std::uint32_t row = cell(y_m);
    return ((bits_[row & kSideMask][(column & kSideMask) >> 6U] >> (column & 63U)) & 1U) != 0;
  }

 private:
  static constexpr double kCellsPerGate = 3.0;
  static constexpr std::uint32_t kSide = 256;
  static constexpr std::uint32_t kSideMask = kSide - 1;
  static constexpr float kShift = 1 << 16;  // makes cells positive before they are cut off

  [[nodiscard]] std::uint32_t cell(float v_m) const noexcept {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(v_m * cells_per_m_ + kShift));
  }

  std::array<std::array<std::uint64_t, kSide / 64>, kSide> bits_{};
  float cells_per_m_ = 1.0F;
};

inline void ScanMask::draw(std::span<const Point2> scan, double gate_m) noexcept {
  for (auto& row : bits_) {
    row.fill(0);
  }
  const double cell_m = gate_m / kCellsPerGate;
  cells_per_m_ = static_cast<float>(1.0 / cell_m);
  for (const Point2& p : scan) {
    const double x = p.x() / cell_m + static_cast<double>(kShift);
    const double y = p.y() / cell_m + static_cast<double>(kShift);
    const auto row_last = static_cast<std::uint32_t>(y + kCellsPerGate);
    for (auto row = static_cast<std::uint32_t>(y - kCellsPerGate); row <= row_last; ++row) {
      // Half the width of the disc at the line of the row that is nearest to its middle.
      const double dy = std::max({0.0, static_cast<double>(row) - y, y - 1.0 - static_cast<double>(row)});
      const double half = std::sqrt(std::max(0.0, kCellsPerGate * kCellsPerGate - dy * dy));
      const auto last = static_cast<std::uint32_t>(x + half);
      for (auto column = static_cast<std::uint32_t>(x - half); column <= last; ++column) {
        bits_[row & kSideMask][(column & kSideMask) >> 6U] |= std::uint64_t{1} << (column & 63U);
      }
    }
  }
}

}  // namespace slamsensor::core
