#pragma once

#include "tools/world/ground.hpp"
#include "tools/world/objects.hpp"
#include "tools/world/shapes.hpp"
#include "tools/world/world_config.hpp"

#include <vector>

namespace slamsensor::tools {

/// Where a mover is and which way it goes, in W.
struct MoverPlace {
  core::Point2 position_W;
  Eigen::Vector2d forward_W;  ///< unit vector
};

/// Length of the way after which `path` repeats itself or turns back, m: the straight line or the
/// circumference.
[[nodiscard]] double path_length_m(const MoverConfig& path) noexcept;

/// The place after `way_m` of `path`. Straight paths are walked to and fro.
[[nodiscard]] MoverPlace place_on_path(const MoverConfig& path, double way_m) noexcept;

/// The place of `mover` at `time_s`.
[[nodiscard]] MoverPlace place_at(const MoverConfig& mover, double time_s) noexcept;

/// Everything that moves. Immutable: where things are is a function of the time.
class Movers {
 public:
  struct Hit {
    double distance_m = kMiss;
    Surface surface = Surface::None;
    std::uint32_t mover = 0;  ///< index into the movers given at construction
  };

  Movers(const std::vector<MoverConfig>& movers, const BodyConfig& bodies);

  /// The first mover that `ray` meets before `limit_m` at `time_s`, or a Hit without a surface.
  [[nodiscard]] Hit first_hit(const Ray& ray, double limit_m, double time_s,
                              const Ground& ground) const noexcept;

 private:
  struct Item {
    MoverConfig config;
    core::Point2 bound_centre_W;  // the body never leaves this circle
    double bound_radius_m;
  };

  [[nodiscard]] Chord body_chord(const Ray& ray, const Item& item, double time_s,
                                 const Ground& ground) const noexcept;

  std::vector<Item> items_;
  BodyConfig bodies_;
};

}  // namespace slamsensor::tools
