#include "core/graph/spatial_order.hpp"

#include "core/graph/radix_sort.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace slamsensor::core {
namespace {

constexpr std::uint32_t kCurveBits = 14;  // per axis; points in one cell of the curve come by index
constexpr std::uint32_t kRoundBits = 4;
constexpr std::uint32_t kRounds = 1U << kRoundBits;
constexpr std::uint32_t kIndexBits = 32;
constexpr std::uint32_t kExtentBits = 28;  // a difference of two lattice coordinates

struct Box {
  LatticePoint low;
  LatticePoint high;
};

Box bounding_box(std::span<const LatticePoint> points) noexcept {
  Box box{points.front(), points.front()};
  for (const LatticePoint& p : points) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
  }
  return box;
}

// Distance along the Hilbert curve through a square of 2^kCurveBits cells a side. From the largest quadrant
// down, the curve is turned so that the quadrant entered looks like the whole.
std::uint64_t hilbert_distance(std::uint64_t x, std::uint64_t y) noexcept {
  std::uint64_t distance = 0;
  for (std::uint32_t bit = kCurveBits; bit-- > 0;) {
    const std::uint64_t right = (x >> bit) & 1U;
    const std::uint64_t upper = (y >> bit) & 1U;
    distance = (distance << 2U) | ((3 * right) ^ upper);
    if (upper == 0) {
      const std::uint64_t mirror = 0 - right;
      const std::uint64_t old_x = x;
      x = y ^ mirror;
      y = old_x ^ mirror;
    }
  }
  return distance;
}

// The round in which point `index` is inserted: the last for half of the points, the one before for a
// quarter, and so on, drawn by a fixed scrambling of the index (two multiplications by an odd number whose
// bits look random).
std::uint64_t round_of(std::uint64_t index) noexcept {
  constexpr std::uint64_t kScramble = 0x9E37'79B9'7F4A'7C15U;
  std::uint64_t mixed = (index + 1) * kScramble;
  mixed = (mixed ^ (mixed >> 32U)) * kScramble;
  return kRounds - 1 - std::min(static_cast<std::uint32_t>(std::countl_zero(mixed)), kRounds - 1);
}

}  // namespace

void spatial_order(std::span<const LatticePoint> points, std::span<std::uint64_t> keys,
                   std::span<std::uint64_t> scratch) noexcept {
  if (points.empty()) {
    return;
  }
  const Box box = bounding_box(points);
  const auto extent = static_cast<std::uint64_t>(std::max(box.high.x - box.low.x, box.high.y - box.low.y));
  const auto extent_bits = static_cast<std::uint32_t>(std::bit_width(extent));
  const std::uint32_t coarsen = extent_bits > kCurveBits ? extent_bits - kCurveBits : 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto x = static_cast<std::uint64_t>(points[i].x - box.low.x) >> coarsen;
    const auto y = static_cast<std::uint64_t>(points[i].y - box.low.y) >> coarsen;
    keys[i] = (((round_of(i) << (2 * kCurveBits)) | hilbert_distance(x, y)) << kIndexBits) | i;
  }
  radix_sort(keys, scratch, kIndexBits, kIndexBits + 2 * kCurveBits + kRoundBits);
}

void line_order(std::span<const LatticePoint> points, std::span<std::uint64_t> keys,
                std::span<std::uint64_t> scratch) noexcept {
  if (points.empty()) {
    return;
  }
  const Box box = bounding_box(points);
  const bool upright = box.low.x == box.high.x;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int64_t along = upright ? points[i].y - box.low.y : points[i].x - box.low.x;
    keys[i] = (static_cast<std::uint64_t>(along) << kIndexBits) | i;
  }
  radix_sort(keys, scratch, kIndexBits, kIndexBits + kExtentBits);
}

}  // namespace slamsensor::core
