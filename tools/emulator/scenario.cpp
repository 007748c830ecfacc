#include "tools/emulator/scenario.hpp"

#include "tools/emulator/head_devices.hpp"
#include "tools/world/section.hpp"
#include "tools/world/section_reader.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace slamsensor::tools {
namespace {

/// What a scenario file says that goes into a Scenario by a detour.
struct ScenarioExtras {
  std::string world;             ///< path of the world file
  std::uint64_t world_seed = 0;  ///< instead of the one in the world file; 0 for that one
  HeadKind head = HeadKind::Paper;
  double path_step_m = 5.0;  ///< from a stand to the next on the path of the waypoints
  std::vector<StandConfig> stands;
  std::vector<core::Point2> waypoints;
};

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

/// The keys at the top of a scenario file that say what the others start from.
Section base_section(Scenario& scenario, ScenarioExtras& extras) {
  return {"",
          {{"world", &extras.world},
           {"world_seed", &extras.world_seed, 0.0, kSeedMax},
           {"head", choice_of(extras.head, {"paper", "fast"})},
           {"seed", &scenario.seed, 0.0, kSeedMax}},
          {}};
}

/// Its tables that appear at most once. The pointers are into the arguments.
std::vector<Section> sections_of(Scenario& scenario, ScenarioExtras& extras) {
  return {mount_section(scenario.mount),
          ptu_section(scenario.head.ptu),
          rangefinder_section(scenario.head.rangefinder),
          inclinometer_section(scenario.head.inclinometer),
          stands_section(scenario, extras),
          drive_section(scenario.drive)};
}

/// The keys of one [[waypoint]], [[kidnap]], [[fault]], [[fault_rate]]; those of a [[stand]] are those of a
/// world's.
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

/// Reads one scenario file; what others are checked against or start from is read first.
class ScenarioReader {
 public:
  ScenarioReader(std::string_view name, std::filesystem::path folder, std::optional<HeadKind> kind)
      : reader_(name), folder_(std::move(folder)), kind_(kind) {}

  tl::expected<Scenario, WorldError> read(const toml::table& file) {
    read_base(file);
    const std::vector<Section> sections = sections_of(scenario_, extras_);
    for (const std::string_view device : {"ptu", "rangefinder"}) {
      const toml::node* const node = file.get(device);
      if (node != nullptr && !reader_.problem()) {
        reader_.read_known(sections, device, *node);
      }
    }
    for (const auto& [key, node] : file) {
      if (!reader_.problem() && !read_rest(sections, key.str(), node)) {
        reader_.refuse_unknown(key);
      }
    }
    place_stands(file);
    if (reader_.problem()) {
      return tl::unexpected(*reader_.problem());
    }
    return std::move(scenario_);
  }

 private:
  void read_base(const toml::table& file) {
    const std::vector<Section> base = {base_section(scenario_, extras_)};
    for (const auto& [key, node] : file) {
      if (!reader_.problem()) {
        reader_.read_known(base, key.str(), node);
      }
    }
    scenario_.head = head_profile(kind_.value_or(extras_.head));
    if (!reader_.problem()) {
      read_world(*file.get("world"));
    }
  }

  void read_world(const toml::node& node) {
    auto world = load_world(folder_ / extras_.world);
    if (!world) {
      reader_.refuse(node.source(), "world: " + world.error().message);
      return;
    }
    scenario_.world = std::move(*world);
    scenario_.world.seed = extras_.world_seed != 0 ? extras_.world_seed : scenario_.world.seed;
  }

  bool read_rest(const std::vector<Section>& sections, std::string_view key, const toml::node& node) {
    const auto fault = [this](PlannedFault& item) { return fault_section(item, scenario_.head); };
    const auto rate = [this](FaultRate& item) { return rate_section(item, scenario_.head); };
    const auto stand = [](StandConfig& item) { return section_of(item); };
    const std::vector<std::string_view> read = {"world", "world_seed", "head", "seed", "ptu", "rangefinder"};
    return std::find(read.begin(), read.end(), key) != read.end() ||
           reader_.read_known(sections, key, node) ||
           reader_.read_list("stand", key, node, extras_.stands, stand) ||
           reader_.read_list("waypoint", key, node, extras_.waypoints, waypoint_section) ||
           reader_.read_list("kidnap", key, node, scenario_.kidnaps, kidnap_section) ||
           reader_.read_list("fault", key, node, scenario_.faults, fault) ||
           reader_.read_list("fault_rate", key, node, scenario_.rates, rate);
  }

  void place_stands(const toml::table& file) {
    const std::vector<core::Point2>& way = extras_.waypoints;
    if (reader_.problem() || (way.empty() && extras_.stands.empty())) {
      return;
    }
    const bool stays = std::adjacent_find(way.begin(), way.end()) != way.end();
    if (!way.empty() && !extras_.stands.empty()) {
      reader_.refuse(file.get("waypoint")->source(),
                     "[[waypoint]] and [[stand]] both say where the sensor is put; remove one of them");
    } else if (!way.empty() && (way.size() < 2 || stays)) {
      reader_.refuse(file.get("waypoint")->source(),
                     "[[waypoint]]: a path has two or more, and no two after each other at one place");
    } else {
      scenario_.world.stands = way.empty() ? extras_.stands : stands_on_path(way, extras_.path_step_m);
    }
  }

  SectionReader reader_;
  std::filesystem::path folder_;
  std::optional<HeadKind> kind_;
  Scenario scenario_;
  ScenarioExtras extras_;
};

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
  return ScenarioReader(name, folder, kind).read(*file);
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
