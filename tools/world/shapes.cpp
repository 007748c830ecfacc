#include "tools/world/shapes.hpp"

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

}  // namespace slamsensor::tools
