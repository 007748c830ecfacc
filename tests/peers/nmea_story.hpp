#pragma once

#include "firmware/config/sensor_config.hpp"
#include "firmware/serving/epoch_sink.hpp"
#include "firmware/status/sensor_status.hpp"

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/LocalCartesian.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>

namespace slamsensor::tests {

/// What becomes true of a sensor, chapter by chapter: a fix at a place that it was kidnapped to, an ambiguous
/// scan, one without a fix, a lost device, a fix that got stale. Each chapter is said on the standard output
/// as it begins.
class NmeaStory {
 public:
  NmeaStory(const std::optional<firmware::Datum>& datum, unsigned seed) : datum_(datum), random_(seed) {}

  firmware::SensorStatus& status() { return status_; }
  [[nodiscard]] hal::Stamp next() const { return next_; }

  /// Goes on to the next chapter and says what it is.
  void turn(const firmware::OutputTime& at) {
    next_ = at.monotonic + hal::from_seconds(uniform(0.3, 1.8));
    const int kind = std::uniform_int_distribution(0, 9)(random_);
    static constexpr std::array<core::FixReason, 3> kReasons = {
        core::FixReason::NoOverlap, core::FixReason::TooFewLandmarks, core::FixReason::Moved};
    core::Fix& fix = status_.report.fix;
    if (kind < 5) {
      scan(at);
      fix.status = core::FixStatus::Fix;
      fix.reason = core::FixReason::None;
      status_.state = firmware::SensorState::Fixed;
    } else if (kind == 5) {
      scan(at);
      fix.status = core::FixStatus::Ambiguous;
      fix.reason = core::FixReason::Symmetric;
      status_.state = firmware::SensorState::Ambiguous;
    } else if (kind < 8) {
      scan(at);
      fix.status = core::FixStatus::NoFix;
      fix.reason = kReasons[static_cast<std::size_t>(uniform(0.0, 2.99))];
      status_.state = firmware::SensorState::Lost;
    } else {
      fix.status = core::FixStatus::NoFix;
      fix.reason = kind == 8 ? core::FixReason::Device : core::FixReason::Stale;
      status_.state = kind == 8 ? firmware::SensorState::Faulted : firmware::SensorState::Lost;
    }
    tell(at);
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

  /// A scan that has just ended somewhere; the place told is off by what its covariance says.
  void scan(const firmware::OutputTime& at) {
    core::Fix& fix = status_.report.fix;
    truth_ = {uniform(-300.0, 300.0), uniform(-300.0, 300.0), uniform(-3.14, 3.14)};
    const double sigma_x_m = uniform(0.02, 0.5);
    const double sigma_y_m = uniform(0.02, 0.5);
    const double correlation = uniform(-0.8, 0.8);
    fix.covariance << sigma_x_m * sigma_x_m, correlation * sigma_x_m * sigma_y_m, 0.0,
        correlation * sigma_x_m * sigma_y_m, sigma_y_m * sigma_y_m, 0.0, 0.0, 0.0, 1e-6;
    std::normal_distribution<double> normal;
    const double a = normal(random_);
    const double b = normal(random_);
    fix.pose_W = truth_;
    fix.pose_W.x_m += sigma_x_m * a;
    fix.pose_W.y_m += sigma_y_m * (correlation * a + std::sqrt(1.0 - correlation * correlation) * b);
    fix.time = {at.utc - std::chrono::seconds(4), at.utc - std::chrono::seconds(2), at.utc, at.monotonic};
    fix.matches = static_cast<std::uint32_t>(uniform(4.0, 20.0));
    fix.landmarks_seen = 25;
    ++fix.scan;
  }

  struct Place {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
  };
  /// By GeographicLib alone, the map turned by hand.
  [[nodiscard]] Place place(double x_m, double y_m) const {
    const double beta = datum_->bearing_deg * core::kDegree;
    const GeographicLib::LocalCartesian plane(datum_->latitude_deg, datum_->longitude_deg, datum_->height_m);
    Place place;
    double height_m = 0.0;
    plane.Reverse(x_m * std::sin(beta) - y_m * std::cos(beta), x_m * std::cos(beta) + y_m * std::sin(beta),
                  0.0, place.latitude_deg, place.longitude_deg, height_m);
    return place;
  }

  void tell(const firmware::OutputTime& at) const {
    const core::Fix& fix = status_.report.fix;
    std::printf("{\"utc\": %.6f, \"status\": %d", static_cast<double>(at.utc.count()) * 1e-9,
                static_cast<int>(fix.status));
    if (datum_ && fix.status == core::FixStatus::Fix) {
      const Place told = place(fix.pose_W.x_m, fix.pose_W.y_m);
      const Place ahead = place(fix.pose_W.x_m + 0.5 * std::cos(fix.pose_W.heading_rad),
                                fix.pose_W.y_m + 0.5 * std::sin(fix.pose_W.heading_rad));
      const Place truth = place(truth_.x_m, truth_.y_m);
      double north_azimuth_deg = 0.0;
      double unused = 0.0;
      double distance_m = 0.0;
      const GeographicLib::Geodesic& earth = GeographicLib::Geodesic::WGS84();
      earth.Inverse(told.latitude_deg, told.longitude_deg, ahead.latitude_deg, ahead.longitude_deg,
                    distance_m, north_azimuth_deg, unused);
      double error_azimuth_deg = 0.0;
      earth.Inverse(told.latitude_deg, told.longitude_deg, truth.latitude_deg, truth.longitude_deg,
                    distance_m, error_azimuth_deg, unused);
      std::printf(", \"lat\": %.11f, \"lon\": %.11f, \"heading\": %.6f, \"east_m\": %.6f, \"north_m\": %.6f",
                  told.latitude_deg, told.longitude_deg, std::fmod(north_azimuth_deg + 360.0, 360.0),
                  distance_m * std::sin(error_azimuth_deg * core::kDegree),
                  distance_m * std::cos(error_azimuth_deg * core::kDegree));
    }
    std::printf("}\n");
    std::fflush(stdout);
  }

  std::optional<firmware::Datum> datum_;
  std::mt19937_64 random_;
  firmware::SensorStatus status_;
  core::Pose2 truth_;
  hal::Stamp next_{};
};

}  // namespace slamsensor::tests
