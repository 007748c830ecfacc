#include "tools/world/shapes.hpp"

#include "tools/world/random.hpp"

namespace slamsensor::tools {

Chord box_chord(const Ray& ray, const Box& box) noexcept {
  const Eigen::Vector3d o = ray.origin_W - box.centre_W;
  const Eigen::Vector3d& d = ray.direction_W;
  const Eigen::Vector2d& f = box.forward_W;
  const Eigen::Vector3d& h = box.half_size_m;
  const Chord along = slab_chord(o.x() * f.x() + o.y() * f.y(), d.x() * f.x() + d.y() * f.y(), -h.x(), h.x());
  const Chord across =
      slab_chord(o.y() * f.x() - o.x() * f.y(), d.y() * f.x() - d.x() * f.y(), -h.y(), h.y());
  return intersect(intersect(along, across), slab_chord(o.z(), d.z(), -h.z(), h.z()));
}

double wall_distance_m(const Ray& ray, const Eigen::Vector2d& from_W, const Eigen::Vector2d& along_m,
                       double z_low_m, double z_high_m) noexcept {
  const double dx = ray.direction_W.x();
  const double dy = ray.direction_W.y();
  const double cross = dx * along_m.y() - dy * along_m.x();
  if (cross == 0.0) {
    return kMiss;
  }
  const double fx = from_W.x() - ray.origin_W.x();
  const double fy = from_W.y() - ray.origin_W.y();
  const double t = (fx * along_m.y() - fy * along_m.x()) / cross;
  const double share = (fx * dy - fy * dx) / cross;
  if (t < 0.0 || share < 0.0 || share > 1.0) {
    return kMiss;
  }
  const double z = ray.origin_W.z() + t * ray.direction_W.z();
  return z >= z_low_m && z <= z_high_m ? t : kMiss;
}

namespace {

constexpr double kCellsPerShape = 2.0;  // measured: flat between 1 and 6
constexpr double kCellMin_m = 2.0;
constexpr double kMargin_m = 0.01;  // so that rounding never puts a shape's rim outside its cells
constexpr std::size_t kCellsPerSideMax = 1024;

double distance_to(const Shape& shape, const Ray& ray, std::uint64_t ray_key) noexcept {
  if (shape.form == ShapeForm::Wall) {
    return wall_distance_m(ray, {shape.x_m, shape.y_m}, {shape.along_x_m, shape.along_y_m}, shape.z_low_m,
                           shape.z_high_m);
  }
  const Chord chord =
      shape.form == ShapeForm::Cylinder
          ? cylinder_chord(ray, shape.x_m, shape.y_m, shape.radius_m, shape.z_low_m, shape.z_high_m)
          : spheroid_chord(ray, shape.x_m, shape.y_m, shape.radius_m, shape.z_low_m, shape.z_high_m);
  if (chord.empty()) {
    return kMiss;
  }
  if (shape.stops_per_m <= 0.0) {
    return chord.in_m;
  }
  const std::uint64_t stream = 2 * std::uint64_t{shape.object} + (shape.surface == Surface::Crown ? 1U : 0U);
  const double stop_m = chord.in_m + free_path_m(to_unit(mix_seed(ray_key, stream)), shape.stops_per_m);
  return stop_m <= chord.out_m ? stop_m : kMiss;
}

// Way along a ray from one grid line to the next, and to the first, in one axis.
struct Stepper {
  double next_m = kMiss;
  double between_m = kMiss;
  std::ptrdiff_t step = 0;

  Stepper(double origin, double direction, double cell_low, double cell_m) noexcept {
    if (direction == 0.0) {
      return;
    }
    step = direction > 0.0 ? 1 : -1;
    between_m = cell_m / std::abs(direction);
    next_m = (cell_low + (direction > 0.0 ? cell_m : 0.0) - origin) / direction;
  }
};

}  // namespace

ShapeGrid::ShapeGrid(std::span<const Shape> shapes) {
  if (shapes.empty()) {
    return;
  }
  measure(shapes);
  fill(shapes);
}

ShapeGrid::Box2 ShapeGrid::bounds_of(const Shape& shape) noexcept {
  const double reach_m = shape.radius_m + kMargin_m;
  return {shape.x_m + std::min(0.0, shape.along_x_m) - reach_m,
          shape.x_m + std::max(0.0, shape.along_x_m) + reach_m,
          shape.y_m + std::min(0.0, shape.along_y_m) - reach_m,
          shape.y_m + std::max(0.0, shape.along_y_m) + reach_m};
}

void ShapeGrid::measure(std::span<const Shape> shapes) {
  bounds_ = bounds_of(shapes.front());
  z_low_m_ = shapes.front().z_low_m;
  z_high_m_ = shapes.front().z_high_m;
  for (const Shape& shape : shapes) {
    const Box2 b = bounds_of(shape);
    bounds_ = {std::min(bounds_.x_low, b.x_low), std::max(bounds_.x_high, b.x_high),
               std::min(bounds_.y_low, b.y_low), std::max(bounds_.y_high, b.y_high)};
    z_low_m_ = std::min(z_low_m_, shape.z_low_m);
    z_high_m_ = std::max(z_high_m_, shape.z_high_m);
  }
  const double width_m = bounds_.x_high - bounds_.x_low;
  const double depth_m = bounds_.y_high - bounds_.y_low;
  const double wished_m =
      std::sqrt(width_m * depth_m / (kCellsPerShape * static_cast<double>(shapes.size())));
  cell_m_ =
      std::max({kCellMin_m, wished_m, std::max(width_m, depth_m) / static_cast<double>(kCellsPerSideMax)});
  columns_ = static_cast<std::size_t>(width_m / cell_m_) + 1;
  rows_ = static_cast<std::size_t>(depth_m / cell_m_) + 1;
}

std::size_t ShapeGrid::column(double x_m) const noexcept {
  return static_cast<std::size_t>(
      std::clamp((x_m - bounds_.x_low) / cell_m_, 0.0, static_cast<double>(columns_ - 1)));
}

std::size_t ShapeGrid::row(double y_m) const noexcept {
  return static_cast<std::size_t>(
      std::clamp((y_m - bounds_.y_low) / cell_m_, 0.0, static_cast<double>(rows_ - 1)));
}

ShapeGrid::CellRange ShapeGrid::cells_of(const Shape& shape) const noexcept {
  const Box2 b = bounds_of(shape);
  return {column(b.x_low), column(b.x_high), row(b.y_low), row(b.y_high)};
}

void ShapeGrid::fill(std::span<const Shape> shapes) {
  std::vector<std::uint32_t> count(columns_ * rows_ + 1, 0);
  const auto for_each_cell = [this, shapes](const auto& visit) {
    for (const Shape& shape : shapes) {
      const CellRange cells = cells_of(shape);
      for (std::size_t r = cells.row_first; r <= cells.row_last; ++r) {
        for (std::size_t c = cells.column_first; c <= cells.column_last; ++c) {
          visit(r * columns_ + c, shape);
        }
      }
    }
  };
  for_each_cell([&count](std::size_t cell, const Shape&) { ++count[cell + 1]; });
  for (std::size_t cell = 1; cell < count.size(); ++cell) {
    count[cell] += count[cell - 1];
  }
  cell_begin_ = count;
  shapes_.resize(count.back());
  for_each_cell([this, &count](std::size_t cell, const Shape& shape) { shapes_[count[cell]++] = shape; });
}

void ShapeGrid::test_cell(std::size_t cell, const Ray& ray, std::uint64_t ray_key,
                          Hit& nearest) const noexcept {
  for (std::uint32_t i = cell_begin_[cell]; i < cell_begin_[cell + 1]; ++i) {
    const Shape& shape = shapes_[i];
    const double distance_m = distance_to(shape, ray, ray_key);
    if (distance_m < nearest.distance_m) {
      nearest = {distance_m, shape.surface, shape.object};
    }
  }
}

Hit ShapeGrid::first_hit(const Ray& ray, double limit_m, std::uint64_t ray_key) const noexcept {
  Hit nearest{limit_m, Surface::None, 0};
  if (shapes_.empty()) {
    return {};
  }
  const Eigen::Vector3d& o = ray.origin_W;
  const Eigen::Vector3d& d = ray.direction_W;
  Chord inside = intersect(slab_chord(o.x(), d.x(), bounds_.x_low, bounds_.x_high),
                           slab_chord(o.y(), d.y(), bounds_.y_low, bounds_.y_high));
  inside = intersect(inside, slab_chord(o.z(), d.z(), z_low_m_, z_high_m_));
  if (inside.empty() || inside.in_m >= limit_m) {
    return {};
  }
  std::size_t c = column(o.x() + inside.in_m * d.x());
  std::size_t r = row(o.y() + inside.in_m * d.y());
  Stepper along_x(o.x(), d.x(), bounds_.x_low + static_cast<double>(c) * cell_m_, cell_m_);
  Stepper along_y(o.y(), d.y(), bounds_.y_low + static_cast<double>(r) * cell_m_, cell_m_);
  for (std::size_t cell = 0; cell <= columns_ + rows_; ++cell) {
    test_cell(r * columns_ + c, ray, ray_key, nearest);
    Stepper& nearer = along_x.next_m < along_y.next_m ? along_x : along_y;
    if (nearer.next_m >= std::min(nearest.distance_m, inside.out_m)) {
      break;
    }
    std::size_t& place = &nearer == &along_x ? c : r;
    place = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(place) + nearer.step);
    if (place >= (&nearer == &along_x ? columns_ : rows_)) {
      break;
    }
    nearer.next_m += nearer.between_m;
  }
  return nearest.surface == Surface::None ? Hit{} : nearest;
}

}  // namespace slamsensor::tools
