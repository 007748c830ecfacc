#pragma once

#include "core/geometry/pose2.hpp"
#include "tests/support/in_arena.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tests {

using Points = std::vector<core::Point2>;

/// `count` points uniform in a square of `side_m` with one corner at the origin.
inline Points uniform_points(std::size_t count, double side_m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(0.0, side_m);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = along(random);
    points.emplace_back(x, along(random));
  }
  return points;
}

/// `columns` x `rows` points `step_m` apart.
inline Points lattice_points(int columns, int rows, double step_m) {
  Points points;
  for (int i = 0; i < columns * rows; ++i) {
    points.emplace_back(step_m * (i % columns), step_m * (i / columns));
  }
  return points;
}

/// All lattice places (1/1024 m) at one exact distance from `centre`: the integer points of the circle of
/// radius 5 * 13 * 17 * 29 steps, a hypotenuse of many Pythagorean triangles.
inline Points pythagorean_circle(const core::Point2& centre) {
  constexpr int kRadius = 5 * 13 * 17 * 29;
  Points points;
  for (int x = -kRadius; x <= kRadius; ++x) {
    const auto y = static_cast<int>(std::lround(std::sqrt(double{kRadius} * kRadius - double{1} * x * x)));
    if (static_cast<std::int64_t>(x) * x + static_cast<std::int64_t>(y) * y ==
        static_cast<std::int64_t>(kRadius) * kRadius) {
      points.emplace_back(centre.x() + x / 1024.0, centre.y() + y / 1024.0);
      if (y != 0) {
        points.emplace_back(centre.x() + x / 1024.0, centre.y() - y / 1024.0);
      }
    }
  }
  return points;
}

/// Point sets that triangulations trip over, each with its name.
inline std::vector<std::pair<std::string, Points>> degenerate_sets() {
  std::vector<std::pair<std::string, Points>> sets;
  sets.emplace_back("lattice 30x30", lattice_points(30, 30, 1.0));
  sets.emplace_back("lattice at the finest step", lattice_points(17, 23, 1.0 / 1024.0));
  sets.emplace_back("circle", pythagorean_circle({0.0, 0.0}));
  Points with_centre = pythagorean_circle({100.0, -50.0});
  with_centre.emplace_back(100.0, -50.0);
  sets.emplace_back("circle with its centre", with_centre);
  Points cross;
  for (int i = -40; i <= 40; ++i) {
    cross.emplace_back(i, 0.0);
    cross.emplace_back(0.0, i);
  }
  sets.emplace_back("cross with its centre twice", cross);
  Points fan = lattice_points(100, 1, 0.25);
  fan.insert(fan.begin() + 50, core::Point2(3.0, 20.0));
  sets.emplace_back("line and one point off it", fan);
  Points thin = lattice_points(200, 1, 1.0);
  thin.emplace_back(100.0, 1.0 / 1024.0);
  sets.emplace_back("line and one point a step off it", thin);
  Points twice = uniform_points(150, 0.01, 5);
  sets.emplace_back("150 points on a hundred places", twice);
  Points square_sides;
  for (int i = 0; i < 40; ++i) {
    square_sides.insert(square_sides.end(), {{i, 0.0}, {40.0, i}, {40.0 - i, 40.0}, {0.0, 40.0 - i}});
  }
  sets.emplace_back("sides of a square", square_sides);
  const double reach = 65'000.0;
  sets.emplace_back("corners of the reach and lattice within", Points{{-reach, -reach},
                                                                      {reach, -reach},
                                                                      {reach, reach},
                                                                      {-reach, reach},
                                                                      {0.0, 0.0},
                                                                      {reach, 0.0},
                                                                      {0.0, reach},
                                                                      {1.0 / 1024.0, 0.0},
                                                                      {0.0, -1.0 / 1024.0}});
  return sets;
}

}  // namespace slamsensor::tests
