#pragma once

#include "hal/pantilt/pan_tilt.hpp"

#include <cmath>
#include <numbers>

namespace slamsensor::tests {

/// The truth of one axis of a unit: where it is at any time, by a clock that is off, and with an obstacle on
/// its way if wanted.
class FakeAxis {
 public:
  double slowness = 0.0;            ///< share by which it is slower than told
  double stall_rad = std::nan("");  ///< a move that passes here stops ...
  double stall_s = 0.0;             ///< ... for so long; infinite: for good

  void begin(double target_rad, double speed_radps, const hal::AxisDynamics& dynamics, hal::Stamp at) {
    move_ = hal::MotionProfile(true_rad(at), target_rad, speed_radps, dynamics);
    begun_ = at;
    stalled_at_s_ = -1.0;
    const double way = (stall_rad - move_.start_rad()) / (move_.target_rad() - move_.start_rad());
    if (way > 0.0 && way < 1.0) {
      double early_s = 0.0;
      double late_s = move_.duration_s();
      for (int i = 0; i < 50; ++i) {
        const double middle_s = 0.5 * (early_s + late_s);
        const double there =
            (move_.position_rad(middle_s) - move_.start_rad()) / (move_.target_rad() - move_.start_rad());
        (there >= way ? late_s : early_s) = middle_s;
      }
      stalled_at_s_ = late_s;
    }
  }

  void halt(hal::Stamp at) {
    move_ = hal::MotionProfile(true_rad(at), true_rad(at), 1.0, {});
    begun_ = at;
  }

  [[nodiscard]] double true_rad(hal::Stamp at) const { return move_.position_rad(elapsed_s(at)); }
  [[nodiscard]] bool is_moving(hal::Stamp at) const {
    return at >= begun_ && elapsed_s(at) < move_.duration_s();
  }
  [[nodiscard]] const hal::MotionProfile& move() const { return move_; }
  [[nodiscard]] hal::Stamp begun() const { return begun_; }

 private:
  [[nodiscard]] double elapsed_s(hal::Stamp at) const {
    const double elapsed = hal::to_seconds(at - begun_) / (1.0 + slowness);
    if (stalled_at_s_ < 0.0 || elapsed < stalled_at_s_) {
      return elapsed;
    }
    return std::max(stalled_at_s_, elapsed - stall_s);
  }

  hal::MotionProfile move_;
  hal::Stamp begun_{};
  double stalled_at_s_ = -1.0;
};

}  // namespace slamsensor::tests
