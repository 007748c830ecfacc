#include "core/sweep/latency_calibration.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
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
