#include "firmware/supervision/status_line.hpp"

#include "core/config.hpp"
#include "core/fix_names.hpp"
#include "firmware/supervision/decimal_text.hpp"
#include "firmware/supervision/plain_text.hpp"
#include "firmware/supervision/status_parts.hpp"

namespace slamsensor::firmware {
namespace {

/// What a reason means for who reads it.
std::string_view meaning(core::FixReason reason) {
  switch (reason) {
    case core::FixReason::TooFewLandmarks:
      return "too few landmarks around";
    case core::FixReason::NoOverlap:
      return "nothing here looks like the map";
    case core::FixReason::Symmetric:
      return "another place of the map looks the same";
    case core::FixReason::Deadline:
      return "the search was cut by its deadline";
    case core::FixReason::Stale:
      return "the last scan is too old";
    case core::FixReason::Device:
      return "the sensor head is not working";
    case core::FixReason::Moved:
      return "the carrier moved";
    case core::FixReason::Timing:
      return "the timing of a device is in doubt";
    case core::FixReason::Copy:
      return "a copy of this place that is not in the map would look the same";
    case core::FixReason::LocalMap:
      return "known in a local map, whose place in the home map is not known yet";
    case core::FixReason::NoScan:
      return "no scan yet";
    case core::FixReason::None:
      break;
  }
  return to_string(reason);
}

std::string why_none(const core::Fix& fix) {
  if (fix.reason == core::FixReason::NoScan || fix.reason == core::FixReason::Device) {
    return std::string(meaning(fix.reason));
  }
  return std::string(meaning(fix.reason)) + ", " + std::to_string(fix.landmarks_seen) + " landmarks seen";
}

std::string fix_clause(const SensorStatus& status) {
  const core::Fix& fix = status.report.fix;
  switch (status.state) {
    case SensorState::Fixed:
      return ' ' + fix_phrase(fix);
    case SensorState::Ambiguous:
    case SensorState::Lost:
      return ": " + why_none(fix);
    default:
      return status.slam.scans == 0 ? std::string() : ", " + fix_phrase(fix);
  }
}

std::string device_phrase(const NamedDevice& device) {
  std::string text(device.title);
  if (device.status->problem.view().empty()) {
    return text + ' ' + std::string(to_string(device.status->state));
  }
  return text + ": " + std::string(device.status->problem.view());
}

std::string map_phrase(const SensorStatus& status) {
  return "map '" + std::string(status.map_name.view()) + "' " + std::to_string(status.slam.landmarks) +
         " landmarks" + (status.slam.frozen ? " (frozen)" : "");
}

}  // namespace

std::string fix_phrase(const core::Fix& fix) {
  const std::string landmarks =
      std::to_string(fix.matches) + " of " + std::to_string(fix.landmarks_seen) + " landmarks";
  if (fix.status == core::FixStatus::Fix) {
    return "x=" + decimal_text(fix.pose_W.x_m, 2) + " m y=" + decimal_text(fix.pose_W.y_m, 2) +
           " m heading=" + decimal_text(fix.pose_W.heading_rad / core::kDegree, 1) + " deg, " + landmarks;
  }
  return std::string(fix.status == core::FixStatus::Ambiguous ? "ambiguous" : "no fix") + ": " +
         why_none(fix);
}

std::string status_line(const SensorStatus& status) {
  std::string text = std::string(to_string(status.state)) + fix_clause(status) + ", " + map_phrase(status);
  for (const NamedDevice& device : devices_of(status)) {
    text += "; " + device_phrase(device);
  }
  if (const std::string_view problem = head_problem(status); !problem.empty()) {
    text += "; " + std::string(problem);
  }
  return plain_text(text);
}

}  // namespace slamsensor::firmware
