#include "firmware/config/rules.hpp"
#include "firmware/device/head_drivers.hpp"
#include "firmware/device/inclinometers.hpp"
#include "firmware/scan/scan_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

namespace slamsensor::firmware {
namespace {

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
  rules.require(rules.config().scan_head.pan_fit.polls_min <= scan.polls_per_line_max,
                {"pan_fit.polls_min", "scan.polls_per_line_max"}, "is above");
}

void check_reopen(Rules& rules) {
  const HeadConfig& head = rules.config().head;
  rules.require(head.pan_tilt_port.reopen.first <= head.pan_tilt_port.reopen.longest,
                {"pan_tilt_port.reopen_first_s", "pan_tilt_port.reopen_longest_s"}, "is above");
  rules.require(head.rangefinder_port.reopen.first <= head.rangefinder_port.reopen.longest,
                {"rangefinder_port.reopen_first_s", "rangefinder_port.reopen_longest_s"}, "is above");
}

void check_pan_tilt(Rules& rules) {
  const hal::PtuConfig& ptu = rules.config().head.ptu;
  const hal::CanopenConfig& canopen = rules.config().head.canopen;
  rules.require(ptu.rest_poll_hz <= ptu.poll_hz, {"ptu.rest_poll_hz", "ptu.poll_hz"}, "is above");
  rules.require(ptu.fast_baud == 0 || ptu.fast_baud >= 300, {"ptu.fast_baud"},
                "is neither 0 nor at least 300");
  rules.require(canopen.rest_poll_hz <= canopen.poll_hz, {"canopen.rest_poll_hz", "canopen.poll_hz"},
                "is above");
  rules.require(canopen.heartbeat < canopen.heartbeat_timeout,
                {"canopen.heartbeat_s", "canopen.heartbeat_timeout_s"}, "is not below");
  rules.require(canopen.retry_first <= canopen.retry_longest,
                {"canopen.retry_first_s", "canopen.retry_longest_s"}, "is above");
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

/// Devices on one bus are told apart by their identifiers alone.
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

void check_ports(Rules& rules) {
  const HeadConfig& head = rules.config().head;
  const std::string& nmea = rules.config().daemon.nmea_serial.path;
  const bool has_pan_tilt = head.pan_tilt == PanTiltKind::Ptu;
  const bool has_rangefinder = head.rangefinder != RangefinderKind::BenewakeCan;
  rules.require(!has_pan_tilt || !has_rangefinder || head.pan_tilt_port.path != head.rangefinder_port.path,
                {"pan_tilt_port.path", "rangefinder_port.path"}, "is the same as");
  rules.require(!has_pan_tilt || nmea != head.pan_tilt_port.path, {"nmea.serial_path", "pan_tilt_port.path"},
                "is the same as");
  rules.require(!has_rangefinder || nmea != head.rangefinder_port.path,
                {"nmea.serial_path", "rangefinder_port.path"}, "is the same as");
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
  rules.require(
      levelling.source != InclinationSource::Can || levelling.max_age_s * head.cia410.poll_hz >= 2.0,
      {"inclination.max_age_s", "inclination.can_poll_hz"}, "is shorter than two measurements at");
  rules.require(levelling.source != InclinationSource::Iio || levelling.max_age_s >= 2.0 * head.iio.mean_s,
                {"inclination.max_age_s", "inclination.iio_mean_s"}, "is shorter than two measurements of");
  for (const InclinationSource source : {InclinationSource::Can, InclinationSource::Iio}) {
    if (const auto opened = open_inclinometer(head, source); !opened) {
      rules.refuse_section("inclination", opened.error().message);
    }
  }
}

}  // namespace

void check_head(Rules& rules) {
  check_ports(rules);
  check_reopen(rules);
  check_pan_tilt(rules);
  check_rangefinder(rules);
  check_can_ids(rules);
  check_scan(rules);
  check_drivers(rules);
  check_inclination(rules);
}

}  // namespace slamsensor::firmware
