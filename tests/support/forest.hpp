#pragma once

#include "core/geometry/pose2.hpp"
#include "core/reading.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace slamsensor::tests {

/// Draws that are the same with every standard library.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53);
  }
  double normal(double sigma) {
    const double u = uniform(1e-12, 1.0);
    return sigma * std::sqrt(-2.0 * std::log(u)) * std::cos(uniform(0.0, 2.0 * std::numbers::pi));
  }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(engine_() % count); }

 private:
  std::mt19937_64 engine_;
};

/// The task of ALGORITHMS: `count` trees, 70 m^2 each, at least 1.5 m apart, in a square about the origin.
struct Forest {
  std::vector<core::Point2> trees_W;
  double side_m = 0.0;
};

inline Forest make_forest(std::uint32_t count, Draw& draw) {
  Forest forest;
  forest.side_m = std::sqrt(70.0 * count);
  constexpr double kSpacing = 1.5;
  const auto columns = static_cast<std::size_t>(forest.side_m / kSpacing) + 1;
  std::vector<std::vector<core::Point2>> cells(columns * columns);
  const auto cell = [&](double v) { return static_cast<std::size_t>((v + 0.5 * forest.side_m) / kSpacing); };
  while (forest.trees_W.size() < count) {
    // In braces draws are made in the order written, whatever the compiler.
    const core::Point2 p{draw.uniform(-0.5, 0.5) * forest.side_m, draw.uniform(-0.5, 0.5) * forest.side_m};
    const std::size_t cx = cell(p.x());
    const std::size_t cy = cell(p.y());
    bool free = true;
    for (std::size_t y = cy > 0 ? cy - 1 : 0; y <= std::min(cy + 1, columns - 1); ++y) {
      for (std::size_t x = cx > 0 ? cx - 1 : 0; x <= std::min(cx + 1, columns - 1); ++x) {
        for (const core::Point2& q : cells[y * columns + x]) {
          free = free && (p - q).norm() >= kSpacing;
        }
      }
    }
    if (free) {
      cells[cy * columns + cx].push_back(p);
      forest.trees_W.push_back(p);
    }
  }
  return forest;
}

/// How a scan of a forest differs from the forest.
struct ScanModel {
  std::uint32_t nearest = 20;
  double dropped_share = 0.3;
  std::uint32_t spurious = 5;
  double sigma_m = 0.15;
};

/// The landmarks seen from `pose_W`, in the sensor frame.
inline std::vector<core::Point2> scan_forest(const Forest& forest, const core::Pose2& pose_W,
                                             const ScanModel& model, Draw& draw) {
  std::vector<core::Point2> trees = forest.trees_W;
  const core::Point2 here = pose_W.translation();
  const std::size_t nearest = std::min<std::size_t>(model.nearest, trees.size());
  std::partial_sort(trees.begin(), trees.begin() + static_cast<std::ptrdiff_t>(nearest), trees.end(),
                    [&](const auto& a, const auto& b) { return (a - here).norm() < (b - here).norm(); });
  const double reach_m = (trees[nearest - 1] - here).norm();
  const core::Pose2 T_L_W = pose_W.inverse();
  std::vector<core::Point2> scan_L;
  for (std::size_t i = 0; i < nearest; ++i) {
    if (draw.uniform(0.0, 1.0) >= model.dropped_share) {
      scan_L.push_back(T_L_W * trees[i] +
                       core::Point2{draw.normal(model.sigma_m), draw.normal(model.sigma_m)});
    }
  }
  for (std::uint32_t i = 0; i < model.spurious; ++i) {
    const double r = reach_m * std::sqrt(draw.uniform(0.0, 1.0));
    const double a = draw.uniform(-std::numbers::pi, std::numbers::pi);
    scan_L.emplace_back(r * std::cos(a), r * std::sin(a));
  }
  return scan_L;
}

/// A pose in the inner part of the forest, so that the scan's trees lie all around.
inline core::Pose2 pose_in(const Forest& forest, Draw& draw) {
  const double reach = 0.5 * forest.side_m - 15.0;
  return {draw.uniform(-reach, reach), draw.uniform(-reach, reach),
          draw.uniform(-std::numbers::pi, std::numbers::pi)};
}

inline std::vector<core::ScanLandmark> as_landmarks(const std::vector<core::Point2>& scan_L) {
  std::vector<core::ScanLandmark> landmarks;
  for (std::size_t i = 0; i < scan_L.size(); ++i) {
    landmarks.push_back({scan_L[i], static_cast<double>(scan_L.size() - i)});
  }
  return landmarks;
}

/// Whether `pose` is what DESIGN calls right: within 1 m and 2 degrees of `truth`.
inline bool is_right(const core::Pose2& pose, const core::Pose2& truth) {
  const core::Pose2 error = truth.inverse() * pose;
  return error.translation().norm() <= 1.0 && std::abs(error.heading_rad) <= 2.0 * std::numbers::pi / 180.0;
}

}  // namespace slamsensor::tests
