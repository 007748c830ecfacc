#include "tools/emulator/fault.hpp"

#include "tools/emulator/head_devices.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace slamsensor::tools {

std::string_view name_of(FaultKind kind) noexcept {
  constexpr std::array<std::string_view, kFaultKinds> kNames = {
      "drop_byte",    "corrupt_byte",   "double_byte",   "noise",         "stall",        "cable_out",
      "power_cycle",  "silence",        "baud_reset",    "swallow_reply", "double_reply", "late_reply",
      "limit_report", "reset_error",    "missed_steps",  "blocked",       "monitor_mode", "settings_lost",
      "no_returns",   "weak_signal",    "saturation",    "bad_checksum",  "stream_stops", "text_message",
      "device_error", "interface_down", "bus_off",       "lost_frame",    "emergency",    "sdo_abort",
      "sdo_silence",  "node_reset",     "heartbeat_lost"};
  return kNames[static_cast<std::size_t>(kind)];
}

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

namespace {

bool is_between(FaultKind kind, FaultKind first, FaultKind last) noexcept {
  return kind >= first && kind <= last;
}

bool is_of_any_device(FaultKind kind) noexcept {
  return is_between(kind, FaultKind::PowerCycle, FaultKind::Silence);
}

bool is_of_serial_line(FaultKind kind) noexcept {
  return is_between(kind, FaultKind::DropByte, FaultKind::CableOut) || kind == FaultKind::BaudReset;
}

bool is_of_bus(FaultKind kind) noexcept {
  return is_between(kind, FaultKind::InterfaceDown, FaultKind::LostFrame);
}

bool is_of_ptu(FaultKind kind, bool on_bus) noexcept {
  if (on_bus) {
    return is_between(kind, FaultKind::Emergency, FaultKind::HeartbeatLost) || kind == FaultKind::MissedSteps;
  }
  return is_between(kind, FaultKind::SwallowReply, FaultKind::SettingsLost);
}

bool is_of_rangefinder(FaultKind kind, RangefinderModel unit) noexcept {
  const bool is_benewake = unit == RangefinderModel::Tf03 || unit == RangefinderModel::Tf03Can;
  const bool is_point = unit == RangefinderModel::Lds70a || unit == RangefinderModel::LaserAceIm;
  if (kind == FaultKind::BadChecksum) {
    return !is_point && !is_on_bus(unit);  // their records have none
  }
  if (kind == FaultKind::DeviceError) {
    return !is_benewake;
  }
  if (kind == FaultKind::TextMessage) {
    return !is_on_bus(unit);
  }
  return is_between(kind, FaultKind::NoReturns, FaultKind::DeviceError);
}

}  // namespace

std::string misfit(const HeadProfile& head, std::string_view device, FaultKind kind) {
  const bool ptu_on_bus = is_on_bus(head.ptu.unit);
  const bool finder_on_bus = is_on_bus(head.rangefinder.unit);
  const std::string what = "kind = \"" + std::string(name_of(kind)) + "\" ";
  if (device == kCanName) {
    if (!ptu_on_bus && !finder_on_bus && head.inclinometer.unit == InclinometerModel::None) {
      return "device = \"can\": this head has no device on a CAN bus";
    }
    return is_of_bus(kind) ? "" : what + "is no fault of a CAN bus";
  }
  const bool is_ptu = device == kPtuName;
  if (!is_ptu && device != kRangefinderName) {
    return "device = \"" + std::string(device) + "\" is none of ptu, rangefinder, can";
  }
  const bool on_bus = is_ptu ? ptu_on_bus : finder_on_bus;
  if (is_of_any_device(kind) ||
      (is_ptu ? is_of_ptu(kind, on_bus) : is_of_rangefinder(kind, head.rangefinder.unit))) {
    return "";
  }
  if (is_of_serial_line(kind)) {
    return on_bus ? what + "needs a serial line, and the " + std::string(device) + " is on a CAN bus" : "";
  }
  return what + "is no fault of this " + std::string(device);
}

}  // namespace slamsensor::tools
