#include "tools/emulator/fault_fit.hpp"

#include "tools/emulator/head_devices.hpp"

namespace slamsensor::tools {
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
