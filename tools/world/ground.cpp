#include "tools/world/ground.hpp"

#include "tools/world/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamsensor::tools {
namespace {

constexpr double kOverstepShare = 1.0 / 128.0;  // of the shortest wave: what a crest may be cut by unseen
constexpr int kStepsMax = 1 << 16;
constexpr double kBracket_m = 1e-4;
constexpr double kClear_m = 1e-6;
constexpr int kBisectionsMax = 48;
constexpr double kSlack = 1e-6;  // of the bounds, for the rounding of the sine

/// sin(2 pi turns), within 1e-8, for |turns| < 2^50: the same with every mathematical library, and without a
/// branch.
double sine_of_turns(double turns) noexcept {
  constexpr double kRounder = 6755399441055744.0;  // adding and taking it away rounds to a whole number
  const double shifted = turns - 0.25;
  const double whole = (shifted + kRounder) - kRounder;
  const double a = 2.0 * std::numbers::pi * (0.25 - std::abs(shifted - whole));  // cos is even
  const double s = a * a;
  const double tail = 1.0 / 362880.0 + s * (-1.0 / 39916800.0 + s / 6227020800.0);
  return a * (1.0 + s * (-1.0 / 6.0 + s * (1.0 / 120.0 + s * (-1.0 / 5040.0 + s * tail))));
}

}  // namespace

Ground::Ground(const GroundConfig& config, std::uint64_t seed)
    : slope_x_(config.slope_x), slope_y_(config.slope_y) {
  if (config.amplitude_m <= 0.0 || config.waves == 0) {
    return;
  }
  Random rng(seed);
  double share_sum = 0.0;
  for (std::uint32_t i = 0; i < config.waves; ++i) {
    const double length_m = draw_uniform(rng, config.wavelength_m.min, config.wavelength_m.max);
    const double bearing_rad = draw_uniform(rng, 0.0, 2.0 * std::numbers::pi);
    const double phase_turns = draw_unit(rng);
    const double share = draw_uniform(rng, 0.5, 1.0) * length_m;  // long waves are the higher ones
    waves_.push_back(
        {std::cos(bearing_rad) / length_m, std::sin(bearing_rad) / length_m, phase_turns, share});
    share_sum += share;
  }
  for (Wave& wave : waves_) {
    wave.amplitude_m *= config.amplitude_m / share_sum;
    wave_slope_max_ +=
        wave.amplitude_m * 2.0 * std::numbers::pi * std::hypot(wave.turns_per_m_x, wave.turns_per_m_y);
  }
  amplitude_m_ = config.amplitude_m * (1.0 + kSlack);
  wave_slope_max_ *= 1.0 + kSlack;
  overstep_m_ = kOverstepShare * config.wavelength_m.min;
}

double Ground::wave_height_m(double x_m, double y_m) const noexcept {
  double height_m = 0.0;
  for (const Wave& wave : waves_) {
    height_m += wave.amplitude_m *
                sine_of_turns(wave.turns_per_m_x * x_m + wave.turns_per_m_y * y_m + wave.phase_turns);
  }
  return height_m;
}

double Ground::height_m(double x_m, double y_m) const noexcept {
  return slope_x_ * x_m + slope_y_ * y_m + wave_height_m(x_m, y_m);
}

double Ground::clearance_m(const Ray& ray, double t_m) const noexcept {
  const Eigen::Vector3d p = ray.origin_W + t_m * ray.direction_W;
  return p.z() - height_m(p.x(), p.y());
}

double Ground::distance_m(const Ray& ray, double limit_m) const noexcept {
  const double start_m = ray.origin_W.z() - slope_x_ * ray.origin_W.x() - slope_y_ * ray.origin_W.y();
  const double rise = ray.direction_W.z() - slope_x_ * ray.direction_W.x() - slope_y_ * ray.direction_W.y();
  if (start_m > amplitude_m_ && rise >= 0.0) {
    return kMiss;
  }
  if (waves_.empty()) {
    const double t = start_m <= 0.0 ? 0.0 : -start_m / rise;
    return t <= limit_m ? t : kMiss;
  }
  // Only between the highest and the lowest the waves can be is there anything to search.
  const double begin_m = start_m > amplitude_m_ ? (amplitude_m_ - start_m) / rise : 0.0;
  double end_m = limit_m;
  if (rise != 0.0) {
    const double leaves_m = ((rise < 0.0 ? -amplitude_m_ : amplitude_m_) - start_m) / rise;
    end_m = std::min(limit_m, std::max(0.0, leaves_m));
  }
  return begin_m > end_m ? kMiss : march_m(ray, begin_m, end_m);
}

double Ground::distance_bound_m(const Ray& ray) const noexcept {
  const double start_m = ray.origin_W.z() - slope_x_ * ray.origin_W.x() - slope_y_ * ray.origin_W.y();
  const double rise = ray.direction_W.z() - slope_x_ * ray.direction_W.x() - slope_y_ * ray.direction_W.y();
  return rise < 0.0 ? std::max(0.0, -(start_m + amplitude_m_) / rise) : kMiss;
}

double Ground::march_m(const Ray& ray, double begin_m, double end_m) const noexcept {
  const double level = std::hypot(ray.direction_W.x(), ray.direction_W.y());
  const double rise = ray.direction_W.z() - slope_x_ * ray.direction_W.x() - slope_y_ * ray.direction_W.y();
  const double sink_max = wave_slope_max_ * level - rise;  // the clearance cannot shrink faster, m per m
  double t = begin_m;
  double clear_m = clearance_m(ray, t);
  if (clear_m <= 0.0) {
    return t;
  }
  if (sink_max <= 0.0) {
    return kMiss;
  }
  for (int step = 0; step < kStepsMax && t < end_m; ++step) {
    const double next = std::min(end_m, t + clear_m / sink_max + overstep_m_);
    const double clear_next_m = clearance_m(ray, next);
    if (clear_next_m <= 0.0) {
      return bisect_m(ray, {t, next, clear_m, clear_next_m});
    }
    t = next;
    clear_m = clear_next_m;
  }
  return kMiss;
}

double Ground::bisect_m(const Ray& ray, Bracket bracket) const noexcept {
  for (int i = 0; i < kBisectionsMax && bracket.below_m - bracket.above_m > kBracket_m; ++i) {
    // The chord's zero first, and the middle every other time, so that the bracket shrinks whatever the
    // shape.
    const double width_m = bracket.below_m - bracket.above_m;
    const double share =
        i % 2 == 0 ? bracket.clear_above_m / (bracket.clear_above_m - bracket.clear_below_m) : 0.5;
    const double t = bracket.above_m + share * width_m;
    const double clear_m = clearance_m(ray, t);
    if (std::abs(clear_m) < kClear_m) {
      return t;
    }
    if (clear_m > 0.0) {
      bracket.above_m = t;
      bracket.clear_above_m = clear_m;
    } else {
      bracket.below_m = t;
      bracket.clear_below_m = clear_m;
    }
  }
  return 0.5 * (bracket.above_m + bracket.below_m);
}

}  // namespace slamsensor::tools
