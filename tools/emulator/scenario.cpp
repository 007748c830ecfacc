#include "tools/emulator/scenario.hpp"

#include "core/config.hpp"
#include "tools/emulator/head_devices.hpp"
#include "tools/world/toml_file.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace slamsensor::tools {
namespace {

using core::kDegree;
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

const std::vector<std::string_view> kBegins = {"power_up", "ready"};

std::vector<std::string_view> fault_names() {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < kFaultKinds; ++i) {
    names.push_back(name_of(static_cast<FaultKind>(i)));
  }
  return names;
}

void read_mount(TomlTable& table, SweepConfig& mount) {
  table.number("height_m", mount.mount_height_m, 0.0, 100.0)
      .number("roll_deg", mount.roll_rad, -45.0, 45.0, kDegree)
      .number("pitch_deg", mount.pitch_rad, -45.0, 45.0, kDegree);
}

void read_ptu(TomlTable& table, PtuProfile& ptu) {
  table.choice("unit", ptu.unit, words_of(kPtuUnits))
      .choice("begin", ptu.begin, kBegins)
      .choice("encoder", ptu.encoder, {"absolute", "incremental"})
      .count("baud", ptu.baud, kBaudMin, kBaudMax)
      .number("reply_latency_ms", ptu.reply_latency_s, 0.0, 1000.0, kMilli)
      .number("reply_jitter_ms", ptu.reply_jitter_s, 0.0, 1000.0, kMilli)
      .number("position_age_ms", ptu.position_age_s, 0.0, 1000.0, kMilli)
      .number("boot_s", ptu.boot_s, 0.0, 60.0)
      .number("reset_s", ptu.reset_s, 0.0, 60.0)
      .number("usb_ms", ptu.usb_s, 0.0, 100.0, kMilli);
}

void read_rangefinder(TomlTable& table, RangefinderProfile& finder) {
  table.choice("unit", finder.unit, words_of(kRangefinderUnits))
      .choice("begin", finder.begin, kBegins)
      .count("baud", finder.baud, kBaudMin, kBaudMax)
      .number("rate_hz", finder.rate_hz, 1.0, 40'000.0)
      .number("latency_ms", finder.latency_s, 0.0, 1000.0, kMilli)
      .number("jitter_ms", finder.jitter_s, 0.0, 1000.0, kMilli)
      .number("crystal_ppm", finder.crystal_ppm, -10'000.0, 10'000.0)
      .number("usb_ms", finder.usb_s, 0.0, 100.0, kMilli);
}

void read_inclinometer(TomlTable& table, InclinometerProfile& inclinometer) {
  table.choice("unit", inclinometer.unit, {"none", "cia410"})
      .count("node", inclinometer.node, 1.0, 127.0)
      .count("resolution", inclinometer.resolution, 1.0, 1000.0);
}

void read_drive(TomlTable& table, DriveConfig& drive) {
  table.count("stands", drive.stands, 1.0, 100'000.0)
      .number("step_m", drive.step_m, 0.01, 1000.0)
      .number("turn_sigma_deg", drive.turn_sigma_rad, 0.0, 360.0, kDegree)
      .number("clearance_m", drive.clearance_m, 0.0, 100.0)
      .number("margin_m", drive.margin_m, 0.0, 10'000.0)
      .number("kidnap_share", drive.kidnap_share, 0.0, 1.0);
}

void read_waypoint(TomlTable& table, core::Point2& waypoint_W) {
  table.needs({"x_m", "y_m"})
      .number("x_m", waypoint_W.x(), -kFar_m, kFar_m)
      .number("y_m", waypoint_W.y(), -kFar_m, kFar_m);
}

void read_kidnap(TomlTable& table, Kidnap& kidnap) {
  table.needs({"at_s", "x_m", "y_m"})
      .number("at_s", kidnap.at_s, 0.0, kLatest_s)
      .number("x_m", kidnap.pose_W.x_m, -kFar_m, kFar_m)
      .number("y_m", kidnap.pose_W.y_m, -kFar_m, kFar_m)
      .number("heading_deg", kidnap.pose_W.heading_rad, -360.0, 360.0, kDegree);
}

/// The device and kind of a fault that `head` can have.
template <typename Faulty>
void read_fault_kind(TomlTable& table, Faulty& fault, const HeadProfile& head) {
  const std::vector<std::string_view> devices = {kPtuName, kRangefinderName, kCanName};
  std::size_t device = 0;
  table.choice("device", device, devices).choice("kind", fault.kind, fault_names());
  fault.device = devices[device];
  table.refuse(misfit(head, fault.device, fault.kind));
}

void read_fault(TomlTable& table, PlannedFault& fault, const HeadProfile& head) {
  table.needs({"device", "kind", "at_s"})
      .number("at_s", fault.at_s, 0.0, kLatest_s)
      .number("duration_s", fault.duration_s, 0.0, 1e6);
  read_fault_kind(table, fault, head);
}

void read_rate(TomlTable& table, FaultRate& rate, const HeadProfile& head) {
  table.needs({"device", "kind", "mean_gap_s"})
      .choice("rhythm", rate.rhythm, {"chance", "regular"})
      .number("mean_gap_s", rate.mean_gap_s, 0.001, kLatest_s)
      .number("from_s", rate.from_s, 0.0, kLatest_s)
      .number("until_s", rate.until_s, 0.0, kLatest_s)
      .number("duration_s", rate.duration_s, 0.0, 1e6);
  read_fault_kind(table, rate, head);
}

/// Stands every `step_m` (positive) along the line through `waypoints_W` (two or more, no two neighbours at
/// one place), each with the heading of the line; the first at its begin.
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

}  // namespace

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

namespace {

void read_world(TomlFile& file, Scenario& scenario, const std::filesystem::path& folder) {
  std::string name;
  std::uint64_t seed = 0;  // instead of the one in the world file; 0 for that one
  file.top().text("world", name).count("world_seed", seed, 0.0, kSeedMax);
  if (name.empty()) {
    file.refuse(file.top().take("world"), "world is the path of a world file");
    return;
  }
  scenario.world_file = folder / name;
  auto world = load_world(scenario.world_file);
  if (!world) {
    file.refuse(file.top().take("world"), "world: " + world.error().message);
    return;
  }
  scenario.world = std::move(*world);
  scenario.world.seed = seed != 0 ? seed : scenario.world.seed;
}

/// [[stand]], or the [[waypoint]]s of a path with a stand every so often; without either the world's stay.
void read_places(TomlFile& file, Scenario& scenario) {
  double path_step_m = 5.0;
  std::vector<StandConfig> stands;
  std::vector<core::Point2> way;
  file.table("stands", scenario, [&](TomlTable& table, Scenario& into) {
    table.choice("change", into.change, {"at_times", "on_scan_end"})
        .number("dwell_s", into.drive.period_s, 0.001, 1e6)
        .number("path_step_m", path_step_m, 0.01, 1000.0);
  });
  file.list("stand", stands, read_stand);
  file.list("waypoint", way, read_waypoint);
  const bool stays = std::adjacent_find(way.begin(), way.end()) != way.end();
  if (!way.empty() && !stands.empty()) {
    file.refuse(file.top().take("waypoint"),
                "[[waypoint]] and [[stand]] both say where the sensor is put; remove one of them");
  } else if (!way.empty() && (way.size() < 2 || stays)) {
    file.refuse(file.top().take("waypoint"),
                "[[waypoint]]: a path has two or more, and no two after each other at one place");
  } else if (!way.empty() || !stands.empty()) {
    scenario.world.stands = way.empty() ? stands : stands_on_path(way, path_step_m);
  }
}

/// What others are checked against or start from is read first.
tl::expected<Scenario, WorldError> read_scenario(const toml::table& root, std::string_view name,
                                                 const std::filesystem::path& folder,
                                                 std::optional<HeadKind> kind) {
  TomlFile file(root, name);
  Scenario scenario;
  HeadKind head = HeadKind::Paper;
  file.top().choice("head", head, {"paper", "fast"}).count("seed", scenario.seed, 0.0, kSeedMax);
  scenario.head = head_profile(kind.value_or(head));
  read_world(file, scenario, folder);
  file.table("ptu", scenario.head.ptu, read_ptu);
  file.table("rangefinder", scenario.head.rangefinder, read_rangefinder);
  file.table("inclinometer", scenario.head.inclinometer, read_inclinometer);
  file.table("mount", scenario.mount, read_mount);
  file.table("drive", scenario.drive, read_drive);
  read_places(file, scenario);
  file.list("kidnap", scenario.kidnaps, read_kidnap);
  file.list("fault", scenario.faults,
            [&](TomlTable& table, PlannedFault& fault) { read_fault(table, fault, scenario.head); });
  file.list("fault_rate", scenario.rates,
            [&](TomlTable& table, FaultRate& rate) { read_rate(table, rate, scenario.head); });
  if (auto problem = file.finish()) {
    return tl::unexpected(std::move(*problem));
  }
  return scenario;
}

Scenario drive_through(WorldConfig world, std::optional<HeadKind> kind) {
  Scenario scenario;
  scenario.world = std::move(world);
  scenario.head = head_profile(kind.value_or(HeadKind::Paper));
  return scenario;
}

}  // namespace

tl::expected<Scenario, WorldError> parse_scenario(std::string_view toml, std::string_view name,
                                                  const std::filesystem::path& folder,
                                                  std::optional<HeadKind> kind) {
  const auto file = parse_toml(toml, name);
  if (!file) {
    return tl::unexpected(file.error());
  }
  if (!file->contains("world")) {
    return parse_world(toml, name, folder).map([kind](WorldConfig world) {
      return drive_through(std::move(world), kind);
    });
  }
  return read_scenario(*file, name, folder, kind);
}

tl::expected<Scenario, WorldError> load_scenario(const std::filesystem::path& path,
                                                 std::optional<HeadKind> kind) {
  const auto text = read_text(path, "world or scenario file");
  if (!text) {
    return tl::unexpected(text.error());
  }
  return parse_scenario(*text, path.string(), path.parent_path(), kind);
}

std::optional<WorldError> find_problem(const Scenario& scenario) {
  const auto check = [&](std::string_view device, FaultKind kind) {
    return misfit(scenario.head, device, kind);
  };
  std::string wrong;
  for (const PlannedFault& fault : scenario.faults) {
    wrong = wrong.empty() ? check(fault.device, fault.kind) : wrong;
  }
  for (const FaultRate& rate : scenario.rates) {
    wrong = wrong.empty() ? check(rate.device, rate.kind) : wrong;
    wrong = wrong.empty() && !(rate.mean_gap_s > 0.0) ? "fault rate: mean gap must be above zero" : wrong;
  }
  return wrong.empty() ? std::nullopt : std::optional(WorldError{wrong});
}

}  // namespace slamsensor::tools
