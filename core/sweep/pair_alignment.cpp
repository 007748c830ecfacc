#include "core/sweep/pair_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace slamsensor::core {
namespace {

constexpr double kGapCells = 4.0;  // readings farther apart are not joined

/// Makes it `count` copies of `value`, as far as there is room.
template <typename T, std::size_t N>
void fill(FixedVector<T, N>& vector, std::size_t count, T value) noexcept {
  vector.clear();
  while (vector.size() < count && vector.try_push_back(value)) {
  }
}

double height_of(const Reading& reading, double range_max_m) noexcept {
  const double range_m = reading.has_return() ? std::min(reading.range_m, range_max_m) : range_max_m;
  return RangeProfile::kPerUnit * std::log1p(range_m);
}

constexpr std::size_t kLagsPerStep = 4;
constexpr std::size_t kFlank = 3;   // lags to each side whose heights are compared
constexpr std::int32_t kCut = 400;  // profile units: ranges 1.5 times as large
constexpr double kContrastMin =
    2.0;  // profile units that the best lag is better than a typical one, per cell
constexpr double kAmbiguousShare =
    0.4;                            // a second place may have gone this far from typical towards the best
constexpr double kApart_s = 0.004;  // nearer lags are the same place

std::int32_t cut_difference(std::int16_t a, std::int16_t b) noexcept {
  const std::int32_t off = std::min(kCut, std::abs(a - b));
  return a < 0 || b < 0 ? kCut / 2 : off;  // what was not looked at speaks for no lag
}

/// Half of `lag`, rounded down also when negative.
std::int64_t half_below(std::int64_t lag) noexcept {
  return lag >= 0 ? lag / 2 : -((1 - lag) / 2);
}

}  // namespace

ProfileGrid make_grid(double pan_min_rad, double pan_max_rad, double reading_rad) noexcept {
  const double span_rad = pan_max_rad - pan_min_rad;
  const double cell_rad = std::max(reading_rad, span_rad / static_cast<double>(kProfileCellsMax - 1));
  return {pan_min_rad, cell_rad, static_cast<std::size_t>(span_rad / cell_rad * (1.0 + 1e-12)) + 1};
}

void RangeProfile::build(const Scanline& line, const ProfileGrid& grid, double range_max_m) noexcept {
  direction_ = line.direction;
  line_ = line.line;
  pan_radps_ = line.pan_radps;
  fit_sigma_s_ = line.fit_sigma_s;
  latency_s_ = line.latency_s;
  fill(raw_, grid.cells, -1.0);
  const auto is_steady = [&](const Reading& reading) {
    return reading.pan_rad >= line.steady_min_rad && reading.pan_rad <= line.steady_max_rad;
  };
  for (std::size_t i = 1; i < line.readings.size(); ++i) {
    const Reading& a = line.readings[i - 1];
    const Reading& b = line.readings[i];
    if (is_steady(a) && is_steady(b)) {
      const bool ordered = a.pan_rad <= b.pan_rad;
      draw(grid, ordered ? a : b, ordered ? b : a, range_max_m);
    }
  }
  smooth();
}

/// Fills the cells between two readings by a straight line.
void RangeProfile::draw(const ProfileGrid& grid, const Reading& from, const Reading& to,
                        double range_max_m) noexcept {
  const double from_cell = (from.pan_rad - grid.min_rad) / grid.cell_rad;
  const double to_cell = (to.pan_rad - grid.min_rad) / grid.cell_rad;
  const double last = static_cast<double>(raw_.size()) - 1.0;
  const double width = to_cell - from_cell;
  if (!(width > 0.0) || width > kGapCells || !(to_cell >= 0.0) || !(from_cell <= last)) {
    return;
  }
  const double from_height = height_of(from, range_max_m);
  const double to_height = height_of(to, range_max_m);
  for (double cell = std::max(0.0, std::ceil(from_cell)); cell <= std::min(last, to_cell); cell += 1.0) {
    const double share = (cell - from_cell) / width;
    raw_[static_cast<std::size_t>(cell)] = from_height + share * (to_height - from_height);
  }
}

void RangeProfile::smooth() noexcept {
  fill(smooth_, raw_.size(), kHole);
  for (std::size_t i = 1; i + 1 < raw_.size(); ++i) {
    if (raw_[i - 1] >= 0.0 && raw_[i] >= 0.0 && raw_[i + 1] >= 0.0) {
      smooth_[i] = static_cast<std::int16_t>(std::lround(0.25 * (raw_[i - 1] + 2.0 * raw_[i] + raw_[i + 1])));
    }
  }
}

void PairAlignment::begin(const RangeProfile& earlier, const RangeProfile& later,
                          const ProfileGrid& grid) noexcept {
  const bool leftwards_first = earlier.direction() == SweepDirection::Leftwards;
  first_ = earlier.direction();
  leftwards_ = leftwards_first ? &earlier : &later;
  rightwards_ = leftwards_first ? &later : &earlier;
  const double speed_sum_radps = earlier.pan_radps() + later.pan_radps();
  lag_s_ = grid.cell_rad / speed_sum_radps;
  base_s_ = (leftwards_->pan_radps() * leftwards_->latency_s() +
             rightwards_->pan_radps() * rightwards_->latency_s()) /
            speed_sum_radps;
  const auto reach = std::min(static_cast<std::int64_t>(std::ceil(config_.search_s / lag_s_)),
                              static_cast<std::int64_t>(kLagsMax / 2));
  const auto centre = static_cast<std::int64_t>(std::lround((config_.initial_s - base_s_) / lag_s_));
  first_lag_ = centre - reach;
  lags_ = static_cast<std::size_t>(2 * reach + 1);
  next_lag_ = 0;
  margin_ = static_cast<std::size_t>((std::abs(centre) + reach) / 2 + 1);
  const std::size_t cells = std::min(earlier.cells().size(), later.cells().size());
  window_ = cells > 2 * margin_ ? cells - 2 * margin_ : 0;
}

std::optional<PairOutcome> PairAlignment::step() noexcept {
  if (!is_busy()) {
    return std::nullopt;
  }
  if (window_ < 2 * margin_ || window_ < kSectors) {
    abandon();
    return PairProblem::NoOverlap;
  }
  for (std::size_t i = 0; i < kLagsPerStep && is_busy(); ++i) {
    try_lag(next_lag_++);
  }
  if (is_busy()) {
    return std::nullopt;
  }
  return conclude();
}

void PairAlignment::try_lag(std::size_t index) noexcept {
  const std::int64_t lag = first_lag_ + static_cast<std::int64_t>(index);
  const std::int64_t left =
      half_below(lag);  // both are moved, so that the same piece of the world is compared
  const std::int64_t right = lag - left;
  const std::int16_t* const a = leftwards_->cells().data() + (static_cast<std::int64_t>(margin_) - left);
  const std::int16_t* const b = rightwards_->cells().data() + (static_cast<std::int64_t>(margin_) + right);
  for (std::size_t sector = 0; sector < kSectors; ++sector) {
    const std::size_t last = window_ * (sector + 1) / kSectors;
    std::int32_t sum = 0;
    for (std::size_t i = window_ * sector / kSectors; i < last; ++i) {
      sum += cut_difference(a[i], b[i]);
    }
    costs_[index][sector] = sum;
  }
}

std::int64_t PairAlignment::cost(std::size_t index) const noexcept {
  std::int64_t sum = 0;
  for (const std::int32_t sector : costs_[index]) {
    sum += sector;
  }
  return sum;
}

/// Mean over all lags: most of them compare places that have nothing to do with each other.
std::int64_t PairAlignment::typical_cost() const noexcept {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < lags_; ++i) {
    sum += cost(i);
  }
  return sum / static_cast<std::int64_t>(lags_);
}

/// The cost of the next best lag that is not part of the valley around `best`.
std::int64_t PairAlignment::second_best(std::size_t best) const noexcept {
  const auto apart = std::max(std::size_t{4}, static_cast<std::size_t>(kApart_s / lag_s_));
  std::int64_t least = typical_cost();
  for (std::size_t i = 1; i + 1 < lags_; ++i) {
    const bool far = i + apart < best || i > best + apart;
    const bool valley = cost(i) <= cost(i - 1) && cost(i) <= cost(i + 1);
    if (far && valley) {
      least = std::min(least, cost(i));
    }
  }
  return least;
}

/// How much higher the valley is to the right of lag `centre` than to the left, one sector (or none:
/// kSectors) left out.
double PairAlignment::lean(std::size_t centre, std::size_t sector_left_out) const noexcept {
  const auto height = [&](std::size_t index) {
    return cost(index) - (sector_left_out < kSectors ? costs_[index][sector_left_out] : 0);
  };
  std::int64_t sum = 0;
  for (std::size_t i = 1; i <= kFlank; ++i) {
    sum += static_cast<std::int64_t>(i) * (height(centre + i) - height(centre - i));
  }
  return static_cast<double>(sum);
}

/// The centre of the valley around `best`, in lags: where its flanks are equally high. A valley between sharp
/// edges has the shape of a V, for which a parabola would be wrong; its flanks are right for any shape that
/// is the same on both sides.
double PairAlignment::valley(std::size_t best, std::size_t sector_left_out) const noexcept {
  const auto middle = static_cast<double>(best);
  const double here = lean(best, sector_left_out);
  if (here < 0.0) {
    const double right = lean(best + 1, sector_left_out);
    return right > 0.0 ? middle + here / (here - right) : middle + 1.0;
  }
  const double left = lean(best - 1, sector_left_out);
  return left < 0.0 ? middle - here / (here - left) : middle - 1.0;
}

double PairAlignment::latency_of(double lag) const noexcept {
  return base_s_ + (static_cast<double>(first_lag_) + lag) * lag_s_;
}

PairOutcome PairAlignment::conclude() const noexcept {
  std::size_t best = 0;
  for (std::size_t i = 1; i < lags_; ++i) {
    best = cost(i) < cost(best) ? i : best;
  }
  const auto contrast = static_cast<double>(typical_cost() - cost(best));
  if (contrast < kContrastMin * static_cast<double>(window_)) {
    return PairProblem::NoEdges;
  }
  if (best < kFlank + 1 || best + kFlank + 1 >= lags_) {
    return PairProblem::AtLimit;
  }
  if (static_cast<double>(typical_cost() - second_best(best)) > kAmbiguousShare * contrast) {
    return PairProblem::Ambiguous;
  }
  const double lag = valley(best, kSectors);
  double sum = 0.0;
  for (std::size_t sector = 0; sector < kSectors; ++sector) {
    const double off = valley(best, sector) - lag;
    sum += off * off;
  }
  const double edges_s = lag_s_ * std::sqrt(sum * (kSectors - 1.0) / kSectors);
  // The error of each line's fit in time comes in by half.
  const double fits_s = 0.5 * std::hypot(leftwards_->fit_sigma_s(), rightwards_->fit_sigma_s());
  const double sigma_s = std::hypot(edges_s, fits_s);
  if (!(sigma_s <= config_.pair_sigma_max_s)) {
    return PairProblem::Unsure;
  }
  return PairEstimate{latency_of(lag), sigma_s, lag_s_, first_};
}

}  // namespace slamsensor::core
