#include "tools/emulator/fault_plan.hpp"

#include <algorithm>
#include <limits>

namespace slamsensor::tools {
namespace {

constexpr double kGapMin_s = 1e-6;  // so that time gets on
constexpr double kLatest_s = 4e9;

hal::Stamp stamp(double time_s) noexcept {
  return time_s < kLatest_s ? hal::from_seconds(time_s) : hal::kNever;
}

}  // namespace

void FaultPlan::Source::draw_next() {
  const double gap_s = rate.rhythm == FaultRhythm::Chance ? free_path_m(draw_unit(rng), 1.0 / rate.mean_gap_s)
                                                          : rate.mean_gap_s;
  next_s += std::max(gap_s, kGapMin_s);
  if (next_s > rate.until_s) {
    next_s = std::numeric_limits<double>::infinity();
  }
}

FaultPlan::FaultPlan(std::span<const PlannedFault> planned, std::span<const FaultRate> rates,
                     std::uint64_t seed)
    : planned_(planned.rbegin(), planned.rend()) {
  std::stable_sort(planned_.begin(), planned_.end(),
                   [](const PlannedFault& a, const PlannedFault& b) { return a.at_s > b.at_s; });
  for (std::size_t i = 0; i < rates.size(); ++i) {
    sources_.push_back({rates[i], Random(mix_seed(seed, i)), rates[i].from_s});
    sources_.back().draw_next();
  }
}

const FaultPlan::Source* FaultPlan::earliest_source() const noexcept {
  const auto earliest = std::min_element(
      sources_.begin(), sources_.end(), [](const Source& a, const Source& b) { return a.next_s < b.next_s; });
  return earliest == sources_.end() ? nullptr : &*earliest;
}

hal::Stamp FaultPlan::next() const noexcept {
  const hal::Stamp planned = planned_.empty() ? hal::kNever : stamp(planned_.back().at_s);
  const Source* const source = earliest_source();
  return source != nullptr ? std::min(planned, stamp(source->next_s)) : planned;
}

std::optional<DueFault> FaultPlan::take(hal::Stamp now) {
  const hal::Stamp at = next();
  if (at > now || at == hal::kNever) {
    return std::nullopt;
  }
  if (!planned_.empty() && stamp(planned_.back().at_s) == at) {
    const PlannedFault planned = planned_.back();
    planned_.pop_back();
    return DueFault{planned.device, {planned.kind, at, hal::from_seconds(planned.duration_s)}};
  }
  Source& source = sources_[static_cast<std::size_t>(earliest_source() - sources_.data())];
  source.draw_next();
  return DueFault{source.rate.device, {source.rate.kind, at, hal::from_seconds(source.rate.duration_s)}};
}

}  // namespace slamsensor::tools
