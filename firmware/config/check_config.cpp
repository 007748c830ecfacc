#include "firmware/config/load_config.hpp"
#include "firmware/device/head_drivers.hpp"
#include "firmware/scan/scan_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <sys/stat.h>
#include <system_error>
#include <vector>

namespace slamsensor::firmware {
namespace {

/// Collects the rules between keys that a configuration breaks. A rule names its keys, first the one whose
/// value is called wrong.
class Rules {
 public:
  /// Rules about a key that `known` names are left out. Both outlive this.
  Rules(const LoadedConfig& loaded, const std::vector<ConfigError>& known) : loaded_(loaded), known_(known) {}

  /// `what` stands in the message between the value of the first key and those of the others.
  void require(bool holds, std::initializer_list<std::string_view> keys, const std::string& what);

  /// A driver refuses `section` (or one key), for the reason `what`, which is reported at the key that it
  /// names. Left out when a mistake of the section is known already.
  void refuse_section(std::string_view section, const std::string& what);

  [[nodiscard]] const Config& config() const { return loaded_.config; }
  [[nodiscard]] std::vector<ConfigError> take_errors() { return std::move(errors_); }

 private:
  [[nodiscard]] bool is_known(std::string_view key) const;
  [[nodiscard]] std::string value(std::string_view key) const;

  const LoadedConfig& loaded_;
  const std::vector<ConfigError>& known_;
  std::vector<ConfigError> errors_;
};

/// Also in one that belongs to it: canopen and canopen_pan.
bool is_in_section(const ConfigError& error, std::string_view section) {
  return error.key.starts_with(section);
}

void Rules::require(bool holds, std::initializer_list<std::string_view> keys, const std::string& what) {
  if (holds || std::any_of(keys.begin(), keys.end(), [&](std::string_view key) { return is_known(key); })) {
    return;
  }
  Origin place;
  std::string others;
  for (const std::string_view key : keys) {
    const Origin& origin = loaded_.origin(key);
    place = place.is_default() ? origin : place;
    if (key != *keys.begin()) {
      others += (others.empty() ? " " : ", ") + std::string(key) + " = " + value(key) + " (" +
                origin.short_text() + ')';
    }
  }
  const std::string_view first = *keys.begin();
  errors_.push_back({place, std::string(first),
                     "value " + value(first) + ' ' + what + others +
                         (keys.size() == 1 ? "; change it" : "; change one of them")});
}

void Rules::refuse_section(std::string_view section, const std::string& what) {
  const auto is_here = [&](const ConfigError& error) { return is_in_section(error, section); };
  if (std::any_of(known_.begin(), known_.end(), is_here) ||
      std::any_of(errors_.begin(), errors_.end(), is_here)) {
    return;
  }
  std::string_view at = section;
  Origin place = loaded_.origin(section);  // a driver may name a key instead
  for (const Setting& setting : settings()) {
    const bool is_named = setting.section() == section && what.find(setting.key()) != std::string::npos;
    const Origin& origin = loaded_.origin(setting.path);
    if (is_named && (at == section || !origin.is_default())) {
      at = setting.path;
      place = origin;
    }
  }
  errors_.push_back({place, std::string(at), what});
}

bool Rules::is_known(std::string_view key) const {
  return std::any_of(known_.begin(), known_.end(),
                     [&](const ConfigError& error) { return error.key == key; });
}

std::string Rules::value(std::string_view key) const {
  const Setting& setting = settings()[find_setting(key).value()];
  return value_text(setting, loaded_.config).value_or("none");
}

constexpr double kGridCellsMax = 2e7;  // the paper's grid has 420,600 cells

double grid_columns(const core::DetectionConfig& detection) {
  return std::ceil(2.0 * std::numbers::pi / detection.bearing_step_rad);
}

double grid_cells(const core::DetectionConfig& detection) {
  return std::ceil(detection.range_max_m / detection.range_step_m) * grid_columns(detection);
}

/// Edges that a map of `landmarks` needs at `depth`: a triangular lattice has 3 depth (depth + 1) / 2 for a
/// landmark, and 1000 random points have 9784 at depth 2 (DESIGN 2.3), a tenth more than the lattice.
double edges_needed(double landmarks, double depth) {
  return std::ceil(
      std::min(1.1 * 1.5 * depth * (depth + 1.0) * landmarks, 0.5 * landmarks * (landmarks - 1.0)));
}

void check_method(Rules& rules) {
  const core::DetectionConfig& detection = rules.config().core.detection;
  const core::AssociationConfig& association = rules.config().core.association;
  const core::Capacities& capacities = rules.config().core.capacities;
  const double cells = grid_cells(detection);
  const double edges = edges_needed(capacities.map_landmarks, association.depth);
  rules.require(detection.tilt_min_rad <= detection.tilt_max_rad,
                {"detection.tilt_min_deg", "detection.tilt_max_deg"}, "is above");
  rules.require(detection.range_min_m < detection.range_max_m,
                {"detection.range_min_m", "detection.range_max_m"}, "is not below");
  rules.require(detection.range_step_m <= detection.range_max_m,
                {"detection.range_step_m", "detection.range_max_m"}, "is above");
  rules.require(cells <= kGridCellsMax,
                {"detection.range_step_m", "detection.bearing_step_deg", "detection.range_max_m"},
                "makes a grid of " + real_text(cells) + " cells, more than the allowed " +
                    real_text(kGridCellsMax) + ", with");
  rules.require(capacities.occupied_cells >= grid_columns(detection),
                {"capacities.occupied_cells", "detection.bearing_step_deg"},
                "is too small for the cells of one scanline all the way round,");
  rules.require(detection.landmarks_max == 0 || detection.landmarks_max >= 3, {"detection.landmarks_max"},
                "is neither 0 nor at least 3");
  const std::string one_scan =
      "is too small for the " + std::to_string(detection.detected_most()) + " landmarks of one scan,";
  rules.require(capacities.scan_landmarks >= detection.detected_most(),
                {"capacities.scan_landmarks", "detection.landmarks_max"}, one_scan);
  rules.require(capacities.map_landmarks >= detection.detected_most(),
                {"capacities.map_landmarks", "detection.landmarks_max"}, one_scan);
  rules.require(capacities.map_edges >= edges,
                {"capacities.map_edges", "capacities.map_landmarks", "association.depth"},
                "is too small: " + std::to_string(static_cast<long long>(edges)) + " edges are needed with");
}

void check_scan(Rules& rules) {
  const ScanConfig& scan = rules.config().scan_head.scan;
  const double lines = std::floor((scan.tilt_max_rad - scan.tilt_min_rad) / scan.tilt_step_rad) + 1.0;
  rules.require(scan.pan_min_rad < scan.pan_max_rad, {"scan.pan_min_deg", "scan.pan_max_deg"},
                "is not below");
  rules.require(scan.tilt_min_rad <= scan.tilt_max_rad, {"scan.tilt_min_deg", "scan.tilt_max_deg"},
                "is above");
  rules.require(lines <= kScanlinesMax, {"scan.tilt_step_deg", "scan.tilt_min_deg", "scan.tilt_max_deg"},
                "makes " + real_text(lines) + " scanlines, more than the allowed " +
                    std::to_string(kScanlinesMax) + ", with");
  rules.require(scan.calibration_lines % 2 == 0, {"scan.calibration_lines"},
                "is odd, but each line needs one swept the other way");
}

/// A number that the settings alone say, and the key that says it.
struct Told {
  std::string_view key;
  double value;

  friend bool operator<(const Told& a, const Told& b) { return a.value < b.value; }
};

/// The rate of readings, Hz; none for a rangefinder whose product has rates of its own.
std::optional<Told> told_rate(const HeadConfig& head) {
  switch (head.rangefinder) {
    case RangefinderKind::BenewakeSerial:
    case RangefinderKind::BenewakeCan:
      return Told{"benewake.rate_hz", head.benewake_serial.device.rate_hz};
    case RangefinderKind::PointLaser:
      return Told{"point_laser.rate_hz", head.point_laser.rate_hz};
    case RangefinderKind::Lwnx:
      break;
  }
  return std::nullopt;
}

/// The readings of the sweep that is asked for; what the devices report is plan_scan's affair.
void check_readings_per_line(Rules& rules) {
  const HeadConfig& head = rules.config().head;
  const ScanConfig& scan = rules.config().scan_head.scan;
  const std::optional<Told> rate = told_rate(head);
  if (!rate) {
    return;
  }
  Told from{"scan.pan_min_deg", scan.pan_min_rad};
  Told to{"scan.pan_max_deg", scan.pan_max_rad};
  Told speed{"scan.pan_speed_deg_s", scan.pan_speed_radps};
  if (head.pan_tilt == PanTiltKind::Canopen) {
    from = std::max(from, {"canopen_pan.min_deg", head.canopen.pan.min_rad});
    to = std::min(to, {"canopen_pan.max_deg", head.canopen.pan.max_rad});
    speed = std::min(speed, {"canopen_pan.speed_max_deg_s", head.canopen.pan.speed_max_radps});
  }
  const double sweep_s = (to.value - from.value) / speed.value;
  const double readings = std::ceil(rate->value * (sweep_s + scan.late_data_s));
  rules.require(readings <= scan.readings_per_line_max,
                {"scan.readings_per_line_max", rate->key, from.key, to.key, speed.key, "scan.late_data_s"},
                "is too small: set at least " + std::to_string(static_cast<long long>(readings)) +
                    " for the readings of one sweep with");
}

void check_pan_tilt(Rules& rules) {
  const hal::PtuConfig& ptu = rules.config().head.ptu;
  const hal::CanopenConfig& canopen = rules.config().head.canopen;
  rules.require(ptu.fast_baud == 0 || ptu.fast_baud >= 300, {"ptu.fast_baud"},
                "is neither 0 nor at least 300");
  rules.require(canopen.pan.node != canopen.tilt.node, {"canopen_pan.node", "canopen_tilt.node"},
                "is the same as");
  rules.require(canopen.pan.min_rad < canopen.pan.max_rad, {"canopen_pan.min_deg", "canopen_pan.max_deg"},
                "is not below");
  rules.require(canopen.tilt.min_rad < canopen.tilt.max_rad, {"canopen_tilt.min_deg", "canopen_tilt.max_deg"},
                "is not below");
}

bool strengths_agree(const hal::RangeConfig& range) {
  return range.weak_below < range.saturated_from;
}

bool id_fits(std::uint32_t id, bool is_extended) {
  return is_extended || id <= 0x7FF;
}

/// Whether a frame of 11 bits with this identifier is one of CANopen's: of the whole network, or of `node`.
bool is_canopen_id(std::uint32_t id, std::uint32_t node) {
  constexpr std::array<std::uint32_t, 4> kOfAll = {0x000, 0x080, 0x100, 0x7E5};  // NMT, SYNC, TIME, LSS
  constexpr std::array<std::uint32_t, 12> kOfNode = {0x080, 0x180, 0x200, 0x280, 0x300, 0x380,
                                                     0x400, 0x480, 0x500, 0x580, 0x600, 0x700};
  return std::find(kOfAll.begin(), kOfAll.end(), id) != kOfAll.end() ||
         std::any_of(kOfNode.begin(), kOfNode.end(), [&](std::uint32_t base) { return base + node == id; });
}

/// Devices on one bus differ by their identifiers alone.
void check_can_ids(Rules& rules) {
  const HeadConfig& head = rules.config().head;
  const hal::BenewakeCanConfig& can = head.benewake_can;
  if (head.rangefinder != RangefinderKind::BenewakeCan) {
    return;
  }
  rules.require(can.device_id != can.host_id || can.device_id_is_extended != can.host_id_is_extended,
                {"benewake_can.device_id", "benewake_can.host_id"}, "is the same as");
  if (head.pan_tilt != PanTiltKind::Canopen) {
    return;
  }
  const auto is_free = [&](std::uint32_t id, bool is_extended) {
    return is_extended ||
           (!is_canopen_id(id, head.canopen.pan.node) && !is_canopen_id(id, head.canopen.tilt.node));
  };
  rules.require(is_free(can.device_id, can.device_id_is_extended),
                {"benewake_can.device_id", "canopen_pan.node", "canopen_tilt.node"},
                "is an identifier that CANopen uses on the same bus, with");
  rules.require(is_free(can.host_id, can.host_id_is_extended),
                {"benewake_can.host_id", "canopen_pan.node", "canopen_tilt.node"},
                "is an identifier that CANopen uses on the same bus, with");
}

void check_rangefinder(Rules& rules) {
  const HeadConfig& head = rules.config().head;
  const hal::BenewakeCanConfig& can = head.benewake_can;
  rules.require(strengths_agree(head.lwnx.range), {"lwnx.weak_below", "lwnx.saturated_from"}, "is not below");
  rules.require(strengths_agree(head.benewake_serial.device.range),
                {"benewake.weak_below", "benewake.saturated_from"}, "is not below");
  rules.require(strengths_agree(head.point_laser.range),
                {"point_laser.weak_below", "point_laser.saturated_from"}, "is not below");
  rules.require(id_fits(can.device_id, can.device_id_is_extended),
                {"benewake_can.device_id", "benewake_can.device_id_is_extended"},
                "has more than 11 bits with");
  rules.require(id_fits(can.host_id, can.host_id_is_extended),
                {"benewake_can.host_id", "benewake_can.host_id_is_extended"}, "has more than 11 bits with");
}

/// Whether two paths lead to one device: by symbolic links, by `..`, or as two nodes of it.
bool is_one_device(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) {
    return false;
  }
  std::error_code error;  // what is not plugged in yet has its own name alone
  if (a == b || std::filesystem::weakly_canonical(a, error) == std::filesystem::weakly_canonical(b, error)) {
    return true;
  }
  struct stat first {};
  struct stat second {};
  return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 && S_ISCHR(first.st_mode) &&
         S_ISCHR(second.st_mode) && first.st_rdev == second.st_rdev;
}

void check_ports(Rules& rules) {
  const HeadConfig& head = rules.config().head;
  const std::string& nmea = rules.config().daemon.nmea_serial.path;
  const bool has_pan_tilt = head.pan_tilt == PanTiltKind::Ptu;
  const bool has_rangefinder = head.rangefinder != RangefinderKind::BenewakeCan;
  const std::string& pan_tilt = head.pan_tilt_port.path;
  const std::string& rangefinder = head.rangefinder_port.path;
  const std::string what = "is the same as";
  rules.require(!has_pan_tilt || !has_rangefinder || !is_one_device(pan_tilt, rangefinder),
                {"pan_tilt_port.path", "rangefinder_port.path"}, what);
  rules.require(!has_pan_tilt || !is_one_device(nmea, pan_tilt), {"nmea.serial_path", "pan_tilt_port.path"},
                what);
  rules.require(!has_rangefinder || !is_one_device(nmea, rangefinder),
                {"nmea.serial_path", "rangefinder_port.path"}, what);
}

/// The chosen one of the two, which share their settings; the bus allows less.
RangefinderKind benewake_kind(const HeadConfig& head) {
  return head.rangefinder == RangefinderKind::BenewakeCan ? RangefinderKind::BenewakeCan
                                                          : RangefinderKind::BenewakeSerial;
}

/// Makes links and drivers as the daemon will; nothing is opened by that.
void try_head(Rules& rules, const HeadConfig& head) {
  const auto refuse = [&](const hal::InitError& error) {
    const std::size_t colon = error.message.find(": ");
    rules.refuse_section(std::string_view(error.message).substr(0, colon), error.message.substr(colon + 2));
  };
  const auto links = open_head_links(head);
  if (!links) {
    refuse(links.error());
    return;
  }
  if (const auto drivers = make_head_drivers(head, links->get()); !drivers) {
    refuse(drivers.error());
  }
}

/// A driver is made of every kind, also of those not chosen: what none of them refuses here, the daemon's
/// will not refuse later.
void check_drivers(Rules& rules) {
  const HeadConfig& chosen = rules.config().head;
  for (const PanTiltKind kind : {PanTiltKind::Ptu, PanTiltKind::Canopen}) {
    HeadConfig head = chosen;
    head.pan_tilt = kind;
    head.rangefinder = benewake_kind(chosen);
    const hal::BenewakeCanConfig& can = chosen.benewake_can;
    if (head.rangefinder != RangefinderKind::BenewakeCan ||
        id_fits(can.device_id, can.device_id_is_extended)) {
      try_head(rules, head);
    }
  }
  for (const RangefinderKind kind : {RangefinderKind::Lwnx, RangefinderKind::PointLaser}) {
    HeadConfig head = chosen;
    head.pan_tilt = PanTiltKind::Ptu;
    head.rangefinder = kind;
    try_head(rules, head);
  }
}

void check_inclination(Rules& rules) {
  const HeadConfig& head = rules.config().head;
  const LevellingConfig& levelling = rules.config().scan_head.levelling;
  const bool shares_bus = levelling.source == InclinationSource::Can &&
                          head.pan_tilt == PanTiltKind::Canopen &&
                          head.cia410.interface == head.can_interface;
  rules.require(!shares_bus || head.cia410.node != head.canopen.pan.node,
                {"inclination.can_node", "canopen_pan.node"}, "is the same as");
  rules.require(!shares_bus || head.cia410.node != head.canopen.tilt.node,
                {"inclination.can_node", "canopen_tilt.node"}, "is the same as");
  for (const InclinationSource source : {InclinationSource::Can, InclinationSource::Iio}) {
    if (const auto opened = open_inclinometer(head, source); !opened) {
      rules.refuse_section("inclination", opened.error().message);
    }
  }
}

void check_head(Rules& rules) {
  check_ports(rules);
  check_pan_tilt(rules);
  check_rangefinder(rules);
  check_can_ids(rules);
  check_scan(rules);
  check_readings_per_line(rules);
  check_drivers(rules);
  check_inclination(rules);
}

/// A sentence has at most 82 characters of 10 bits.
void check_nmea(Rules& rules) {
  constexpr double kSentenceBits = 820.0;
  const Config& config = rules.config();
  const NmeaSentences& chosen = config.nmea.sentences;
  const int sentences =
      chosen.rmc + chosen.gga + chosen.gbs + chosen.hdt + chosen.ths + chosen.gst + chosen.pslma;
  const double needed = kSentenceBits * sentences * config.daemon.nmea_rate_hz;
  rules.require(config.daemon.nmea_serial.path.empty() || needed <= config.daemon.nmea_serial.baud,
                {"nmea.rate_hz", "nmea.serial_baud", "nmea.sentences"},
                "needs up to " + real_text(needed) + " bits per second, more than the line carries:");
}

void check_lcm(Rules& rules) {
  const LcmConfig& lcm = rules.config().daemon.lcm;
  bool is_own = false;
  for (const std::string_view channel : {"POSE", "STATUS", "COUNTERS", "MAP", "SCAN"}) {
    is_own = is_own || lcm.bot_core_channel == lcm.prefix + std::string(channel);
  }
  rules.require(!is_own, {"lcm.bot_core_channel", "lcm.prefix"},
                "is one of the sensor's own channels, made of");
}

struct GpioUse {
  std::string_view chip_key;
  std::string_view line_key;
  const std::string& chip;
  std::uint32_t line;
};

void check_gpio(Rules& rules) {
  const GpioConfig& gpio = rules.config().daemon.gpio;
  const std::array<GpioUse, 4> uses = {
      {{"gpio.trigger_chip", "gpio.trigger_line", gpio.trigger.chip, gpio.trigger.line},
       {"gpio.interlock_chip", "gpio.interlock_line", gpio.interlock.chip, gpio.interlock.line},
       {"gpio.led_chip", "gpio.led_line", gpio.led.chip, gpio.led.line},
       {"gpio.pulse_chip", "gpio.pulse_line", gpio.pulse.chip, gpio.pulse.line}}};
  for (std::size_t i = 0; i < uses.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const bool is_same =
          !uses[i].chip.empty() && uses[i].chip == uses[j].chip && uses[i].line == uses[j].line;
      rules.require(!is_same, {uses[i].line_key, uses[j].line_key, uses[i].chip_key},
                    "is a line that is used twice:");
    }
  }
}

void check_daemon(Rules& rules) {
  check_nmea(rules);
  check_lcm(rules);
  check_gpio(rules);
}

}  // namespace

std::vector<ConfigError> check_config(const LoadedConfig& loaded, const std::vector<ConfigError>& known) {
  Rules rules(loaded, known);
  check_head(rules);
  check_method(rules);
  check_daemon(rules);
  return rules.take_errors();
}

}  // namespace slamsensor::firmware
