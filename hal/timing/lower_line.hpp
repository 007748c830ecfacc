#pragma once

#include <array>
#include <cstddef>

namespace slamsensor::hal {

/// The line under a cloud of points (x grows): none lies below it, and the sum of their heights above it is
/// the least possible, among lines whose slope stays within bounds. Points that are late by chance leave it
/// where it is. (Moon, Skelly and Towsley: "Estimation and removal of clock skew from network delay
/// measurements", INFOCOM 1999.)
class LowerLine {
 public:
  struct Point {
    double x = 0.0;
    double y = 0.0;
  };
  struct Line {
    double slope = 0.0;
    double offset = 0.0;  ///< at x = 0
  };
  static constexpr std::size_t kPointsMax = 64;

  void clear() noexcept { count_ = 0; }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

  /// Takes a point with x greater than all before; the oldest leaves when there are kPointsMax.
  void add(const Point& point) noexcept;

  /// Moves the origin of all points.
  void shift(double dx, double dy) noexcept;

  struct Slopes {
    double least = 0.0;
    double greatest = 0.0;
    double otherwise = 0.0;  ///< what a single point gets; between the two
  };
  /// There must be at least one point.
  [[nodiscard]] Line fit(const Slopes& slopes) const noexcept;

  /// Takes back the newest point. There must be one.
  void drop_newest() noexcept { --count_; }

 private:
  [[nodiscard]] double hull_slope(double fallback) const noexcept;

  std::array<Point, kPointsMax> points_{};
  std::size_t count_ = 0;
};

}  // namespace slamsensor::hal
