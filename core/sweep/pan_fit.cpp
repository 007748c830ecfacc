#include "core/sweep/pan_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace slamsensor::core {
namespace {

constexpr int kRounds = 12;          // of each robust weighting; they settle after four or five
constexpr double kHuber = 1.345;     // sigmas; 95 % efficient with normal residuals
constexpr double kTukey = 4.685;     // the same
constexpr double kToSigma = 1.4826;  // median of absolute residuals to standard deviation
constexpr double kScaleMax = 3.0;    // more scatter than the stamps promise is not believed to be scatter
constexpr double kEndSteps = 1.5;    // polls nearer to the ends of the way may be of the resting axis
constexpr std::size_t kStretches = 8;
constexpr double kStretchSigmas = 5.0;
constexpr double kStretchClip = 3.0;

/// When `path` is at `position_rad`, which lies on its way.
double elapsed_at(const AxisPath& path, double position_rad) noexcept {
  const bool leftwards = path.target_rad > path.start_rad;
  double early_s = 0.0;
  double late_s = path.duration_s;
  for (int i = 0; i < 50; ++i) {
    const double middle_s = 0.5 * (early_s + late_s);
    const bool passed = (path.position_at(middle_s) >= position_rad) == leftwards;
    (passed ? late_s : early_s) = middle_s;
  }
  return 0.5 * (early_s + late_s);
}

double square(double x) noexcept {
  return x * x;
}

}  // namespace

double PanFit::elapsed_s(std::chrono::nanoseconds at) const noexcept {
  return centre_s_ + (seconds_of(at - origin_) - offset_s_ - centre_s_) / (1.0 + slope_);
}

std::chrono::nanoseconds PanFit::stamp_of(double elapsed_s) const noexcept {
  return origin_ + from_seconds(centre_s_ + offset_s_ + (1.0 + slope_) * (elapsed_s - centre_s_));
}

double PanFit::speed_radps(std::chrono::nanoseconds at) const noexcept {
  return path_.speed_at(elapsed_s(at)) / (1.0 + slope_);
}

double PanFit::sigma_rad(std::chrono::nanoseconds at) const noexcept {
  const double from_centre_s = elapsed_s(at) - centre_s_;
  return std::abs(speed_radps(at)) * std::sqrt(offset_var_s2_ + slope_var_ * square(from_centre_s));
}

PanFitter::PanFitter(Arena& arena, const PanFitConfig& config, std::size_t polls_max) noexcept
    : config_(config),
      points_(arena, "points of a pan fit", polls_max),
      sorted_(arena, "residuals of a pan fit", polls_max) {
}

Outcome<PanFit, PanFitProblem> PanFitter::fit(const AxisPath& path, double resolution_rad,
                                              std::span<const TimedAngle> polls) noexcept {
  PanFit fit;
  fit.path_ = path;
  collect(fit, resolution_rad, polls);
  if (points_.size() < config_.polls_min || points_.size() < 3) {
    return PanFitProblem::TooFewPolls;
  }
  if (ran_at_another_speed()) {
    return PanFitProblem::WrongSpeed;
  }
  for (int round = 0; round < 2 * kRounds; ++round) {
    solve(fit);
    update_residuals(fit);
    scale_ = robust_scale();
    if (round < kRounds) {
      weigh_huber();
    } else {
      weigh_tukey();
    }
  }
  solve(fit);
  update_residuals(fit);
  judge_points(fit);
  fit.offset_var_s2_ += common_rounding_s2(fit, resolution_rad);
  if (fit.polls_used_ < config_.polls_min ||
      fit.polls_left_out_ > config_.outliers_max_share * static_cast<double>(points_.size())) {
    return PanFitProblem::TooManyOutliers;
  }
  if (std::abs(fit.slope_) > config_.speed_error_max) {
    return PanFitProblem::WrongSpeed;
  }
  if (!follows_model(fit)) {
    return PanFitProblem::OffModel;
  }
  return fit;
}

double PanFitter::whole_position_rad(double position_rad, double resolution_rad) const noexcept {
  switch (config_.rounding) {
    case PositionRounding::Nearest:
      return position_rad;
    case PositionRounding::Down:
      return position_rad + 0.5 * resolution_rad;
    case PositionRounding::TowardZero:
      break;
  }
  const bool at_zero = std::abs(position_rad) < 0.5 * resolution_rad;  // rounded from both sides
  return at_zero ? position_rad : position_rad + std::copysign(0.5 * resolution_rad, position_rad);
}

void PanFitter::collect(PanFit& fit, double resolution_rad, std::span<const TimedAngle> polls) noexcept {
  points_.clear();
  scale_ = 1.0;
  scale_min_ = 0.0;
  const AxisPath& path = fit.path_;
  const double lower_rad = std::min(path.start_rad, path.target_rad) + kEndSteps * resolution_rad;
  const double upper_rad = std::max(path.start_rad, path.target_rad) - kEndSteps * resolution_rad;
  for (const TimedAngle& poll : polls) {
    if (poll.axis != SweepAxis::Pan || !(poll.position_rad > lower_rad) || !(poll.position_rad < upper_rad) ||
        points_.full()) {
      continue;
    }
    if (points_.empty()) {
      fit.origin_ = poll.stamp;
    }
    const double elapsed_s = elapsed_at(path, whole_position_rad(poll.position_rad, resolution_rad));
    const double speed_radps = std::abs(path.speed_at(elapsed_s));
    if (!(speed_radps > 0.0)) {
      continue;
    }
    const double rounding_s = std::max(1e-6, resolution_rad / speed_radps / std::sqrt(12.0));
    const double variance_s2 =
        square(seconds_of(poll.half_width)) / 3.0 + square(config_.poll_jitter_s) + square(rounding_s);
    const double sigma_s = std::sqrt(variance_s2);
    scale_min_ += rounding_s / sigma_s;
    static_cast<void>(points_.try_push_back(
        {elapsed_s, seconds_of(poll.stamp - fit.origin_) - elapsed_s, sigma_s, 1.0, 0.0}));
  }
  scale_min_ /= std::max(1.0, static_cast<double>(points_.size()));
}

/// Whether both halves of the way tell the same of the speed, and more than may be.
bool PanFitter::ran_at_another_speed() const noexcept {
  const auto slowness = [](std::span<const Point> points) {
    double sum_x = 0.0;
    double sum_y = 0.0;
    for (const Point& point : points) {
      sum_x += point.elapsed_s;
      sum_y += point.lag_s;
    }
    const auto count = static_cast<double>(points.size());
    double sum_xx = 0.0;
    double sum_xy = 0.0;
    for (const Point& point : points) {
      sum_xx += square(point.elapsed_s - sum_x / count);
      sum_xy += (point.elapsed_s - sum_x / count) * (point.lag_s - sum_y / count);
    }
    return sum_xx > 0.0 ? sum_xy / sum_xx : 0.0;
  };
  const std::span<const Point> all = points_.span();
  const double first = slowness(all.first(all.size() / 2));
  const double second = slowness(all.last(all.size() / 2));
  const double noise = 6.0 * points_[0].sigma_s / points_.back().elapsed_s;
  return std::min(std::abs(first), std::abs(second)) > config_.speed_error_max + noise &&
         first * second > 0.0;
}

void PanFitter::solve(PanFit& fit) const noexcept {
  double sum_w = 0.0;
  double sum_x = 0.0;
  double sum_y = 0.0;
  for (const Point& point : points_) {
    const double w = point.weight / square(scale_ * point.sigma_s);
    sum_w += w;
    sum_x += w * point.elapsed_s;
    sum_y += w * point.lag_s;
  }
  if (!(sum_w > 0.0)) {
    return;
  }
  fit.centre_s_ = sum_x / sum_w;
  fit.offset_s_ = sum_y / sum_w;
  double sum_xx = 1.0 / square(std::max(1e-9, config_.speed_error_sigma));
  double sum_xy = 0.0;
  for (const Point& point : points_) {
    const double w = point.weight / square(scale_ * point.sigma_s);
    sum_xx += w * square(point.elapsed_s - fit.centre_s_);
    sum_xy += w * (point.elapsed_s - fit.centre_s_) * (point.lag_s - fit.offset_s_);
  }
  fit.slope_ = sum_xy / sum_xx;
  fit.offset_var_s2_ = 1.0 / sum_w;
  fit.slope_var_ = 1.0 / sum_xx;
}

void PanFitter::update_residuals(const PanFit& fit) noexcept {
  for (Point& point : points_) {
    point.residual_s = point.lag_s - fit.offset_s_ - fit.slope_ * (point.elapsed_s - fit.centre_s_);
  }
}

/// Never below what rounding to positions alone makes: when polls come in step with the axis, more than half
/// of them can be off by just the same, and their median says nothing.
double PanFitter::robust_scale() noexcept {
  const auto count = static_cast<std::ptrdiff_t>(points_.size());
  static_cast<void>(sorted_.try_resize(points_.size()));
  std::transform(points_.begin(), points_.end(), sorted_.begin(),
                 [](const Point& point) { return std::abs(point.residual_s) / point.sigma_s; });
  const auto middle = sorted_.begin() + count / 2;
  std::nth_element(sorted_.begin(), middle, sorted_.begin() + count);
  return std::max(scale_min_, std::min(kScaleMax, kToSigma * *middle));
}

void PanFitter::weigh_huber() noexcept {
  for (Point& point : points_) {
    const double off = std::abs(point.residual_s) / (scale_ * point.sigma_s);
    point.weight = off <= kHuber ? 1.0 : kHuber / off;
  }
}

void PanFitter::weigh_tukey() noexcept {
  for (Point& point : points_) {
    const double off = std::abs(point.residual_s) / (kTukey * scale_ * point.sigma_s);
    point.weight = off < 1.0 ? square(1.0 - square(off)) : 0.0;
  }
}

void PanFitter::judge_points(PanFit& fit) const noexcept {
  double sum_s2 = 0.0;
  for (const Point& point : points_) {
    if (point.weight > 0.0) {
      ++fit.polls_used_;
      sum_s2 += square(point.residual_s);
    } else {
      ++fit.polls_left_out_;
    }
  }
  fit.residual_rms_s_ = std::sqrt(sum_s2 / std::max(1.0, static_cast<double>(fit.polls_used_)));
}

/// Variance of the rounding that all polls share. Polls that come in step with the axis (its positions per
/// poll a whole number) are all rounded alike, and no number of them helps; those spread over the fractions
/// of a position, or that scatter as rounding does, share nothing. In between, the length of their mean on
/// the circle of fractions and the scatter that is missing tell.
double PanFitter::common_rounding_s2(const PanFit& fit, double resolution_rad) const noexcept {
  double sum_cos = 0.0;
  double sum_sin = 0.0;
  double sum_s2 = 0.0;
  for (const Point& point : points_) {
    const double elapsed_s = point.elapsed_s + point.residual_s;
    const double turns = fit.path_.position_at(elapsed_s) / resolution_rad;
    sum_cos += std::cos(2.0 * std::numbers::pi * turns);
    sum_sin += std::sin(2.0 * std::numbers::pi * turns);
    sum_s2 += square(resolution_rad / fit.path_.speed_at(point.elapsed_s)) / 12.0;
  }
  const auto count = static_cast<double>(points_.size());
  const double alike = square(sum_cos / count) + square(sum_sin / count);
  return alike * std::max(0.0, sum_s2 / count - square(fit.residual_rms_s_));
}

bool PanFitter::follows_model(const PanFit& fit) const noexcept {
  const std::size_t stretches = std::min(kStretches, points_.size() / 3);
  for (std::size_t stretch = 0; stretch < stretches; ++stretch) {
    const std::size_t first = points_.size() * stretch / stretches;
    const std::size_t last = points_.size() * (stretch + 1) / stretches;
    double sum_w = 0.0;
    double sum_s = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      const Point& point = points_[i];
      const double limit_s = kStretchClip * scale_ * point.sigma_s;
      const double w = 1.0 / square(scale_ * point.sigma_s);
      sum_w += w;
      sum_s += w * std::clamp(point.residual_s, -limit_s, limit_s);
    }
    const double mean_s = sum_s / sum_w;
    const double middle_radps = std::abs(fit.path_.speed_at(points_[(first + last) / 2].elapsed_s));
    if (std::abs(mean_s) * middle_radps > config_.path_tolerance_rad &&
        std::abs(mean_s) * std::sqrt(sum_w) > kStretchSigmas) {
      return false;
    }
  }
  return true;
}

}  // namespace slamsensor::core
