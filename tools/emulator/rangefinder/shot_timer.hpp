#pragma once

#include "hal/stamp.hpp"

#include <cstdint>

namespace slamsensor::tools {

/// The measuring clock of a rangefinder: shot k is at start + k periods, rounded to the nanosecond, so that
/// no error adds up. The period is that of a crystal that may be off by some parts per million.
class ShotTimer {
 public:
  /// Stopped. `crystal_ppm` > 0: the crystal is fast, shots come earlier than they should.
  explicit ShotTimer(double crystal_ppm) : speed_(1.0 + crystal_ppm * 1e-6) {}

  /// The first shot is at `at`, the others follow at `rate_hz` (positive).
  void start(hal::Stamp at, double rate_hz);

  /// The first shot is one period after `now`.
  void start_after(hal::Stamp now, double rate_hz);

  void stop() { next_ = hal::kNever; }

  [[nodiscard]] bool running() const { return next_ != hal::kNever; }

  /// When the next shot is due; hal::kNever while stopped.
  [[nodiscard]] hal::Stamp next() const { return next_; }

  /// The shot at next() is done; next() is a period later.
  void advance();

 private:
  double speed_;
  double period_ns_ = 0.0;
  hal::Stamp origin_{};
  hal::Stamp next_ = hal::kNever;
  std::int64_t done_ = 0;
};

}  // namespace slamsensor::tools
