#pragma once

#include "core/detection/landmark_detector.hpp"
#include "tests/support/in_arena.hpp"

#include <cmath>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

namespace slamsensor::core::detection_test {

/// A detector in an arena of its own.
class Detector : public tests::InArena<LandmarkDetector> {
 public:
  explicit Detector(const DetectionConfig& config, const Capacities& capacities = {})
      : InArena(config, capacities) {}
};

using Scanline = std::vector<Reading>;
using Scan = std::vector<Scanline>;

inline std::vector<ScanLandmark> detect(LandmarkDetector& detector, const Scan& scan) {
  for (const Scanline& scanline : scan) {
    detector.add_scanline(scanline);
  }
  const std::span<const ScanLandmark> found = detector.finish();
  return {found.begin(), found.end()};
}

inline std::vector<ScanLandmark> detect(const DetectionConfig& config, const Scan& scan) {
  Detector detector(config);
  return detect(*detector, scan);
}

/// 20 columns of 18 deg by 100 rows of 1 m, nothing discarded: small enough to work out by hand.
inline DetectionConfig hand_config() {
  DetectionConfig config;
  config.range_max_m = 100.0;
  config.range_step_m = 1.0;
  config.bearing_step_rad = 18.0 * kDegree;
  config.discard_share = 0.0;
  return config;
}

/// The middle of a column of `config`.
inline double middle_rad(const DetectionConfig& config, std::uint32_t column) {
  return (column + 0.5) * config.bearing_step_rad;
}

/// A scan of objects of random width and depth, some hiding others, over columns of `config`; the readings
/// stay away from the edges of cells, so that turning them by whole columns cannot move them to another cell.
inline Scan random_scan(const DetectionConfig& config, std::uint32_t columns, std::mt19937_64& random) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  Scan scan(1 + random() % 6);
  for (Scanline& scanline : scan) {
    double range_m = Reading::kNoReturn;
    for (std::uint32_t column = 0; column < columns; ++column) {
      if (share(random) < 0.4) {
        const auto row = static_cast<double>(random() % 60);
        range_m = share(random) < 0.4 ? Reading::kNoReturn
                                      : (row + 0.1 + 0.8 * share(random)) * config.range_step_m;
      }
      if (share(random) < 0.05) {
        continue;  // an empty column
      }
      const auto shots = 1 + random() % 3;
      for (std::size_t i = 0; i < shots; ++i) {
        const double pan_rad = (column + 0.05 + 0.9 * share(random)) * config.bearing_step_rad;
        scanline.push_back({pan_rad, 0.0, range_m});
      }
    }
  }
  return scan;
}

}  // namespace slamsensor::core::detection_test
