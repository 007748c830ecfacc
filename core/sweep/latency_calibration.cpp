#include "core/sweep/latency_calibration.hpp"

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

namespace {

constexpr double kToSigma = 1.4826;  // median of absolute deviations to standard deviation
constexpr double kOutlierSigmas = 4.0;
constexpr double kScatterMin_s = 1e-4;  // pairs nearer to the median than some of this are never outliers
// Of a cell: what pairs err together, as the same edges fall between the same readings (simulated worlds).
constexpr double kCommonCells = 0.1;
constexpr double kSigmaMin_s = 1e-5;
// Pairs that depart by themselves, when the latency changed in the middle of a pass.
constexpr std::size_t kPairsToDepart = 2;
constexpr double kShareToDepart = 0.4;

constexpr LatencyEvent event_of(PairProblem problem) noexcept {
  switch (problem) {
    case PairProblem::NoOverlap:
      return LatencyEvent::PairsNoOverlap;
    case PairProblem::NoEdges:
      return LatencyEvent::PairsNoEdges;
    case PairProblem::Ambiguous:
      return LatencyEvent::PairsAmbiguous;
    case PairProblem::AtLimit:
      return LatencyEvent::PairsAtLimit;
    case PairProblem::Unsure:
      break;
  }
  return LatencyEvent::PairsUnsure;
}

/// Weighted mean of pairs that share their first direction.
struct Mean {
  double sum_w = 0.0;
  double sum_ws = 0.0;
  double sum_wss = 0.0;
  std::uint32_t count = 0;

  void add(const PairEstimate& pair, double about_s) noexcept {
    const double variance_s2 = pair.sigma_s * pair.sigma_s + kSigmaMin_s * kSigmaMin_s;
    const double off_s = pair.latency_s - about_s;
    sum_w += 1.0 / variance_s2;
    sum_ws += off_s / variance_s2;
    sum_wss += off_s * off_s / variance_s2;
    ++count;
  }
  [[nodiscard]] double mean_s() const noexcept { return sum_ws / sum_w; }
  /// Of the mean: by the pairs' own sigmas, or by their scatter where that is greater.
  [[nodiscard]] double sigma_s() const noexcept {
    const double chi2 = count > 1 ? (sum_wss - sum_ws * sum_ws / sum_w) / (count - 1.0) : 1.0;
    return std::sqrt(std::max(1.0, chi2) / sum_w);
  }
};

}  // namespace

LatencyCalibration::LatencyCalibration(const LatencyConfig& config) noexcept
    : config_(config),
      alignment_(config),
      latency_{config.initial_s, config.self_calibration ? config.initial_sigma_s : 0.0} {
}

void LatencyCalibration::begin_pass(double pan_min_rad, double pan_max_rad, double reading_rad) noexcept {
  drop_pair();
  pairs_.clear();
  looked_at_ = half_widths_ = 0;
  half_widths_sum_s_ = 0.0;
  has_line_ = false;
  grid_ = make_grid(pan_min_rad, pan_max_rad, reading_rad);
}

void LatencyCalibration::drop_pair() noexcept {
  if (alignment_.is_busy()) {
    alignment_.abandon();
    counters_.count(LatencyEvent::PairsDropped);
  }
}

void LatencyCalibration::add(const Scanline& line) noexcept {
  if (!config_.self_calibration) {
    // The configured latency is taken to be that of the narrowest polls.
    latency_.half_width_s = std::min(latency_.half_width_s, line.half_width_s);
    return;
  }
  half_widths_sum_s_ += line.half_width_s;
  ++half_widths_;
  drop_pair();
  const RangeProfile& previous = profiles_[newest_];
  newest_ = 1 - newest_;
  RangeProfile& profile = profiles_[newest_];
  profile.build(line, grid_, config_.range_max_m);
  if (has_line_ && previous.line() + 1 == profile.line() && previous.direction() != profile.direction()) {
    alignment_.begin(previous, profile, grid_);
  }
  has_line_ = true;
}

void LatencyCalibration::step() noexcept {
  const auto outcome = alignment_.step();
  if (!outcome) {
    return;
  }
  ++looked_at_;
  if (!*outcome) {
    counters_.count(event_of(outcome->error()));
  } else {
    counters_.count(pairs_.try_push_back(**outcome) ? LatencyEvent::PairsUsed : LatencyEvent::PairsDropped);
  }
}

void LatencyCalibration::end_pass() noexcept {
  drop_pair();
  has_line_ = false;
  if (!config_.self_calibration) {
    return;
  }
  auto pass = combine();
  if (!pass) {
    counters_.count(LatencyEvent::PassesRefused);
    return;
  }
  pass->half_width_s = half_widths_sum_s_ / std::max(1U, half_widths_);
  latency_.sigma_s = std::hypot(latency_.sigma_s, config_.drift_sigma_s);
  if (latency_.pairs == 0 || agree(*pass, latency_)) {
    take(*pass);
  } else {
    depart(*pass);
  }
}

std::optional<Latency> LatencyCalibration::combine() noexcept {
  if (pairs_.empty() || pairs_.size() < config_.pairs_min) {
    return std::nullopt;
  }
  const double median_s = median_latency_s();
  const double limit_s = kOutlierSigmas * std::max(kScatterMin_s, scatter_s(median_s));
  std::array<Mean, 2> means;  // by the direction of the first line
  for (const PairEstimate& pair : pairs_) {
    if (std::abs(pair.latency_s - median_s) <= limit_s) {
      means[static_cast<std::size_t>(pair.first)].add(pair, median_s);
    }
  }
  const std::uint32_t count = means[0].count + means[1].count;
  if (count == 0 || count < config_.pairs_min) {
    return std::nullopt;
  }
  const double common_s = kCommonCells * pairs_[0].cell_s;
  if (means[0].count == 0 || means[1].count == 0) {
    const Mean& only = means[means[0].count == 0 ? 1 : 0];
    return Latency{median_s + only.mean_s(), std::hypot(only.sigma_s(), common_s), count};
  }
  // The two kinds share their lines, whose fits then err alike: the sigmas add up.
  return Latency{median_s + 0.5 * (means[0].mean_s() + means[1].mean_s()),
                 std::hypot(0.5 * (means[0].sigma_s() + means[1].sigma_s()), common_s), count};
}

double LatencyCalibration::median_latency_s() noexcept {
  const auto count = static_cast<std::ptrdiff_t>(pairs_.size());
  std::transform(pairs_.begin(), pairs_.end(), sorted_.begin(),
                 [](const PairEstimate& pair) { return pair.latency_s; });
  std::nth_element(sorted_.begin(), sorted_.begin() + count / 2, sorted_.begin() + count);
  return sorted_[static_cast<std::size_t>(count / 2)];
}

double LatencyCalibration::scatter_s(double median_s) noexcept {
  const auto count = static_cast<std::ptrdiff_t>(pairs_.size());
  std::transform(pairs_.begin(), pairs_.end(), sorted_.begin(),
                 [&](const PairEstimate& pair) { return std::abs(pair.latency_s - median_s); });
  std::nth_element(sorted_.begin(), sorted_.begin() + count / 2, sorted_.begin() + count);
  return kToSigma * sorted_[static_cast<std::size_t>(count / 2)];
}

double LatencyCalibration::limit_s(double a_sigma_s, double b_sigma_s) const noexcept {
  return std::max(config_.departure_min_s, config_.departure_sigmas * std::hypot(a_sigma_s, b_sigma_s));
}

bool LatencyCalibration::agree(const Latency& a, const Latency& b) const noexcept {
  return std::abs(a.latency_s - b.latency_s) <= limit_s(a.sigma_s, b.sigma_s);
}

bool LatencyCalibration::departs(double limit_s) noexcept {
  if (!config_.self_calibration || latency_.pairs == 0) {
    return false;
  }
  const auto is_off = [&](double latency_s, double sigma_s) {
    const double off_s = std::abs(latency_s - latency_.latency_s);
    return off_s > std::max(limit_s, this->limit_s(sigma_s, latency_.sigma_s));
  };
  std::array<std::size_t, 2> off{};  // by the side: people and twigs make pairs depart to both
  for (const PairEstimate& pair : pairs_) {
    off[pair.latency_s > latency_.latency_s ? 1 : 0] += is_off(pair.latency_s, pair.sigma_s) ? 1 : 0;
  }
  const std::size_t most = std::max(off[0], off[1]);
  if (most >= kPairsToDepart &&
      static_cast<double>(most) >= kShareToDepart * static_cast<double>(pairs_.size())) {
    return true;
  }
  const auto pass = combine();
  return pass && is_off(pass->latency_s, pass->sigma_s);
}

/// The first pass replaces what was configured; later ones are merged by their weights.
void LatencyCalibration::take(const Latency& pass) noexcept {
  counters_.count(LatencyEvent::PassesTaken);
  departures_ = 0;
  if (latency_.pairs == 0) {
    latency_ = pass;
    return;
  }
  const double known = 1.0 / (latency_.sigma_s * latency_.sigma_s);
  const double seen = 1.0 / (pass.sigma_s * pass.sigma_s);
  latency_.latency_s += (pass.latency_s - latency_.latency_s) * seen / (known + seen);
  latency_.sigma_s = 1.0 / std::sqrt(known + seen);
  latency_.pairs = pass.pairs;
  latency_.half_width_s = pass.half_width_s;
}

void LatencyCalibration::depart(const Latency& pass) noexcept {
  counters_.count(LatencyEvent::LatencyDeparted);
  departures_ = departures_ > 0 && agree(pass, departed_) ? departures_ + 1 : 1;
  departed_ = pass;
  if (departures_ >= config_.confirmations) {
    counters_.count(LatencyEvent::LatencyTakenOver);
    departures_ = 0;
    latency_ = pass;
  }
}

}  // namespace slamsensor::core
