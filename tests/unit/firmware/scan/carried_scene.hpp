#pragma once

#include "core/sweep/swept_line.hpp"
#include "tests/support/fake_head.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

namespace slamsensor::firmware {

using core::Scanline;
using core::SweepDirection;

/// Where a sensor stands and looks.
struct Place {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;
};

/// An upright cylinder on level ground.
struct Column {
  double x_m = 0.0;
  double y_m = 0.0;
  double radius_m = 0.2;
  double height_m = 6.0;
};

/// Columns on level ground, 1.5 m under the sensor, seen line by line by a sensor that may move.
class CarriedScene {
 public:
  std::vector<Column> columns;
  std::function<Place(double time_s)> path = [](double) { return Place{}; };
  std::function<void(double time_s, std::vector<Column>&)> stir;  ///< moves columns; once for each line
  double noise_m = 0.1;
  double late_s = 0.0;    ///< by which readings are taken for later than they are
  double lean_rad = 0.0;  ///< of the mount, to the left
  std::uint64_t seed = 1;

  static constexpr double kSpeed_radps = 0.9;
  static constexpr double kPanMax_rad = 2.2;
  static constexpr double kLine_s = 2.0 * kPanMax_rad / kSpeed_radps + 0.5;
  static constexpr double kPitch_rad = 0.0018;

  /// Columns at random, 3 m to 40 m around.
  void scatter(std::size_t count) {
    std::mt19937_64 rng(seed * 7919);
    while (columns.size() < count) {
      const double bearing_rad = 2.0 * std::numbers::pi * tests::draw(rng);
      const double range_m = 3.0 + 37.0 * std::sqrt(tests::draw(rng));
      columns.push_back({range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad),
                         0.1 + 0.3 * tests::draw(rng), 2.0 + 6.0 * tests::draw(rng)});
    }
  }

  /// The scanline `number`, at `tilt_rad`; valid until the next.
  const Scanline& sweep(std::uint32_t number, double tilt_rad) {
    if (number == 0) {
      rng_.seed(seed);
    }
    const bool leftwards = number % 2 == 0;
    const double begin_s = number * kLine_s;
    if (stir) {
      stir(begin_s, columns);
    }
    readings_.clear();
    for (double way_rad = 0.0; way_rad < 2.0 * kPanMax_rad; way_rad += kPitch_rad) {
      const double pan_rad = leftwards ? way_rad - kPanMax_rad : kPanMax_rad - way_rad;
      const double late_rad = (leftwards ? 1.0 : -1.0) * late_s * kSpeed_radps;
      const Place place = path(begin_s + way_rad / kSpeed_radps);
      readings_.push_back({pan_rad + late_rad, tilt_rad, range_m(place, pan_rad, tilt_rad)});
    }
    stamps_.assign(readings_.size(), hal::from_seconds(begin_s));
    line_.readings = readings_;
    line_.stamps = stamps_;
    line_.tilt_rad = tilt_rad;
    line_.direction = leftwards ? SweepDirection::Leftwards : SweepDirection::Rightwards;
    line_.line = number;
    return line_;
  }

 private:
  double range_m(const Place& place, double pan_rad, double tilt_rad) {
    const double level_rad = tilt_rad + lean_rad * std::sin(pan_rad);
    const double bearing_rad =
        pan_rad + place.heading_rad - lean_rad * std::cos(pan_rad) * std::tan(tilt_rad);
    const double c = std::cos(bearing_rad);
    const double s = std::sin(bearing_rad);
    double nearest_m = level_rad < 0.0 ? -1.5 / std::tan(level_rad) : 1e9;
    for (const Column& column : columns) {
      const double along_m = (column.x_m - place.x_m) * c + (column.y_m - place.y_m) * s;
      const double aside_m = (column.y_m - place.y_m) * c - (column.x_m - place.x_m) * s;
      const double deep_m2 = column.radius_m * column.radius_m - aside_m * aside_m;
      if (along_m > 0.0 && deep_m2 > 0.0) {
        const double hit_m = along_m - std::sqrt(deep_m2);
        const double above_m = 1.5 + hit_m * std::tan(level_rad);
        nearest_m = above_m < column.height_m ? std::min(nearest_m, hit_m) : nearest_m;
      }
    }
    if (nearest_m > 200.0) {
      return core::Reading::kNoReturn;
    }
    const double off_m = noise_m * (tests::draw(rng_) + tests::draw(rng_) + tests::draw(rng_) - 1.5) * 2.0;
    return std::max(0.1, nearest_m / std::cos(level_rad) + off_m);
  }

  std::mt19937_64 rng_;
  std::vector<core::Reading> readings_;
  std::vector<hal::Stamp> stamps_;
  Scanline line_;
};

}  // namespace slamsensor::firmware
