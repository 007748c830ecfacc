#include "hal/pantilt/canopen/canopen_facts.hpp"

#include "hal/pantilt/canopen/cia402.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamsensor::hal {
namespace {

constexpr std::uint32_t kDriveProfile = 402;  // low half of the device type

constexpr std::array<SdoAddress, 14> kAsked{
    object::kDeviceType,     object::kVendor,        object::kProduct,       object::kDeviceName,
    object::kSupportedModes, object::kPositionMin,   object::kPositionMax,   object::kSpeedMax,
    object::kProfileSpeed,   object::kAcceleration,  object::kEncoderCounts, object::kEncoderTurns,
    object::kGearMotorTurns, object::kGearShaftTurns};

/// Objects that only FromDrive needs come last and are not asked otherwise.
constexpr std::size_t kWithoutScale = 10;

constexpr bool is_same(SdoAddress a, SdoAddress b) noexcept {
  return a == b;
}

}  // namespace

void CanopenFactsScript::begin(Stamp) noexcept {
  static_assert(kAsked.size() == kReads);
  at_ = 0;
  values_ = {};
  facts_ = {};
}

std::optional<SdoRequest> CanopenFactsScript::next() const noexcept {
  const std::size_t count = axis_.scale == CanopenScale::FromDrive ? kReads : kWithoutScale;
  if (at_ >= count) {
    return std::nullopt;
  }
  SdoRequest request = SdoRequest::read(kAsked[at_]);
  if (is_same(request.address, object::kDeviceName)) {
    request.kind = SdoRequest::Kind::ReadText;
  }
  return request;
}

CanopenProblem CanopenFactsScript::on_result(const SdoResult& result, const SdoClient& client,
                                             Stamp) noexcept {
  const SdoAddress asked = result.request.address;
  const bool done = result.outcome == SdoOutcome::Done;
  if (is_same(asked, object::kDeviceType) && (!done || (result.value & 0xFFFFU) != kDriveProfile)) {
    return CanopenProblem::NotADrive;
  }
  if (is_same(asked, object::kDeviceName) && done) {
    facts_.name = client.text();
  }
  if (done) {
    values_[at_] = result.value;
  } else {
    counters_.count(CanopenEvent::SettingsRefused);
  }
  ++at_;
  return next() ? CanopenProblem::None : conclude();
}

/// What is optional in a drive has its bound in the configuration.
CanopenProblem CanopenFactsScript::conclude() noexcept {
  const std::uint32_t assumed = 1U;  // a drive that cannot tell its modes still has the usual one
  facts_.modes = told(object::kSupportedModes).value_or(assumed);
  const bool sweeps_by_speed = config_.motion == CanopenMotion::ProfileVelocity;
  if (!has_mode(facts_.modes, DriveMode::ProfilePosition) ||
      (sweeps_by_speed && !has_mode(facts_.modes, DriveMode::ProfileVelocity)) ||
      (config_.homing == CanopenHoming::Always && !has_mode(facts_.modes, DriveMode::Homing))) {
    return CanopenProblem::NoMode;
  }
  const double counts_per_rad = scale();
  if (!(counts_per_rad >= 1e-3 && counts_per_rad <= 1e12)) {
    return CanopenProblem::NoScale;
  }
  facts_.rad_per_count = (axis_.sense == CanopenSense::Normal ? 1.0 : -1.0) / counts_per_rad;
  facts_.speed_units_per_rad = axis_.speed_units_per_rad > 0.0 ? axis_.speed_units_per_rad : counts_per_rad;
  const double window = std::min(std::round(axis_.window_rad * counts_per_rad), 1e9);
  facts_.window_counts = std::max(1, static_cast<std::int32_t>(window));

  AxisInfo& info = facts_.info;
  info.resolution_rad = 1.0 / counts_per_rad;
  info.speed_min_radps = 1.0 / facts_.speed_units_per_rad;
  const std::uint32_t speed_units = told(object::kSpeedMax).value_or(0);
  const double speed_told = speed_units / facts_.speed_units_per_rad;
  info.speed_max_radps =
      speed_units > 0 ? std::min(speed_told, axis_.speed_max_radps) : axis_.speed_max_radps;
  const double per_rad =
      axis_.acceleration_units_per_rad > 0.0 ? axis_.acceleration_units_per_rad : counts_per_rad;
  info.dynamics.acceleration_radps2 = axis_.acceleration_radps2 > 0.0
                                          ? axis_.acceleration_radps2
                                          : told(object::kAcceleration).value_or(0) / per_rad;
  // Without any acceleration known, speed is taken to be reached at once.
  info.dynamics.base_speed_radps = info.dynamics.acceleration_radps2 > 0.0 ? 0.0 : info.speed_max_radps;
  return find_range();
}

CanopenProblem CanopenFactsScript::find_range() noexcept {
  AxisInfo& info = facts_.info;
  info.min_rad = axis_.min_rad;
  info.max_rad = axis_.max_rad;
  const auto low = static_cast<std::int32_t>(told(object::kPositionMin).value_or(0));
  const auto high = static_cast<std::int32_t>(told(object::kPositionMax).value_or(0));
  if (low < high) {  // both 0, or crossed: no limits (CiA 402)
    const double a = low * facts_.rad_per_count;
    const double b = high * facts_.rad_per_count;
    info.min_rad = std::max(info.min_rad, std::min(a, b));
    info.max_rad = std::min(info.max_rad, std::max(a, b));
  }
  return info.min_rad < info.max_rad ? CanopenProblem::None : CanopenProblem::NoLimits;
}

/// Counts per radian of the axis.
double CanopenFactsScript::scale() const noexcept {
  if (axis_.scale == CanopenScale::Configured) {
    return axis_.counts_per_rad;
  }
  const double counts = told(object::kEncoderCounts).value_or(0);
  const double turns = told(object::kEncoderTurns).value_or(1);
  const double motor = told(object::kGearMotorTurns).value_or(1);
  const double shaft = told(object::kGearShaftTurns).value_or(1);
  return turns > 0.0 && shaft > 0.0 ? counts / turns * motor / shaft / (2.0 * std::numbers::pi) : 0.0;
}

std::optional<std::uint32_t> CanopenFactsScript::told(SdoAddress address) const noexcept {
  for (std::size_t i = 0; i < kAsked.size(); ++i) {
    if (is_same(kAsked[i], address)) {
      return values_[i];
    }
  }
  return std::nullopt;
}

}  // namespace slamsensor::hal
