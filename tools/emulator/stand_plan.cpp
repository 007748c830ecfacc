#include "tools/emulator/stand_plan.hpp"

#include <algorithm>
#include <utility>

namespace slamsensor::tools {

StandPlan::StandPlan(std::vector<Stand> stands, std::vector<Kidnap> kidnaps, StandChange change)
    : stands_(std::move(stands)), kidnaps_(std::move(kidnaps)), change_(change) {
  std::stable_sort(kidnaps_.begin(), kidnaps_.end(),
                   [](const Kidnap& a, const Kidnap& b) { return a.at_s < b.at_s; });
}

hal::Stamp StandPlan::stand_due() const noexcept {
  if (stand_ == stands_.size()) {
    return hal::kNever;
  }
  if (stand_ == 0) {
    return hal::Stamp{};
  }
  return change_ == StandChange::AtTimes ? hal::from_seconds(stands_[stand_].time_s) : hal::kNever;
}

hal::Stamp StandPlan::kidnap_due() const noexcept {
  return kidnap_ < kidnaps_.size() ? hal::from_seconds(kidnaps_[kidnap_].at_s) : hal::kNever;
}

hal::Stamp StandPlan::next() const noexcept {
  return std::min(stand_due(), kidnap_due());
}

std::optional<Visit> StandPlan::take(hal::Stamp now) {
  if (next() > now || next() == hal::kNever) {
    return std::nullopt;
  }
  if (stand_due() <= kidnap_due()) {
    return next_stand();
  }
  return Visit{VisitKind::Kidnap, kidnaps_[kidnap_++].pose_W};
}

std::optional<Visit> StandPlan::next_stand() {
  if (stand_ == stands_.size()) {
    return std::nullopt;
  }
  return Visit{VisitKind::Stand, stands_[stand_++].pose};
}

}  // namespace slamsensor::tools
