#include "tools/top/map_sketch.hpp"

#include "tools/output/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace slamsensor::tools {
namespace {

constexpr double kCellAspect = 2.0;  ///< height of a cell over its width
constexpr double kSmallestSpan_m = 2.0;
// Beyond this nothing on the map is told apart, and arithmetic with it is not safe.
constexpr double kFarthest_m = 1e7;

/// The smallest upright rectangle around points.
struct Bounds {
  double x_min = std::numeric_limits<double>::infinity();
  double x_max = -std::numeric_limits<double>::infinity();
  double y_min = std::numeric_limits<double>::infinity();
  double y_max = -std::numeric_limits<double>::infinity();

  void add(double x_m, double y_m) {
    if (std::abs(x_m) < kFarthest_m && std::abs(y_m) < kFarthest_m) {
      x_min = std::min(x_min, x_m);
      x_max = std::max(x_max, x_m);
      y_min = std::min(y_min, y_m);
      y_max = std::max(y_max, y_m);
    }
  }
  [[nodiscard]] bool empty() const { return x_min > x_max; }
};

Bounds bounds_of(const SensorView& view) {
  Bounds bounds;
  for (const auto& [chunk, landmarks] : view.map()) {
    for (const SensorView::Landmark& landmark : landmarks) {
      bounds.add(landmark.position_W.x(), landmark.position_W.y());
    }
  }
  for (const core::Pose2& pose : view.path_W()) {
    bounds.add(pose.x_m, pose.y_m);
  }
  return bounds;
}

/// From metres to cells, the middle of the bounds in the middle of the box.
class Projection {
 public:
  Projection(const Bounds& bounds, const CanvasBox& box) : box_(box) {
    const double wide_m = std::max(kSmallestSpan_m, bounds.x_max - bounds.x_min);
    const double high_m = std::max(kSmallestSpan_m, bounds.y_max - bounds.y_min);
    metres_per_column_ = std::max(wide_m / (box.width - 1), high_m / kCellAspect / (box.height - 1));
    x_m_ = (bounds.x_min + bounds.x_max) / 2.0;
    y_m_ = (bounds.y_min + bounds.y_max) / 2.0;
  }

  void put(Canvas& canvas, double x_m, double y_m, std::string_view mark, CellStyle style) const {
    const double column = (x_m - x_m_) / metres_per_column_ + (box_.width - 1) / 2.0;
    const double row = (y_m_ - y_m) / (metres_per_column_ * kCellAspect) + (box_.height - 1) / 2.0;
    if (column > -0.5 && column < box_.width - 0.5 && row > -0.5 && row < box_.height - 0.5) {
      canvas.put(box_.x + static_cast<int>(std::lround(column)), box_.y + static_cast<int>(std::lround(row)),
                 mark, style);
    }
  }

  [[nodiscard]] double width_m() const { return metres_per_column_ * box_.width; }

 private:
  CanvasBox box_;
  double metres_per_column_ = 1.0;
  double x_m_ = 0.0;
  double y_m_ = 0.0;
};

std::string_view arrow_of(double heading_rad) {
  constexpr std::array<std::string_view, 4> kArrows = {">", "^", "<", "v"};
  if (!std::isfinite(heading_rad)) {
    return "?";
  }
  const double quarter = std::floor(core::wrap_angle(heading_rad) / (std::numbers::pi / 2.0) + 0.5);
  return kArrows[static_cast<std::size_t>(static_cast<int>(quarter) + 4) % 4];
}

void draw_marks(const SensorView& view, const Projection& projection, Canvas& canvas) {
  for (const auto& [chunk, landmarks] : view.map()) {
    for (const SensorView::Landmark& landmark : landmarks) {
      projection.put(canvas, landmark.position_W.x(), landmark.position_W.y(), ".", CellStyle::Plain);
    }
  }
  for (const core::Pose2& pose : view.path_W()) {
    projection.put(canvas, pose.x_m, pose.y_m, "+", CellStyle::Dim);
  }
  if (!view.path_W().empty()) {
    const core::Pose2& last = view.path_W().back();
    projection.put(canvas, last.x_m, last.y_m, arrow_of(last.heading_rad), CellStyle::Good);
  }
}

}  // namespace

void draw_map_sketch(const SensorView& view, const CanvasBox& box, Canvas& canvas) {
  if (box.width < 8 || box.height < 4) {
    return;
  }
  const Bounds bounds = bounds_of(view);
  if (bounds.empty()) {
    canvas.put(box.x, box.y, "no map yet", CellStyle::Dim);
    return;
  }
  const CanvasBox field{box.x, box.y, box.width, box.height - 1};
  const Projection projection(bounds, field);
  draw_marks(view, projection, canvas);
  canvas.put(box.x, box.y + box.height - 1, "|- " + fixed_text(projection.width_m(), 1) + " m wide -|",
             CellStyle::Dim);
}

}  // namespace slamsensor::tools
