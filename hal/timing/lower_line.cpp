#include "hal/timing/lower_line.hpp"

#include <algorithm>

namespace slamsensor::hal {
namespace {

/// Whether `b` lies on or above the straight line from `a` to `c`.
bool is_above(const LowerLine::Point& a, const LowerLine::Point& b, const LowerLine::Point& c) noexcept {
  return (b.y - a.y) * (c.x - a.x) >= (c.y - a.y) * (b.x - a.x);
}

}  // namespace

void LowerLine::add(const Point& point) noexcept {
  if (count_ == kPointsMax) {
    std::copy(points_.begin() + 1, points_.end(), points_.begin());
    --count_;
  }
  points_[count_++] = point;
}

void LowerLine::shift(double dx, double dy) noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    points_[i].x += dx;
    points_[i].y += dy;
  }
}

double LowerLine::hull_slope(double fallback) const noexcept {
  std::array<Point, kPointsMax> hull{};
  std::size_t corners = 0;
  double mean_x = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    while (corners >= 2 && is_above(hull[corners - 2], hull[corners - 1], points_[i])) {
      --corners;
    }
    hull[corners++] = points_[i];
    mean_x += points_[i].x / static_cast<double>(count_);
  }
  // The edge over the mean is the line whose heights sum up to the least.
  for (std::size_t i = 1; i < corners; ++i) {
    if (hull[i].x >= mean_x) {
      return (hull[i].y - hull[i - 1].y) / (hull[i].x - hull[i - 1].x);
    }
  }
  return fallback;
}

LowerLine::Line LowerLine::fit(const Slopes& slopes) const noexcept {
  Line line;
  line.slope = std::clamp(hull_slope(slopes.otherwise), slopes.least, slopes.greatest);
  line.offset = points_[0].y - line.slope * points_[0].x;
  for (std::size_t i = 1; i < count_; ++i) {
    line.offset = std::min(line.offset, points_[i].y - line.slope * points_[i].x);
  }
  return line;
}

}  // namespace slamsensor::hal
