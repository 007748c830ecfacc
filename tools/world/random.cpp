#include "tools/world/random.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace slamsensor::tools {

double draw_normal(Random& rng) noexcept {
  const double radius = std::sqrt(-2.0 * std::log1p(-draw_unit(rng)));
  return radius * std::cos(2.0 * std::numbers::pi * draw_unit(rng));
}

double free_path_m(double unit, double stops_per_m) noexcept {
  if (stops_per_m <= 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  return -std::log1p(-unit) / stops_per_m;
}

}  // namespace slamsensor::tools
