#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>

namespace slamsensor::tools {

/// The only source of chance in a simulated world. The engine's output is fixed by the C++ standard; the
/// standard's distributions are not, so the draws below are our own and give the same values with every
/// library.
using Random = std::mt19937_64;

/// A seed for the stream `stream` of `seed`: neighbouring arguments give unrelated seeds (the finaliser of
/// splitmix64, Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014).
[[nodiscard]] constexpr std::uint64_t mix_seed(std::uint64_t seed, std::uint64_t stream) noexcept {
  std::uint64_t z = seed + 0x9E3779B97F4A7C15ULL * (stream + 1);
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

/// The upper 53 of `bits` as a number in [0, 1).
[[nodiscard]] constexpr double to_unit(std::uint64_t bits) noexcept {
  return static_cast<double>(bits >> 11U) * 0x1.0p-53;
}

/// Uniform in [0, 1); one engine draw.
[[nodiscard]] inline double draw_unit(Random& rng) noexcept {
  return to_unit(rng());
}

/// Uniform in [low, high); one engine draw.
[[nodiscard]] inline double draw_uniform(Random& rng, double low, double high) noexcept {
  return low + (high - low) * draw_unit(rng);
}

/// Normal with mean 0 and standard deviation 1 (Box and Muller); always two engine draws.
[[nodiscard]] inline double draw_normal(Random& rng) noexcept {
  const double radius = std::sqrt(-2.0 * std::log1p(-draw_unit(rng)));
  return radius * std::cos(2.0 * std::numbers::pi * draw_unit(rng));
}

/// How far a ray gets in a medium that stops it `stops_per_m` times per metre, m, from a uniform `unit` in
/// [0, 1). Infinite in a medium that stops nothing.
[[nodiscard]] inline double free_path_m(double unit, double stops_per_m) noexcept {
  if (stops_per_m <= 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  return -std::log1p(-unit) / stops_per_m;
}

}  // namespace slamsensor::tools
