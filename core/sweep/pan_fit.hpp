#pragma once

#include "core/memory/bounded_vector.hpp"
#include "core/sweep/sweep_config.hpp"
#include "core/sweep/swept_line.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamsensor::core {

/// Why a line's pan could not be told.
enum class PanFitProblem : std::uint8_t {
  TooFewPolls,      ///< fewer polls of the moving axis than asked for
  TooManyOutliers,  ///< the polls do not agree with one another
  WrongSpeed,       ///< the axis did not run at the speed it was told
  OffModel,         ///< it lagged or leapt on the way: an obstacle, lost steps
};

/// Where the pan axis was during one move, by the motion model of the unit (AxisPath) with a start time and a
/// relative error of its speed that were fitted to polls. Times are those of the polls: a latency common to
/// all of them is still in it. A value.
class PanFit {
 public:
  /// Rests at 0.
  PanFit() noexcept = default;

  [[nodiscard]] double pan_rad(std::chrono::nanoseconds at) const noexcept {
    return path_.position_at(elapsed_s(at));
  }
  /// Signed; 0 while the axis rests.
  [[nodiscard]] double speed_radps(std::chrono::nanoseconds at) const noexcept;
  /// 1 sigma of pan_rad(), from the scatter of the polls and how many there were.
  [[nodiscard]] double sigma_rad(std::chrono::nanoseconds at) const noexcept;
  /// Between these the axis moved.
  [[nodiscard]] std::chrono::nanoseconds begin() const noexcept { return stamp_of(0.0); }
  [[nodiscard]] std::chrono::nanoseconds end() const noexcept { return stamp_of(path_.duration_s); }

  /// How much slower (positive) or faster than told the axis ran, as a share.
  [[nodiscard]] double slowness() const noexcept { return slope_; }
  /// Of the polls that were used, s: how much earlier or later than fitted the axis was where they found it.
  [[nodiscard]] double residual_rms_s() const noexcept { return residual_rms_s_; }
  [[nodiscard]] std::uint32_t polls_used() const noexcept { return polls_used_; }
  [[nodiscard]] std::uint32_t polls_left_out() const noexcept { return polls_left_out_; }

 private:
  friend class PanFitter;

  [[nodiscard]] double elapsed_s(std::chrono::nanoseconds at) const noexcept;
  [[nodiscard]] std::chrono::nanoseconds stamp_of(double elapsed_s) const noexcept;

  AxisPath path_;
  std::chrono::nanoseconds origin_{};  // of the first poll used; keeps seconds small
  double centre_s_ = 0.0;              // elapsed at which offset and slope are uncorrelated
  double offset_s_ = 0.0;              // stamp - origin - elapsed at the centre
  double slope_ = 0.0;                 // change of that per elapsed
  double offset_var_s2_ = 0.0;
  double slope_var_ = 0.0;
  double residual_rms_s_ = 0.0;
  std::uint32_t polls_used_ = 0;
  std::uint32_t polls_left_out_ = 0;
};

/// Fits PanFit. A poll of the moving axis says when the axis was at a place, so that the fit is a straight
/// line of time over the model's time, robust (Huber, then Tukey), with what is known of the unit's clock as
/// a prior of its slope. No allocation after construction; one thread.
class PanFitter {
 public:
  /// Room for `polls_max` polls of one line; more are not looked at.
  PanFitter(Arena& arena, const PanFitConfig& config, std::size_t polls_max) noexcept;

  /// The fit of one move from its polls (pan only; in the order of time, others than those on the way are
  /// left out). `resolution_rad` is that of one position.
  [[nodiscard]] Outcome<PanFit, PanFitProblem> fit(const AxisPath& path, double resolution_rad,
                                                   std::span<const TimedAngle> polls) noexcept;

 private:
  struct Point {
    double elapsed_s;  // by the model, when the axis was at the place polled
    double lag_s;      // stamp - origin - elapsed
    double sigma_s;    // expected of the lag
    double weight;     // of the robust fit, in [0, 1]
    double residual_s;
  };

  void collect(PanFit& fit, double resolution_rad, std::span<const TimedAngle> polls) noexcept;
  [[nodiscard]] bool ran_at_another_speed() const noexcept;
  void solve(PanFit& fit) const noexcept;
  void update_residuals(const PanFit& fit) noexcept;
  [[nodiscard]] double robust_scale() noexcept;
  void weigh_huber() noexcept;
  void weigh_tukey() noexcept;
  void judge_points(PanFit& fit) const noexcept;
  [[nodiscard]] double common_rounding_s2(const PanFit& fit, double resolution_rad) const noexcept;
  [[nodiscard]] bool follows_model(const PanFit& fit) const noexcept;
  [[nodiscard]] double whole_position_rad(double position_rad, double resolution_rad) const noexcept;

  PanFitConfig config_;
  BoundedVector<Point> points_;
  BoundedVector<double> sorted_;
  double scale_ = 1.0;      // of the residuals, in expected sigmas
  double scale_min_ = 0.0;  // what is left of it with exact stamps
};

}  // namespace slamsensor::core
