#pragma once

#include "core/geometry/pose2.hpp"

#include <cmath>
#include <cstdint>

namespace slamsensor::core {

/// Points are brought to a lattice of 2^-10 m (about 1 mm) before anything is decided, so that every
/// predicate is exact in integers; coordinates beyond +-65 km are refused.
struct LatticePoint {
  std::int64_t x = 0;
  std::int64_t y = 0;

  friend bool operator==(const LatticePoint&, const LatticePoint&) noexcept = default;
};
inline constexpr double kLatticePerMetre = 1024.0;
inline constexpr double kLatticeReach_m = 65'000.0;

/// Whether both coordinates are numbers within the reach of the lattice.
[[nodiscard]] inline bool on_lattice(const Point2& point) noexcept {
  return std::abs(point.x()) <= kLatticeReach_m && std::abs(point.y()) <= kLatticeReach_m;
}

/// The lattice place nearest to `point` (m), which must be `on_lattice`.
[[nodiscard]] inline LatticePoint to_lattice(const Point2& point) noexcept {
  return {std::llround(point.x() * kLatticePerMetre), std::llround(point.y() * kLatticePerMetre)};
}

/// Twice the signed area of abc: positive when the three turn counter-clockwise, zero when they lie on a
/// line. Exact: coordinates stay below 2^26, so differences stay below 2^27 and the result below 2^55.
[[nodiscard]] inline std::int64_t orientation(const LatticePoint& a, const LatticePoint& b,
                                              const LatticePoint& c) noexcept {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether `p` lies on the open segment ab; a, b and p must lie on a line.
[[nodiscard]] inline bool strictly_between(const LatticePoint& a, const LatticePoint& b,
                                           const LatticePoint& p) noexcept {
  return (a.x - p.x) * (b.x - p.x) + (a.y - p.y) * (b.y - p.y) < 0;
}

/// Whether `p` lies strictly inside the circle through the counter-clockwise triangle abc. Exact: the
/// determinant below is a sum of three products of numbers below 2^56, each a single machine multiplication,
/// so that a floating-point filter in front of it would cost more than it saves.
[[nodiscard]] inline bool in_circle(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
                                    const LatticePoint& p) noexcept {
  __extension__ typedef __int128 Wide;
  const LatticePoint u{a.x - p.x, a.y - p.y};
  const LatticePoint v{b.x - p.x, b.y - p.y};
  const LatticePoint w{c.x - p.x, c.y - p.y};
  const auto square = [](const LatticePoint& q) { return q.x * q.x + q.y * q.y; };
  const auto cross = [](const LatticePoint& q, const LatticePoint& r) { return q.x * r.y - q.y * r.x; };
  return Wide{square(u)} * cross(v, w) + Wide{square(v)} * cross(w, u) + Wide{square(w)} * cross(u, v) > 0;
}

}  // namespace slamsensor::core
