#include "core/sweep/scan_assembler.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamsensor::core {
namespace {

constexpr double kTiltStepsMax = 1.5;  // polls of a resting axis differ by at most one position
constexpr double kSteadyShare = 0.999;

constexpr LineRejection rejection(PanFitProblem problem) noexcept {
  switch (problem) {
    case PanFitProblem::TooFewPolls:
      return LineRejection::LinesTooFewPolls;
    case PanFitProblem::TooManyOutliers:
      return LineRejection::LinesTooManyOutliers;
    case PanFitProblem::WrongSpeed:
      return LineRejection::LinesWrongSpeed;
    case PanFitProblem::OffModel:
      break;
  }
  return LineRejection::LinesOffModel;
}

/// How long after the start of `move` it runs steadily.
double ramp_s(const AxisPath& move) noexcept {
  const double middle_s = 0.5 * move.duration_s;
  const double steady_radps = kSteadyShare * std::abs(move.speed_at(middle_s));
  double early_s = 0.0;
  double late_s = middle_s;
  if (std::abs(move.speed_at(0.0)) >= steady_radps) {
    return 0.0;
  }
  for (int i = 0; i < 40; ++i) {
    const double between_s = 0.5 * (early_s + late_s);
    (std::abs(move.speed_at(between_s)) >= steady_radps ? late_s : early_s) = between_s;
  }
  return late_s;
}

}  // namespace

ScanAssembler::ScanAssembler(Arena& arena, const AssemblerConfig& config,
                             const PanFitConfig& pan_fit) noexcept
    : fitter_(arena, pan_fit, config.polls_per_line_max),
      late_data_(from_seconds(config.late_data_s)),
      samples_(arena, "range samples of a line", config.readings_per_line_max),
      polls_(arena, "polls of a line", config.polls_per_line_max),
      half_widths_(arena, "half widths of a line's polls", config.polls_per_line_max),
      readings_(arena, "readings of a line", config.readings_per_line_max),
      stamps_(arena, "stamps of a line", config.readings_per_line_max) {
}

void ScanAssembler::begin_line(const LineStart& start) noexcept {
  start_ = start;
  samples_.clear();
  polls_.clear();
  readings_.clear();
  stamps_.clear();
  state_ = State::Open;
}

void ScanAssembler::end_line(const AxisPath& move, std::chrono::nanoseconds now) noexcept {
  if (state_ == State::Open) {
    move_ = move;
    due_ = now + late_data_;
    state_ = State::Closing;
  }
}

void ScanAssembler::add(const TimedRange& sample) noexcept {
  if (state_ != State::Idle && !samples_.try_push_back(sample)) {
    counters_.count(AssemblerEvent::ReadingsOverflow);
  }
}

void ScanAssembler::add(const TimedAngle& sample) noexcept {
  if (state_ != State::Idle && !polls_.try_push_back(sample)) {
    counters_.count(AssemblerEvent::PollsOverflow);
  }
}

std::optional<Outcome<Scanline, LineRejection>> ScanAssembler::step(std::chrono::nanoseconds now,
                                                                    const Latency& latency) noexcept {
  if (state_ != State::Closing || now < due_) {
    return std::nullopt;
  }
  state_ = State::Idle;
  auto line = assemble(latency);
  counters_.count(line ? AssemblerEvent::LinesFinished : line.error());
  return line;
}

Outcome<Scanline, LineRejection> ScanAssembler::assemble(const Latency& latency) noexcept {
  const auto fit = fitter_.fit(move_, start_.pan_resolution_rad, polls_.span());
  if (!fit) {
    return rejection(fit.error());
  }
  fit_ = *fit;
  if (!measure_tilt()) {
    return LineRejection::LinesTiltMoved;
  }
  fill_readings(latency.latency_s);
  if (readings_.empty()) {
    return LineRejection::LinesNoReadings;
  }
  return describe(latency);
}

bool ScanAssembler::measure_tilt() noexcept {
  double sum_rad = 0.0;
  double least_rad = start_.tilt_rad;
  double greatest_rad = start_.tilt_rad;
  std::size_t count = 0;
  for (const TimedAngle& poll : polls_) {
    if (poll.axis == SweepAxis::Tilt && poll.stamp >= fit_.begin() && poll.stamp <= fit_.end()) {
      sum_rad += poll.position_rad;
      least_rad = std::min(least_rad, poll.position_rad);
      greatest_rad = std::max(greatest_rad, poll.position_rad);
      ++count;
    }
  }
  tilt_rad_ = count > 0 ? sum_rad / static_cast<double>(count) : start_.tilt_rad;
  return greatest_rad - least_rad <= kTiltStepsMax * start_.tilt_resolution_rad;
}

void ScanAssembler::fill_readings(double latency_s) noexcept {
  const std::chrono::nanoseconds latency = from_seconds(latency_s);
  const std::chrono::nanoseconds begin = fit_.begin();
  const std::chrono::nanoseconds end = fit_.end();
  for (const TimedRange& sample : samples_) {
    const std::chrono::nanoseconds at = sample.stamp + latency;
    if (at >= begin && at <= end) {
      add_reading(sample, fit_.pan_rad(at));
    }
  }
}

void ScanAssembler::add_reading(const TimedRange& sample, double pan_rad) noexcept {
  double range_m = Reading::kNoReturn;
  switch (sample.echo) {
    case EchoKind::None:
      break;
    case EchoKind::Return:
      if (!(sample.range_m > 0.0) || !std::isfinite(sample.range_m)) {
        counters_.count(AssemblerEvent::ReadingsFault);
        return;
      }
      range_m = sample.range_m;
      break;
    case EchoKind::Weak:
      counters_.count(AssemblerEvent::ReadingsWeak);
      return;
    case EchoKind::Saturated:
      counters_.count(AssemblerEvent::ReadingsSaturated);
      return;
    case EchoKind::Fault:
      counters_.count(AssemblerEvent::ReadingsFault);
      return;
  }
  static_cast<void>(readings_.try_push_back({pan_rad, tilt_rad_, range_m}));  // as much room as samples
  static_cast<void>(stamps_.try_push_back(sample.stamp));
}

double ScanAssembler::median_half_width_s() noexcept {
  half_widths_.clear();
  for (const TimedAngle& poll : polls_) {
    if (poll.axis == SweepAxis::Pan && poll.stamp >= fit_.begin() && poll.stamp <= fit_.end()) {
      static_cast<void>(half_widths_.try_push_back(poll.half_width));
    }
  }
  if (half_widths_.empty()) {
    return 0.0;
  }
  auto* const middle = half_widths_.begin() + half_widths_.size() / 2;
  std::nth_element(half_widths_.begin(), middle, half_widths_.end());
  return seconds_of(*middle);
}

Scanline ScanAssembler::describe(const Latency& latency) noexcept {
  const std::chrono::nanoseconds middle = fit_.begin() + (fit_.end() - fit_.begin()) / 2;
  const double speed_radps = std::abs(fit_.speed_radps(middle));
  const double ramp = ramp_s(move_);
  const double from_rad = move_.position_at(ramp);
  const double to_rad = move_.position_at(move_.duration_s - ramp);
  const double ends_s =
      fit_.sigma_rad(fit_.begin()) / std::max(1e-9, std::abs(fit_.speed_radps(fit_.begin())));
  const double middle_s = fit_.sigma_rad(middle) / std::max(1e-9, speed_radps);
  // Mean over the line of a variance that grows with the square of the distance from its middle.
  const double mean_s2 = middle_s * middle_s + std::max(0.0, ends_s * ends_s - middle_s * middle_s) / 3.0;
  const double half_width_s = median_half_width_s();
  const double wider_s = std::max(0.0, half_width_s - latency.half_width_s) / std::numbers::sqrt3;
  Scanline line;
  line.half_width_s = half_width_s;
  line.readings = readings_.span();
  line.stamps = stamps_.span();
  line.tilt_rad = tilt_rad_;
  line.direction =
      move_.target_rad > move_.start_rad ? SweepDirection::Leftwards : SweepDirection::Rightwards;
  line.pan_sigma_rad = speed_radps * std::hypot(std::sqrt(mean_s2), latency.sigma_s, wider_s);
  line.line = start_.line;
  line.pan_radps = speed_radps;
  line.steady_min_rad = std::min(from_rad, to_rad);
  line.steady_max_rad = std::max(from_rad, to_rad);
  line.fit_sigma_s = std::sqrt(mean_s2);
  line.latency_s = latency.latency_s;
  return line;
}

}  // namespace slamsensor::core
