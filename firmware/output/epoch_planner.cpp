#include "firmware/output/epoch_planner.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::firmware {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr double kRateMin_hz = 0.1;
constexpr double kRateMax_hz = 10.0;
using Cycles = std::chrono::duration<std::int64_t, std::kilo>;
constexpr std::int64_t kCycle_ns = nanoseconds(Cycles(1)).count();  // has as many epochs as the rate has mHz
constexpr nanoseconds kClockStepMin = std::chrono::milliseconds(500);
constexpr hal::Stamp kPromptGapMax = seconds(1);
constexpr hal::Stamp kPromptRetry = std::chrono::milliseconds(1);

}  // namespace

void EpochPlanner::set_rate(double rate_hz) noexcept {
  rate_mhz_ = std::llround(std::clamp(rate_hz, kRateMin_hz, kRateMax_hz) * 1000.0);
  if (last_call_) {
    last_index_ = index_at(last_call_->utc);
  }
}

/// Number of the last regular epoch at or before `utc`.
std::int64_t EpochPlanner::index_at(nanoseconds utc) const noexcept {
  const Cycles cycle = std::chrono::floor<Cycles>(utc);
  return cycle.count() * rate_mhz_ + nanoseconds(utc - cycle).count() * rate_mhz_ / kCycle_ns;
}

nanoseconds EpochPlanner::time_of(std::int64_t index) const noexcept {
  const std::int64_t cycle = index / rate_mhz_ - (index % rate_mhz_ < 0 ? 1 : 0);
  const std::int64_t in_cycle = index - cycle * rate_mhz_;
  return Cycles(cycle) + nanoseconds((in_cycle * kCycle_ns + rate_mhz_ - 1) / rate_mhz_);
}

hal::Stamp EpochPlanner::prompt_gap() const noexcept {
  return std::min<hal::Stamp>(kPromptGapMax, time_of(1) - time_of(0));
}

bool EpochPlanner::was_clock_set(const OutputTime& now) const noexcept {
  const nanoseconds ahead = now.utc - last_call_->utc - (now.monotonic - last_call_->monotonic);
  return std::chrono::abs(ahead) >= kClockStepMin;
}

std::optional<PlannedEpoch> EpochPlanner::next(const OutputTime& now, EpochNews news) noexcept {
  const std::int64_t index = index_at(now.utc);
  const bool is_set = last_call_ && was_clock_set(now);
  if (!last_call_ || is_set) {
    last_stamp_.reset();
    last_second_.reset();
    last_index_ = index;
  }
  clock_steps_ += is_set ? 1 : 0;
  last_call_ = now;
  if (index > last_index_) {
    return regular(index);
  }
  return news == EpochNews::Waiting ? prompt(now) : std::nullopt;
}

std::optional<PlannedEpoch> EpochPlanner::regular(std::int64_t index) noexcept {
  const Hundredths stamp = std::chrono::floor<Hundredths>(time_of(index));
  if (last_stamp_ && stamp <= *last_stamp_) {  // after a change of the rate
    last_index_ = index;
    return std::nullopt;
  }
  const seconds second = std::chrono::floor<seconds>(stamp);
  const PlannedEpoch epoch{stamp, EpochKind::Regular, second != last_second_,
                           static_cast<std::uint64_t>(index - last_index_ - 1)};
  last_index_ = index;
  last_stamp_ = stamp;
  last_second_ = second;
  return epoch;
}

std::optional<PlannedEpoch> EpochPlanner::prompt(const OutputTime& now) noexcept {
  if (last_prompt_ && now.monotonic - *last_prompt_ < prompt_gap()) {
    return std::nullopt;
  }
  Hundredths stamp = std::chrono::floor<Hundredths>(now.utc);
  if (last_stamp_ && stamp <= *last_stamp_) {
    stamp = *last_stamp_ + Hundredths(1);
  }
  // The stamp of the next regular epoch is not taken away from it; it comes within this hundredth.
  if (stamp >= std::chrono::floor<Hundredths>(time_of(last_index_ + 1))) {
    return std::nullopt;
  }
  last_prompt_ = now.monotonic;
  last_stamp_ = stamp;
  return PlannedEpoch{stamp, EpochKind::Prompt, false, 0};
}

hal::Stamp EpochPlanner::wait(const OutputTime& now, EpochNews news) const noexcept {
  const hal::Stamp period = time_of(1) - time_of(0);
  hal::Stamp wait = std::clamp<hal::Stamp>(time_of(index_at(now.utc) + 1) - now.utc, hal::Stamp{}, period);
  if (news == EpochNews::Waiting) {
    const hal::Stamp prompt = last_prompt_ ? *last_prompt_ + prompt_gap() - now.monotonic : hal::Stamp{};
    wait = std::min(wait, std::max(prompt, kPromptRetry));
  }
  return wait;
}

}  // namespace slamsensor::firmware
