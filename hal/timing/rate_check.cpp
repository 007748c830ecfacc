#include "hal/timing/rate_check.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::hal {
namespace {

constexpr double kIntervalNs = 250e6;
constexpr double kIntervalPeriods = 50.0;  // a reading more or less must not look like another rate
constexpr double kCorrectionMax = 0.002;   // steadily; less is what lumps and single gaps do
constexpr double kBeyondTolerance = 0.005;
constexpr double kSuspectPeriods = 2.5;  // in one interval: two intervals may lose some by chance
constexpr double kSettledLeast = 0.5;

/// Mean of `values` without the `extremes` greatest and least.
template <std::size_t kCount>
double trimmed_mean(std::array<double, kCount> values, std::size_t extremes) noexcept {
  std::sort(values.begin(), values.end());
  double sum = 0.0;
  for (std::size_t i = extremes; i < kCount - extremes; ++i) {
    sum += values[i];
  }
  return sum / static_cast<double>(kCount - 2 * extremes);
}

}  // namespace

void RateCheck::begin(double tolerance, double period_ns) noexcept {
  const bool was_in_doubt = in_doubt_;
  *this = {};
  in_doubt_ = was_in_doubt;
  tolerance_ = tolerance;
  period_ns_ = period_ns;
  interval_ns_ = std::max(kIntervalNs, kIntervalPeriods * period_ns);
}

RateVerdict RateCheck::add(double elapsed_ns, double correction_ns, double slope_off,
                           bool is_settled) noexcept {
  open_.elapsed_ns += elapsed_ns;
  open_.correction_ns += correction_ns;
  open_.slope_off_ns += slope_off * elapsed_ns;
  open_.unsettled_ns += is_settled ? 0.0 : elapsed_ns;
  if (open_.elapsed_ns < interval_ns_) {
    return RateVerdict::Unchanged;
  }
  const std::size_t place = closed_++ % kIntervals;
  corrections_[place] = open_.correction_ns / open_.elapsed_ns;
  periods_off_[place] = (open_.correction_ns + open_.slope_off_ns) / open_.elapsed_ns;
  const double beyond = std::max(kBeyondTolerance, kSuspectPeriods * period_ns_ / open_.elapsed_ns);
  const double off = std::abs(periods_off_[place]) > tolerance_ + beyond ? periods_off_[place] : 0.0;
  is_suspect_ = off * last_off_ > 0.0;
  last_off_ = off;
  unsettled_[place] = open_.unsettled_ns > (1.0 - kSettledLeast) * open_.elapsed_ns;
  open_ = {};
  return judge();
}

RateVerdict RateCheck::judge() noexcept {
  if (closed_ < kIntervals) {
    return in_doubt_ ? RateVerdict::InDoubt : RateVerdict::Unchanged;
  }
  const auto unsettled = std::count(unsettled_.begin(), unsettled_.end(), true);
  period_off_ = trimmed_mean(periods_off_, kExtremes);
  const bool was_in_doubt = in_doubt_;
  in_doubt_ = unsettled > static_cast<std::ptrdiff_t>(kIntervals / 2) ||
              std::abs(period_off_) > tolerance_ + kBeyondTolerance;
  if (in_doubt_) {
    return RateVerdict::InDoubt;
  }
  if (!was_in_doubt && std::abs(trimmed_mean(corrections_, kExtremes)) <= kCorrectionMax) {
    return RateVerdict::Unchanged;
  }
  std::transform(periods_off_.begin(), periods_off_.end(), corrections_.begin(),
                 [this](double off) { return off - period_off_; });  // as the new period would have needed
  return RateVerdict::Corrected;
}

}  // namespace slamsensor::hal
