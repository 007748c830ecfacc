#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "hal/rangefinder/rangefinder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <numbers>
#include <random>
#include <string_view>
#include <vector>

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

namespace slamsensor::tests {

/// Uniform in [0, 1), the same with every standard library.
inline double draw(std::mt19937_64& rng) {
  return static_cast<double>(rng() >> 11U) * 0x1.0p-53;
}

/// How late and how exact a FakePanTilt tells its positions.
struct FakePanTiltConfig {
  double resolution_rad = std::numbers::pi / 3500.0;
  double poll_hz = 40.0;
  double rest_poll_hz = 2.0;
  double latency_s = 0.0;      ///< stamp of a position after the unit was asked
  double jitter_s = 0.0;       ///< the unit looks up to so much after it was asked, uniform
  double delayed_share = 0.0;  ///< of the polls: stamped 5 to 60 ms later still, unnoticed
  double half_width_s = 0.002;
  double delivery_s = 0.004;  ///< from the stamp until the sample can be taken
  double command_s = 0.008;   ///< from move() to motion, up to 1 ms more, uniform
  double slowness = 0.0;      ///< share by which the unit's clock is slow
  double base_speed_radps = 1000.0 * std::numbers::pi / 3500.0;
  double acceleration_radps2 = 2000.0 * std::numbers::pi / 3500.0;
  std::uint64_t seed = 1;
};

/// A pan-tilt unit at the level of values: no bytes, its truth known.
class FakePanTilt final : public hal::PanTilt {
 public:
  hal::DeviceState device_state = hal::DeviceState::Ready;
  hal::MoveStatus answer = hal::MoveStatus::Accepted;  ///< of the moves to come
  int halts = 0;
  double held_up_s = 0.0;  ///< from now on, positions are stamped so much later and within so much more
  FakeAxis pan;
  FakeAxis tilt;

  explicit FakePanTilt(const FakePanTiltConfig& config) : config_(config), rng_(config.seed) {
    pan.slowness = config.slowness;
    const double step = config.resolution_rad;
    const hal::AxisDynamics dynamics{config.base_speed_radps, config.acceleration_radps2};
    info_.pan = {-3090 * step, 3090 * step, step, 31 * step, 2902 * step, dynamics};
    info_.tilt = {-907 * step, 604 * step, step, 31 * step, 2902 * step, dynamics};
    status_[0].polled = status_[1].polled = hal::Stamp{1};
  }

  void step(hal::Stamp now) noexcept override {
    poll(hal::Axis::Pan, now);
    poll(hal::Axis::Tilt, now);
    now_ = now;
  }
  [[nodiscard]] hal::DeviceState state() const noexcept override { return device_state; }
  [[nodiscard]] std::string_view problem() const noexcept override { return "fake unit is not ready"; }
  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept override { return {}; }
  [[nodiscard]] const hal::AxisStatus& axis(hal::Axis axis) const noexcept override {
    return status_[index(axis)];
  }
  [[nodiscard]] const hal::PanTiltInfo& info() const noexcept override { return info_; }
  [[nodiscard]] hal::PanTiltInfo& info() { return info_; }

  [[nodiscard]] hal::MoveStatus move(hal::Axis axis, double target_rad,
                                     double speed_radps) noexcept override {
    if (answer != hal::MoveStatus::Accepted) {
      return answer;
    }
    const hal::AxisInfo& limits = axis == hal::Axis::Pan ? info_.pan : info_.tilt;
    if (target_rad < limits.min_rad - 1e-9 || target_rad > limits.max_rad + 1e-9) {
      return hal::MoveStatus::OutOfRange;
    }
    hal::AxisStatus& status = status_[index(axis)];
    truth(axis).begin(target_rad, speed_radps, limits.dynamics,
                      now_ + hal::from_seconds(config_.command_s + 0.001 * draw(rng_)));
    status.move = truth(axis).move();
    status.begun = truth(axis).begun();
    status.moving = true;
    return answer;
  }

  [[nodiscard]] hal::MoveStatus halt() noexcept override {
    ++halts;
    pan.halt(now_);
    tilt.halt(now_);
    status_[0].moving = status_[1].moving = false;
    return hal::MoveStatus::Accepted;
  }

  [[nodiscard]] std::size_t take(std::span<hal::AxisSample> into) noexcept override {
    std::size_t count = 0;
    while (count < into.size() && !samples_.empty() && available(samples_.front()) <= now_) {
      into[count++] = samples_.front();
      samples_.pop_front();
    }
    return count;
  }

 private:
  static std::size_t index(hal::Axis axis) { return axis == hal::Axis::Pan ? 0 : 1; }
  FakeAxis& truth(hal::Axis axis) { return axis == hal::Axis::Pan ? pan : tilt; }
  [[nodiscard]] hal::Stamp available(const hal::AxisSample& sample) const {
    return sample.stamp + hal::from_seconds(config_.delivery_s);
  }

  void poll(hal::Axis axis, hal::Stamp now) {
    hal::Stamp& due = due_[index(axis)];
    hal::AxisStatus& status = status_[index(axis)];
    if (now < due || device_state != hal::DeviceState::Ready) {
      return;
    }
    due = now + hal::from_seconds(1.0 / (status.moving ? config_.poll_hz : config_.rest_poll_hz));
    const hal::Stamp looked = now + hal::from_seconds(config_.jitter_s * draw(rng_));
    const double position_rad =
        std::round(truth(axis).true_rad(looked) / config_.resolution_rad) * config_.resolution_rad;
    double late_s = config_.latency_s;
    if (config_.delayed_share > 0.0 && draw(rng_) < config_.delayed_share) {
      late_s += 0.005 + 0.055 * draw(rng_);
    }
    late_s += held_up_s;
    const hal::Stamp stamp = now + hal::from_seconds(late_s);
    samples_.push_back({stamp, hal::from_seconds(config_.half_width_s + held_up_s), position_rad, axis});
    status.position_rad = position_rad;
    status.polled = stamp;
    const bool there = std::abs(position_rad - status.move.target_rad()) < 0.5 * config_.resolution_rad;
    if (status.moving && there && !truth(axis).is_moving(now)) {
      status.moving = false;
    }
  }

  FakePanTiltConfig config_;
  std::mt19937_64 rng_;
  hal::PanTiltInfo info_;
  std::array<hal::AxisStatus, 2> status_;
  std::array<hal::Stamp, 2> due_{};
  std::deque<hal::AxisSample> samples_;
  hal::Stamp now_{};
};

/// How late and how often a FakeRangefinder tells its readings.
struct FakeRangefinderConfig {
  double rate_hz = 1000.0;
  double latency_s = 0.0;   ///< stamp of a reading after the time it was measured
  double jitter_s = 0.0;    ///< up to so much later still, uniform
  double phase_s = 0.0003;  ///< of its clock
  double delivery_s = 0.002;
  std::uint64_t seed = 2;
};

/// A reading by pan, tilt and time; only range_m and echo count.
using Scene = std::function<hal::RangeSample(double pan_rad, double tilt_rad, hal::Stamp at)>;

/// A rangefinder on a FakePanTilt, at the level of values. Remembers where it pointed at each reading.
class FakeRangefinder final : public hal::Rangefinder {
 public:
  hal::DeviceState device_state = hal::DeviceState::Ready;
  bool is_silent = false;  ///< Ready, but tells nothing
  double held_up_s = 0.0;  ///< by which readings are stamped later from now on
  std::string_view doubt;  ///< of the timing

  FakeRangefinder(const FakeRangefinderConfig& config, const FakePanTilt& mount, Scene scene)
      : config_(config), mount_(mount), scene_(std::move(scene)), rng_(config.seed) {
    info_.rate_hz = config.rate_hz;
  }

  void step(hal::Stamp now) noexcept override {
    while (shot_time() <= now) {
      shoot(shot_time());
      ++shots_;
    }
    now_ = now;
  }
  [[nodiscard]] hal::DeviceState state() const noexcept override { return device_state; }
  [[nodiscard]] std::string_view problem() const noexcept override { return "fake rangefinder is not ready"; }
  [[nodiscard]] std::string_view timing_doubt() const noexcept override { return doubt; }
  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept override { return {}; }
  [[nodiscard]] const hal::RangefinderInfo& info() const noexcept override { return info_; }

  [[nodiscard]] std::size_t take(std::span<hal::RangeSample> into) noexcept override {
    std::size_t count = 0;
    while (count < into.size() && !samples_.empty() &&
           samples_.front().stamp + hal::from_seconds(config_.delivery_s) <= now_) {
      into[count++] = samples_.front();
      samples_.pop_front();
    }
    return count;
  }

  /// Where the head really pointed when the reading stamped `stamp` was measured.
  [[nodiscard]] double true_pan_rad(hal::Stamp stamp) const {
    const auto found = std::lower_bound(truth_.begin(), truth_.end(), stamp,
                                        [](const Truth& truth, hal::Stamp at) { return truth.stamp < at; });
    return found == truth_.end() ? std::nan("") : found->pan_rad;
  }
  /// Forgets where it pointed so far.
  void forget_truth() { truth_.clear(); }

 private:
  struct Truth {
    hal::Stamp stamp;
    double pan_rad;
  };

  [[nodiscard]] hal::Stamp shot_time() const {
    return hal::from_seconds(config_.phase_s + static_cast<double>(shots_) / config_.rate_hz);
  }

  void shoot(hal::Stamp at) {
    if (device_state != hal::DeviceState::Ready || is_silent) {
      return;
    }
    const double pan_rad = mount_.pan.true_rad(at);
    hal::RangeSample sample = scene_(pan_rad, mount_.tilt.true_rad(at), at);
    sample.stamp = at + hal::from_seconds(config_.latency_s + held_up_s + config_.jitter_s * draw(rng_));
    samples_.push_back(sample);
    truth_.push_back({sample.stamp, pan_rad});
  }

  FakeRangefinderConfig config_;
  const FakePanTilt& mount_;
  Scene scene_;
  std::mt19937_64 rng_;
  hal::RangefinderInfo info_;
  std::deque<hal::RangeSample> samples_;
  std::deque<Truth> truth_;
  std::uint64_t shots_ = 0;
  hal::Stamp now_{};
};

}  // namespace slamsensor::tests
