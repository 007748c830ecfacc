#include "tools/plot/label_placer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr double kCell_px = 32.0;
constexpr double kLineStep_px = 3.0;
constexpr double kLineHalf_px = 1.5;
constexpr double kRingStep = 0.8;
// A label nearby that stands on something lesser is better than one far away that stands on nothing.
constexpr int kNearRings = 3;
// Nothing is tolerated: one beyond the least evil.
constexpr auto kNothing = static_cast<Obstacle>(static_cast<int>(Obstacle::Cross) + 1);

std::size_t cells_for(double length_px) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(length_px / kCell_px)));
}

std::size_t cell_of(double offset_px, std::size_t cells) {
  return static_cast<std::size_t>(std::clamp(offset_px / kCell_px, 0.0, static_cast<double>(cells - 1)));
}

struct Side {
  double x;
  double y;
};

// Directions from the anchor to the label, y down, the most legible first (right and up, as cartographers
// place names).
constexpr std::array<Side, 8> kSides{{{1, -1}, {1, 0}, {-1, -1}, {0, -1}, {1, 1}, {-1, 0}, {-1, 1}, {0, 1}}};

Box box_at(const LabelRequest& request, const Side& side, double distance_px) {
  // Diagonal places may come nearer along each axis: the corner is what faces the anchor.
  const double reach = side.x != 0 && side.y != 0 ? 0.6 * distance_px : distance_px;
  const double x = request.anchor_px.x() + side.x * (reach + 0.5 * request.width_px);
  const double y = request.anchor_px.y() + side.y * (reach + 0.5 * request.height_px);
  return {x - 0.5 * request.width_px, y - 0.5 * request.height_px, x + 0.5 * request.width_px,
          y + 0.5 * request.height_px};
}

}  // namespace

LabelPlacer::LabelPlacer(const Box& frame)
    : frame_(frame),
      columns_(cells_for(frame.width())),
      rows_(cells_for(frame.height())),
      cells_(columns_ * rows_) {
}

template <typename Visit>
void LabelPlacer::for_cells(const Box& box, Visit visit) const {
  const std::size_t right = cell_of(box.right - frame_.left, columns_);
  const std::size_t bottom = cell_of(box.bottom - frame_.top, rows_);
  for (std::size_t row = cell_of(box.top - frame_.top, rows_); row <= bottom; ++row) {
    for (std::size_t column = cell_of(box.left - frame_.left, columns_); column <= right; ++column) {
      visit(row * columns_ + column);
    }
  }
}

void LabelPlacer::block(const Box& box, Obstacle kind) {
  if (!frame_.overlaps(box)) return;
  for_cells(box, [&](std::size_t cell) { cells_[cell].push_back({box, kind}); });
}

void LabelPlacer::block_line(const core::Point2& a, const core::Point2& b) {
  const double steps = std::ceil((b - a).norm() / kLineStep_px);
  for (double i = 0.0; i <= steps; i += 1.0) {
    const core::Point2 p = steps > 0.0 ? core::Point2(a + (i / steps) * (b - a)) : a;
    block(box_around(p, kLineHalf_px), Obstacle::Line);
  }
}

bool LabelPlacer::is_free(const Box& box, Obstacle worst_tolerated) const {
  bool is_clear = true;
  for_cells(box, [&](std::size_t cell) {
    for (const Blocked& blocked : cells_[cell]) {
      if (blocked.kind < worst_tolerated && blocked.box.overlaps(box)) is_clear = false;
    }
  });
  return is_clear;
}

std::optional<Box> LabelPlacer::find(const LabelRequest& request, int rings, Obstacle worst_tolerated) const {
  for (int ring = 0; ring < rings; ++ring) {
    const double distance_px = request.gap_px * (1.0 + kRingStep * ring);
    for (const Side& side : kSides) {
      const Box box = box_at(request, side, distance_px);
      if (frame_.contains(box) && is_free(box, worst_tolerated)) return box;
    }
  }
  return std::nullopt;
}

std::optional<Box> LabelPlacer::find(const LabelRequest& request, int rings) const {
  const int last = std::max(1, static_cast<int>(request.tolerated_from));
  for (int kind = static_cast<int>(kNothing); kind >= last; --kind) {
    const std::optional<Box> box = find(request, rings, static_cast<Obstacle>(kind));
    if (box) return box;
  }
  return std::nullopt;
}

std::optional<Box> LabelPlacer::place(const LabelRequest& request) {
  std::optional<Box> box = find(request, std::min(request.rings, kNearRings));
  if (!box && request.rings > kNearRings) box = find(request, request.rings);
  if (box) block(*box, Obstacle::Label);
  return box;
}

}  // namespace slamsensor::tools
