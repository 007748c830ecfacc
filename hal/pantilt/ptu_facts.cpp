#include "hal/pantilt/ptu_facts.hpp"

#include <cmath>
#include <numbers>

namespace slamsensor::hal {
namespace {

constexpr std::array<PtuQuantity, 7> kAsked{
    PtuQuantity::Resolution, PtuQuantity::MinPosition, PtuQuantity::MaxPosition, PtuQuantity::SpeedMin,
    PtuQuantity::SpeedMax,   PtuQuantity::BaseSpeed,   PtuQuantity::Acceleration};

constexpr double kArcsecPerDegree = 3600.0;
constexpr double kResolutionMinDeg = 1e-6;
constexpr double kResolutionMaxDeg = 1.0;
constexpr double kWholeMax = 1e6;
constexpr double kAccelerationMax = 1e9;

bool is_whole(double value) noexcept {
  return std::abs(value) <= kWholeMax && std::floor(value) == value;
}

bool possible(const PtuAxisFacts& facts, double resolution_deg) noexcept {
  return resolution_deg >= kResolutionMinDeg && resolution_deg <= kResolutionMaxDeg &&
         facts.min_position <= 0 && facts.max_position >= 0 && facts.min_position < facts.max_position &&
         facts.speed_min_ps >= 0 && facts.speed_min_ps < facts.speed_max_ps && facts.base_speed_ps >= 0 &&
         facts.acceleration_ps2 >= 0.0 && facts.acceleration_ps2 <= kAccelerationMax;
}

}  // namespace

void PtuInquiry::restart() noexcept {
  asked_ = 0;
  before_.reset();
}

PtuCommand PtuInquiry::question() const noexcept {
  return PtuCommand::query(asked_ < kPerAxis ? Axis::Pan : Axis::Tilt, kAsked[asked_ % kPerAxis]);
}

void PtuInquiry::answer(double value) noexcept {
  if (done()) {
    return;
  }
  if (before_ != value) {
    before_ = value;
    return;
  }
  values_[asked_++] = value;
  before_.reset();
}

std::optional<PtuAxisFacts> PtuInquiry::facts(Axis axis) const noexcept {
  const double* const told = values_.data() + (axis == Axis::Pan ? 0 : kPerAxis);
  for (std::size_t i = 1; i + 1 < kPerAxis; ++i) {
    if (!is_whole(told[i])) {
      return std::nullopt;
    }
  }
  const double resolution_deg = told[0] / kArcsecPerDegree;
  PtuAxisFacts facts;
  facts.position_rad = resolution_deg * std::numbers::pi / 180.0;
  facts.min_position = static_cast<std::int32_t>(told[1]);
  facts.max_position = static_cast<std::int32_t>(told[2]);
  facts.speed_min_ps = static_cast<std::int32_t>(told[3]);
  facts.speed_max_ps = static_cast<std::int32_t>(told[4]);
  facts.base_speed_ps = static_cast<std::int32_t>(told[5]);
  facts.acceleration_ps2 = told[6];
  return done() && possible(facts, resolution_deg) ? std::optional(facts) : std::nullopt;
}

AxisInfo ptu_axis_info(const PtuAxisFacts& facts, PtuSense sense) noexcept {
  const double unit_rad = facts.position_rad;
  AxisInfo info;
  info.min_rad = (sense == PtuSense::Normal ? facts.min_position : -facts.max_position) * unit_rad;
  info.max_rad = (sense == PtuSense::Normal ? facts.max_position : -facts.min_position) * unit_rad;
  info.resolution_rad = unit_rad;
  info.speed_min_radps = facts.speed_min_ps * unit_rad;
  info.speed_max_radps = facts.speed_max_ps * unit_rad;
  info.dynamics = {facts.base_speed_ps * unit_rad, facts.acceleration_ps2 * unit_rad};
  return info;
}

}  // namespace slamsensor::hal
