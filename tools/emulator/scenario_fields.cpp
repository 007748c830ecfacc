#include "tools/emulator/scenario_fields.hpp"

#include "tools/emulator/fault_fit.hpp"
#include "tools/emulator/head_devices.hpp"

#include <cmath>
#include <numbers>

namespace slamsensor::tools {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMilli = 1e-3;
constexpr double kFar_m = 1e5;
constexpr double kLatest_s = 1e9;
constexpr double kSeedMax = 0x1.0p63;  // TOML integers are signed
constexpr double kBaudMin = 600.0;
constexpr double kBaudMax = 4e6;

template <std::size_t kCount>
std::vector<std::string_view> words_of(const std::array<UnitText, kCount>& units) {
  std::vector<std::string_view> words;
  for (const UnitText& unit : units) {
    words.push_back(unit.word);
  }
  return words;
}

Choice begin_choice(DeviceBegin& begin) {
  return choice_of(begin, {"power_up", "ready"});
}

Choice device_choice(std::string& device) {
  const std::vector<std::string_view> names = {kPtuName, kRangefinderName, kCanName};
  return {names, [&device, names](std::size_t index) { device = names[index]; }};
}

Choice kind_choice(FaultKind& kind) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < kFaultKinds; ++i) {
    names.push_back(name_of(static_cast<FaultKind>(i)));
  }
  return choice_of(kind, std::move(names));
}

Section mount_section(SweepConfig& mount) {
  return {"mount",
          {{"height_m", &mount.mount_height_m, 0.0, 100.0},
           {"roll_deg", &mount.roll_rad, -45.0, 45.0, kDegree},
           {"pitch_deg", &mount.pitch_rad, -45.0, 45.0, kDegree}},
          {}};
}

Section ptu_section(PtuProfile& ptu) {
  return {"ptu",
          {{"unit", choice_of(ptu.unit, words_of(kPtuUnits))},
           {"begin", begin_choice(ptu.begin)},
           {"encoder", choice_of(ptu.encoder, {"absolute", "incremental"})},
           {"baud", &ptu.baud, kBaudMin, kBaudMax},
           {"reply_latency_ms", &ptu.reply_latency_s, 0.0, 1000.0, kMilli},
           {"reply_jitter_ms", &ptu.reply_jitter_s, 0.0, 1000.0, kMilli},
           {"position_age_ms", &ptu.position_age_s, 0.0, 1000.0, kMilli},
           {"boot_s", &ptu.boot_s, 0.0, 60.0},
           {"reset_s", &ptu.reset_s, 0.0, 60.0},
           {"usb_ms", &ptu.usb_s, 0.0, 100.0, kMilli}},
          {}};
}

Section rangefinder_section(RangefinderProfile& finder) {
  return {"rangefinder",
          {{"unit", choice_of(finder.unit, words_of(kRangefinderUnits))},
           {"begin", begin_choice(finder.begin)},
           {"baud", &finder.baud, kBaudMin, kBaudMax},
           {"rate_hz", &finder.rate_hz, 1.0, 40'000.0},
           {"latency_ms", &finder.latency_s, 0.0, 1000.0, kMilli},
           {"jitter_ms", &finder.jitter_s, 0.0, 1000.0, kMilli},
           {"crystal_ppm", &finder.crystal_ppm, -10'000.0, 10'000.0},
           {"usb_ms", &finder.usb_s, 0.0, 100.0, kMilli}},
          {}};
}

Section inclinometer_section(InclinometerProfile& inclinometer) {
  return {"inclinometer",
          {{"unit", choice_of(inclinometer.unit, {"none", "cia410"})},
           {"node", &inclinometer.node, 1.0, 127.0},
           {"resolution", &inclinometer.resolution, 1.0, 1000.0}},
          {}};
}

Section stands_section(Scenario& scenario, ScenarioExtras& extras) {
  return {"stands",
          {{"change", choice_of(scenario.change, {"at_times", "on_scan_end"})},
           {"dwell_s", &scenario.drive.period_s, 0.001, 1e6},
           {"path_step_m", &extras.path_step_m, 0.01, 1000.0}},
          {}};
}

Section drive_section(DriveConfig& drive) {
  return {"drive",
          {{"stands", &drive.stands, 1.0, 100'000.0},
           {"step_m", &drive.step_m, 0.01, 1000.0},
           {"turn_sigma_deg", &drive.turn_sigma_rad, 0.0, 360.0, kDegree},
           {"clearance_m", &drive.clearance_m, 0.0, 100.0},
           {"margin_m", &drive.margin_m, 0.0, 10'000.0},
           {"kidnap_share", &drive.kidnap_share, 0.0, 1.0}},
          {}};
}

}  // namespace

Section base_section(Scenario& scenario, ScenarioExtras& extras) {
  return {"",
          {{"world", &extras.world},
           {"world_seed", &extras.world_seed, 0.0, kSeedMax},
           {"head", choice_of(extras.head, {"paper", "fast"})},
           {"seed", &scenario.seed, 0.0, kSeedMax}},
          {}};
}

std::vector<Section> sections_of(Scenario& scenario, ScenarioExtras& extras) {
  return {mount_section(scenario.mount),
          ptu_section(scenario.head.ptu),
          rangefinder_section(scenario.head.rangefinder),
          inclinometer_section(scenario.head.inclinometer),
          stands_section(scenario, extras),
          drive_section(scenario.drive)};
}

Section waypoint_section(core::Point2& waypoint_W) {
  return {"waypoint",
          {{"x_m", &waypoint_W.x(), -kFar_m, kFar_m}, {"y_m", &waypoint_W.y(), -kFar_m, kFar_m}},
          {},
          {"x_m", "y_m"}};
}

Section kidnap_section(Kidnap& kidnap) {
  return {"kidnap",
          {{"at_s", &kidnap.at_s, 0.0, kLatest_s},
           {"x_m", &kidnap.pose_W.x_m, -kFar_m, kFar_m},
           {"y_m", &kidnap.pose_W.y_m, -kFar_m, kFar_m},
           {"heading_deg", &kidnap.pose_W.heading_rad, -360.0, 360.0, kDegree}},
          {},
          {"at_s", "x_m", "y_m"}};
}

Section fault_section(PlannedFault& fault, const HeadProfile& head) {
  return {"fault",
          {{"device", device_choice(fault.device)},
           {"kind", kind_choice(fault.kind)},
           {"at_s", &fault.at_s, 0.0, kLatest_s},
           {"duration_s", &fault.duration_s, 0.0, 1e6}},
          {},
          {"device", "kind", "at_s"},
          [&fault, &head] { return misfit(head, fault.device, fault.kind); }};
}

Section rate_section(FaultRate& rate, const HeadProfile& head) {
  return {"fault_rate",
          {{"device", device_choice(rate.device)},
           {"kind", kind_choice(rate.kind)},
           {"rhythm", choice_of(rate.rhythm, {"chance", "regular"})},
           {"mean_gap_s", &rate.mean_gap_s, 0.001, kLatest_s},
           {"from_s", &rate.from_s, 0.0, kLatest_s},
           {"until_s", &rate.until_s, 0.0, kLatest_s},
           {"duration_s", &rate.duration_s, 0.0, 1e6}},
          {},
          {"device", "kind", "mean_gap_s"},
          [&rate, &head] { return misfit(head, rate.device, rate.kind); }};
}

std::vector<StandConfig> stands_on_path(const std::vector<core::Point2>& waypoints_W, double step_m) {
  std::vector<StandConfig> stands;
  double next_m = 0.0;  // from the begin of the leg to the next stand
  for (std::size_t i = 1; i < waypoints_W.size(); ++i) {
    const core::Point2 leg_W = waypoints_W[i] - waypoints_W[i - 1];
    const double length_m = leg_W.norm();
    for (; next_m <= length_m; next_m += step_m) {
      const core::Point2 p_W = waypoints_W[i - 1] + leg_W * (next_m / length_m);
      stands.push_back({{p_W.x(), p_W.y(), std::atan2(leg_W.y(), leg_W.x())}});
    }
    next_m -= length_m;
  }
  return stands;
}

}  // namespace slamsensor::tools
