#pragma once

#include "core/config.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace slamsensor::core {

/// The geometry of the spiderweb grid (DESIGN 2.2): rows of `range_step` by columns of `bearing_step` in the
/// sensor frame. The circle is closed by ceil(2 pi / bearing_step) columns, of which the last may be
/// narrower. A cell owns its lower edges: a value on an edge belongs to the higher cell. Readings often lie
/// exactly on edges (whole centimetres, whole encoder ticks) but for the rounding of their units, so less
/// than kEdgeSlack of a cell below an edge is on it; that also settles the rounding of the multiplication by
/// a reciprocal that stands for the division.
class PolarGrid {
 public:
  static constexpr double kEdgeSlack = 1e-9;  // cells; rounding stays below it up to 10^6 rows or columns

  /// Steps are positive, range_step <= range_max, at most 10^6 rows and columns and 2^31 cells: the loader's
  /// promise, and our invariant.
  explicit PolarGrid(const DetectionConfig& config) noexcept;

  [[nodiscard]] std::uint32_t columns() const noexcept { return columns_; }
  [[nodiscard]] std::uint32_t rows() const noexcept { return rows_; }
  [[nodiscard]] std::uint32_t cells() const noexcept { return rows_ * columns_; }
  [[nodiscard]] std::uint32_t next(std::uint32_t column) const noexcept {
    return column + 1 == columns_ ? 0 : column + 1;
  }
  [[nodiscard]] std::uint32_t previous(std::uint32_t column) const noexcept {
    return (column == 0 ? columns_ : column) - 1;
  }

  /// Columns from `from` to `to`, the shorter way round; to the left positive.
  [[nodiscard]] double columns_between(std::uint32_t from, std::uint32_t to) const noexcept {
    return std::remainder(static_cast<double>(to) - static_cast<double>(from), static_cast<double>(columns_));
  }

  /// The column of a finite bearing, which is taken modulo 2 pi; what rounds to 2 pi is in column 0.
  [[nodiscard]] std::uint32_t column_of(double bearing_rad) const noexcept {
    const double in_columns = into_turn(bearing_rad) * columns_per_rad_ + kEdgeSlack;
    return in_columns < turn_columns_ ? static_cast<std::uint32_t>(in_columns) : 0;
  }

  /// The row of a horizontal distance >= 0; the outermost row also has what lies farther out.
  [[nodiscard]] std::uint32_t row_of(double horizontal_m) const noexcept {
    const double in_rows = horizontal_m * rows_per_m_ + kEdgeSlack;
    return in_rows < static_cast<double>(rows_) ? static_cast<std::uint32_t>(in_rows) : rows_ - 1;
  }

  /// Bearing of the lower edge of `column`, in [0, 2 pi).
  [[nodiscard]] double edge_rad(std::uint32_t column) const noexcept { return column * bearing_step_rad_; }
  /// Signed angle from the middle of `column` to `bearing_rad`, in [-pi, pi]: how far off centre a reading
  /// is.
  [[nodiscard]] double off_centre_rad(std::uint32_t column, double bearing_rad) const noexcept;
  /// Inner radius of `row`; the outer radius is that of the row after it.
  [[nodiscard]] double radius_m(std::uint32_t row) const noexcept { return row * range_step_m_; }

 private:
  static constexpr double kTurn = 2.0 * std::numbers::pi;

  /// Into [0, 2 pi]; 2 pi itself only from a negative angle too small to change it.
  [[nodiscard]] static double into_turn(double angle_rad) noexcept {
    if (angle_rad >= kTurn || angle_rad < -kTurn) [[unlikely]] {
      angle_rad = std::fmod(angle_rad, kTurn);
    }
    return angle_rad < 0.0 ? angle_rad + kTurn : angle_rad;
  }

  double bearing_step_rad_;
  double range_step_m_;
  double columns_per_rad_;
  double rows_per_m_;
  double turn_columns_;  // 2 pi in columns: whole, or the last column is narrower
  std::uint32_t columns_;
  std::uint32_t rows_;
};

}  // namespace slamsensor::core
