#include "firmware/scan/scan_assembler.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace slamsensor::firmware {
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

/// Appends as many of `samples` as there is room for; returns how many are left over.
template <typename T>
std::size_t append(std::vector<T>& to, std::span<const T> samples) noexcept {
  const std::size_t count = std::min(samples.size(), to.capacity() - to.size());
  to.insert(to.end(), samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(count));
  return samples.size() - count;
}

/// How long after the start of `move` it runs steadily.
double ramp_s(const hal::MotionProfile& move) noexcept {
  const double middle_s = 0.5 * move.duration_s();
  const double steady_radps = kSteadyShare * std::abs(move.speed_radps(middle_s));
  double early_s = 0.0;
  double late_s = middle_s;
  if (std::abs(move.speed_radps(0.0)) >= steady_radps) {
    return 0.0;
  }
  for (int i = 0; i < 40; ++i) {
    const double between_s = 0.5 * (early_s + late_s);
    (std::abs(move.speed_radps(between_s)) >= steady_radps ? late_s : early_s) = between_s;
  }
  return late_s;
}

}  // namespace

ScanAssembler::ScanAssembler(const ScanConfig& scan, const PanFitConfig& pan_fit)
    : fitter_(pan_fit, scan.polls_per_line_max),
      late_data_(hal::from_seconds(scan.late_data_s)),
      counters_({"lines_finished", "lines_too_few_polls", "lines_too_many_outliers", "lines_wrong_speed",
                 "lines_off_model", "lines_tilt_moved", "lines_no_readings", "readings_weak",
                 "readings_saturated", "readings_fault", "readings_overflow", "polls_overflow"}) {
  samples_.reserve(scan.readings_per_line_max);
  readings_.reserve(scan.readings_per_line_max);
  stamps_.reserve(scan.readings_per_line_max);
  half_widths_.reserve(scan.polls_per_line_max);
  polls_.reserve(scan.polls_per_line_max);
}

void ScanAssembler::begin_line(const LineStart& start) noexcept {
  start_ = start;
  samples_.clear();
  polls_.clear();
  readings_.clear();
  stamps_.clear();
  state_ = State::Open;
}

void ScanAssembler::end_line(const hal::MotionProfile& move, hal::Stamp now) noexcept {
  if (state_ == State::Open) {
    move_ = move;
    due_ = now + late_data_;
    state_ = State::Closing;
  }
}

void ScanAssembler::add(std::span<const hal::RangeSample> samples) noexcept {
  if (state_ != State::Idle) {
    counters_.count(AssemblerEvent::ReadingsOverflow, append(samples_, samples));
  }
}

void ScanAssembler::add(std::span<const hal::AxisSample> samples) noexcept {
  if (state_ != State::Idle) {
    counters_.count(AssemblerEvent::PollsOverflow, append(polls_, samples));
  }
}

std::optional<tl::expected<Scanline, LineRejection>> ScanAssembler::step(hal::Stamp now,
                                                                         const Latency& latency) noexcept {
  if (state_ != State::Closing || now < due_) {
    return std::nullopt;
  }
  state_ = State::Idle;
  auto line = assemble(latency);
  counters_.count(line ? AssemblerEvent::LinesFinished : line.error());
  return line;
}

tl::expected<Scanline, LineRejection> ScanAssembler::assemble(const Latency& latency) noexcept {
  const auto fit = fitter_.fit(move_, start_.pan_resolution_rad, polls_);
  if (!fit) {
    return tl::unexpected(rejection(fit.error()));
  }
  fit_ = *fit;
  if (!measure_tilt()) {
    return tl::unexpected(LineRejection::LinesTiltMoved);
  }
  fill_readings(latency.latency_s);
  if (readings_.empty()) {
    return tl::unexpected(LineRejection::LinesNoReadings);
  }
  return describe(latency);
}

bool ScanAssembler::measure_tilt() noexcept {
  double sum_rad = 0.0;
  double least_rad = start_.tilt_rad;
  double greatest_rad = start_.tilt_rad;
  std::size_t count = 0;
  for (const hal::AxisSample& poll : polls_) {
    if (poll.axis == hal::Axis::Tilt && poll.stamp >= fit_.begin() && poll.stamp <= fit_.end()) {
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
  const hal::Stamp latency = hal::from_seconds(latency_s);
  const hal::Stamp begin = fit_.begin();
  const hal::Stamp end = fit_.end();
  for (const hal::RangeSample& sample : samples_) {
    const hal::Stamp at = sample.stamp + latency;
    if (at >= begin && at <= end) {
      add_reading(sample, fit_.pan_rad(at));
    }
  }
}

void ScanAssembler::add_reading(const hal::RangeSample& sample, double pan_rad) noexcept {
  double range_m = core::Reading::kNoReturn;
  switch (sample.echo) {
    case hal::Echo::None:
      break;
    case hal::Echo::Return:
      if (!(sample.range_m > 0.0) || !std::isfinite(sample.range_m)) {
        counters_.count(AssemblerEvent::ReadingsFault);
        return;
      }
      range_m = sample.range_m;
      break;
    case hal::Echo::Weak:
      counters_.count(AssemblerEvent::ReadingsWeak);
      return;
    case hal::Echo::Saturated:
      counters_.count(AssemblerEvent::ReadingsSaturated);
      return;
    case hal::Echo::Fault:
      counters_.count(AssemblerEvent::ReadingsFault);
      return;
  }
  readings_.push_back({pan_rad, tilt_rad_, range_m});
  stamps_.push_back(sample.stamp);
}

double ScanAssembler::median_half_width_s() noexcept {
  half_widths_.clear();
  for (const hal::AxisSample& poll : polls_) {
    if (poll.axis == hal::Axis::Pan && poll.stamp >= fit_.begin() && poll.stamp <= fit_.end()) {
      half_widths_.push_back(poll.half_width);
    }
  }
  if (half_widths_.empty()) {
    return 0.0;
  }
  const auto middle = half_widths_.begin() + std::ssize(half_widths_) / 2;
  std::nth_element(half_widths_.begin(), middle, half_widths_.end());
  return hal::to_seconds(*middle);
}

Scanline ScanAssembler::describe(const Latency& latency) noexcept {
  const hal::Stamp middle = fit_.begin() + (fit_.end() - fit_.begin()) / 2;
  const double speed_radps = std::abs(fit_.speed_radps(middle));
  const double ramp = ramp_s(move_);
  const double from_rad = move_.position_rad(ramp);
  const double to_rad = move_.position_rad(move_.duration_s() - ramp);
  const double ends_s =
      fit_.sigma_rad(fit_.begin()) / std::max(1e-9, std::abs(fit_.speed_radps(fit_.begin())));
  const double middle_s = fit_.sigma_rad(middle) / std::max(1e-9, speed_radps);
  // Mean over the line of a variance that grows with the square of the distance from its middle.
  const double mean_s2 = middle_s * middle_s + std::max(0.0, ends_s * ends_s - middle_s * middle_s) / 3.0;
  const double half_width_s = median_half_width_s();
  const double wider_s = std::max(0.0, half_width_s - latency.half_width_s) / std::numbers::sqrt3;
  Scanline line;
  line.half_width_s = half_width_s;
  line.readings = readings_;
  line.stamps = stamps_;
  line.tilt_rad = tilt_rad_;
  line.direction =
      move_.target_rad() > move_.start_rad() ? SweepDirection::Leftwards : SweepDirection::Rightwards;
  line.pan_sigma_rad = speed_radps * std::hypot(std::sqrt(mean_s2), latency.sigma_s, wider_s);
  line.line = start_.line;
  line.pan_radps = speed_radps;
  line.steady_min_rad = std::min(from_rad, to_rad);
  line.steady_max_rad = std::max(from_rad, to_rad);
  line.fit_sigma_s = std::sqrt(mean_s2);
  line.latency_s = latency.latency_s;
  return line;
}

}  // namespace slamsensor::firmware
