#include "tools/emulator/rangefinder/sight.hpp"

#include <algorithm>

namespace slamsensor::tools {

bool FaultWindows::take(FaultKind kind) {
  if (ordered_[index(kind)] == 0) {
    return false;
  }
  --ordered_[index(kind)];
  return true;
}

Sight look(RangeScene& scene, Stamp at, const FaultWindows& faults) {
  const Target target = scene.shoot(at);
  if (faults.is_open(FaultKind::DeviceError, at)) {
    return {.kind = SightKind::Error};
  }
  if (target.kind != TargetKind::Target || faults.is_open(FaultKind::NoReturns, at)) {
    return {};
  }
  Sight sight{SightKind::Target, target.range_m, target.reflectance};
  if (faults.is_open(FaultKind::WeakSignal, at)) {
    sight.kind = SightKind::Weak;
  } else if (faults.is_open(FaultKind::Saturation, at)) {
    sight.kind = SightKind::Saturated;
  }
  return sight;
}

double StrengthModel::of(const Sight& sight) const {
  constexpr double kNearest_m = 0.01;
  const double range_m = std::max(sight.range_m, kNearest_m);
  return std::min(ceiling, at_1m * sight.reflectance / (range_m * range_m));
}

}  // namespace slamsensor::tools
