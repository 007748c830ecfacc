#pragma once

#include "tools/world/shapes.hpp"
#include "tools/world/world_config.hpp"

#include <cstdint>
#include <vector>

namespace slamsensor::tools {

/// Uneven ground: a plane plus a few sine waves, without end. Immutable.
class Ground {
 public:
  Ground(const GroundConfig& config, std::uint64_t seed);

  /// Height of the ground at (x, y) in W, m.
  [[nodiscard]] double height_m(double x_m, double y_m) const noexcept;

  /// Distance along `ray` to the ground, m, at most `limit_m` (below 1e5), else kMiss; 0 from below the
  /// ground. Exact on a plane. On waves it is marched by steps that the steepest slope allows and then
  /// bisected: within 0.1 mm along the ray, but a crest that the ray cuts over less than a 128th of the
  /// shortest wave may be passed.
  [[nodiscard]] double distance_m(const Ray& ray, double limit_m) const noexcept;

  /// A distance that the ground is certainly not beyond, m, known without searching; kMiss when `ray` may
  /// never meet it.
  [[nodiscard]] double distance_bound_m(const Ray& ray) const noexcept;

 private:
  struct Wave {
    double turns_per_m_x;
    double turns_per_m_y;
    double phase_turns;
    double amplitude_m;
  };

  struct Bracket {  // of a crossing: a place above the ground and one below it, and the clearance at both
    double above_m;
    double below_m;
    double clear_above_m;
    double clear_below_m;
  };

  [[nodiscard]] double wave_height_m(double x_m, double y_m) const noexcept;
  [[nodiscard]] double march_m(const Ray& ray, double begin_m, double end_m) const noexcept;
  [[nodiscard]] double bisect_m(const Ray& ray, Bracket bracket) const noexcept;
  [[nodiscard]] double clearance_m(const Ray& ray, double t_m) const noexcept;

  std::vector<Wave> waves_;
  double slope_x_;
  double slope_y_;
  double amplitude_m_ = 0.0;     // no wave height exceeds it
  double wave_slope_max_ = 0.0;  // no wave slope exceeds it
  double overstep_m_ = 0.0;      // added to every step of the march, so that it ends
};

}  // namespace slamsensor::tools
