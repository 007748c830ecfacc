#include "firmware/config/rows/setting_rows.hpp"
#include "firmware/config/rows/text_rules.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;
using hal::CanopenAxisConfig;
using hal::CanopenConfig;
using hal::PtuConfig;
using hal::Rs485Config;
using hal::SerialConfig;
using hal::SerialFormat;
using hal::SerialLine;

// Lists of names are those of the enumerators, in their order.

constexpr std::string_view kPanTilts[] = {"ptu", "canopen"};
constexpr std::string_view kRangefinders[] = {"lwnx", "benewake_serial", "benewake_can", "point_laser"};
constexpr std::string_view kParities[] = {"none", "even", "odd"};
constexpr std::string_view kLevels[] = {"low", "high"};
constexpr auto kHead = &Config::head;
constexpr auto kPanPort = &HeadConfig::pan_tilt_port;
constexpr auto kRangePort = &HeadConfig::rangefinder_port;
constexpr auto kLine = &SerialConfig::line;
constexpr auto kFormat = &SerialLine::format;
constexpr auto kRs485 = &SerialConfig::rs485;

constexpr std::string_view kResets[] = {"never", "if_unreferenced", "always"};
constexpr std::string_view kPacings[] = {"line_rate", "at_once"};
constexpr std::string_view kSenses[] = {"normal", "reversed"};
constexpr std::string_view kRecoveries[] = {"never", "writes_eeprom"};
constexpr std::string_view kScales[] = {"configured", "from_drive"};
constexpr std::string_view kHomings[] = {"never", "if_not_homed", "always"};
constexpr std::string_view kFaultResets[] = {"never", "at_start"};
constexpr std::string_view kFeedbacks[] = {"automatic", "mapped_pdo", "default_pdo", "sdo"};
constexpr std::string_view kTimings[] = {"sync", "event"};
constexpr std::string_view kMotions[] = {"profile_position", "profile_velocity"};
constexpr auto kPtu = &HeadConfig::ptu;
constexpr auto kCanopen = &HeadConfig::canopen;
constexpr auto kPan = &CanopenConfig::pan;
constexpr auto kTilt = &CanopenConfig::tilt;

constexpr Section kSections[] = {
    {"head", "The devices of the sensor head. Of the sections below, those of the chosen devices count."},
    {"pan_tilt_port", "Serial port of the pan-tilt unit, for pan_tilt = \"ptu\". The line rate: [ptu]."},
    {"pan_tilt_rs485", "RS-485 on that port.",
     [](Config& config) { config.head.pan_tilt_port.rs485.reset(); }},
    {"rangefinder_port",
     "Serial port of the rangefinder, but for \"benewake_can\". The line rate: the device's own section."},
    {"rangefinder_rs485", "RS-485 on that port.",
     [](Config& config) { config.head.rangefinder_port.rs485.reset(); }},
    {"ptu",
     "Pan-tilt unit of Directed Perception / FLIR. Its limits, resolution and speeds are asked of it."},
    {"canopen", "Pan-tilt unit of two CiA 402 drives on one CANopen bus."},
    {"canopen_pan", "Its pan drive."},
    {"canopen_tilt", "Its tilt drive."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"head.pan_tilt", "", "Pan-tilt unit: Directed Perception / FLIR on a serial line, or CiA 402 drives on CAN.",
     choice<kHead, &HeadConfig::pan_tilt>(kPanTilts)},
    {"head.rangefinder", "", "LightWare (LWNX), Benewake on a serial line or on CAN, or another of [point_laser].",
     choice<kHead, &HeadConfig::rangefinder>(kRangefinders)},
    {"head.can_interface", "", "CAN interface of the devices that are on a bus; its bit rate is the system's.",
     free_text<kHead, &HeadConfig::can_interface>(kInterface)},

    {"pan_tilt_port.path", "", "Terminal device; a stable name.",
     free_text<kHead, kPanPort, &SerialConfig::path>(kDevicePath)},

    {"pan_tilt_rs485.rts_while_sending", "", "Level of RTS while bytes are sent.",
     choice<kHead, kPanPort, kRs485, &Rs485Config::rts_while_sending>(kLevels)},
    {"pan_tilt_rs485.rts_after_sending", "", "Level of RTS at all other times.",
     choice<kHead, kPanPort, kRs485, &Rs485Config::rts_after_sending>(kLevels)},
    {"pan_tilt_rs485.delay_before_send_ms", "ms", "From RTS to the first byte.",
     integer<kHead, kPanPort, kRs485, &Rs485Config::delay_before_send_ms>(0, 1000)},
    {"pan_tilt_rs485.delay_after_send_ms", "ms", "From the last byte to RTS.",
     integer<kHead, kPanPort, kRs485, &Rs485Config::delay_after_send_ms>(0, 1000)},

    {"rangefinder_port.path", "", "Terminal device; a stable name.",
     free_text<kHead, kRangePort, &SerialConfig::path>(kDevicePath)},
    {"rangefinder_port.data_bits", "", "Data bits of a character.",
     integer<kHead, kRangePort, kLine, kFormat, &SerialFormat::data_bits>(7, 8)},
    {"rangefinder_port.parity", "", "Parity of a character.",
     choice<kHead, kRangePort, kLine, kFormat, &SerialFormat::parity>(kParities)},
    {"rangefinder_port.stop_bits", "", "Stop bits of a character.",
     integer<kHead, kRangePort, kLine, kFormat, &SerialFormat::stop_bits>(1, 2)},

    {"rangefinder_rs485.rts_while_sending", "", "Level of RTS while bytes are sent.",
     choice<kHead, kRangePort, kRs485, &Rs485Config::rts_while_sending>(kLevels)},
    {"rangefinder_rs485.rts_after_sending", "", "Level of RTS at all other times.",
     choice<kHead, kRangePort, kRs485, &Rs485Config::rts_after_sending>(kLevels)},
    {"rangefinder_rs485.delay_before_send_ms", "ms", "From RTS to the first byte.",
     integer<kHead, kRangePort, kRs485, &Rs485Config::delay_before_send_ms>(0, 1000)},
    {"rangefinder_rs485.delay_after_send_ms", "ms", "From the last byte to RTS.",
     integer<kHead, kRangePort, kRs485, &Rs485Config::delay_after_send_ms>(0, 1000)},

    {"ptu.rates_baud", "baud", "Line rates at which the unit is looked for, in this order.",
     integers<kHead, kPtu, &PtuConfig::rates_baud>(300, 921'600, {1, 8})},
    {"ptu.fast_baud", "baud", "Line rate changed to after start-up, not saved in the unit; 0: stay.",
     integer<kHead, kPtu, &PtuConfig::fast_baud>(0, 921'600)},
    {"ptu.reset", "", "When a start-up drives both axes into their stops to find the zero.",
     choice<kHead, kPtu, &PtuConfig::reset>(kResets)},
    {"ptu.pacing", "", "Whether bytes take their time on the line; at_once for USB and network bridges.",
     choice<kHead, kPtu, &PtuConfig::pacing>(kPacings)},
    {"ptu.pan_sense", "", "normal: pan counts up to the left.",
     choice<kHead, kPtu, &PtuConfig::pan_sense>(kSenses)},
    {"ptu.tilt_sense", "", "normal: tilt counts up upwards.",
     choice<kHead, kPtu, &PtuConfig::tilt_sense>(kSenses)},
    {"ptu.network_recovery", "", "Whether a silent unit's network identity is taken away; its EEPROM wears.",
     choice<kHead, kPtu, &PtuConfig::network_recovery>(kRecoveries)},
    {"ptu.poll_hz", "Hz", "Positions asked for of a moving axis; the line may allow less. Of a resting axis: 2 Hz.",
     real<kHead, kPtu, &PtuConfig::poll_hz>(2.0, 200.0)},
    {"ptu.query_timeout_s", "s", "Patience for the answer to a query, beside its time on the line.",
     duration<kHead, kPtu, &PtuConfig::query_timeout>(0.001, 600.0)},
    {"ptu.motion_timeout_s", "s", "The same for a move.",
     duration<kHead, kPtu, &PtuConfig::motion_timeout>(0.001, 600.0)},

    {"canopen.homing", "", "When a start-up drives an axis to its reference; never: for absolute encoders.",
     choice<kHead, kCanopen, &CanopenConfig::homing>(kHomings)},
    {"canopen.fault_reset", "", "Whether a start-up resets a drive's fault.",
     choice<kHead, kCanopen, &CanopenConfig::fault_reset>(kFaultResets)},
    {"canopen.feedback", "", "How positions come; automatic: the first of the others that the drive can do.",
     choice<kHead, kCanopen, &CanopenConfig::feedback>(kFeedbacks)},
    {"canopen.pdo_timing", "", "When a drive sends its position: at each SYNC, or when it changes.",
     choice<kHead, kCanopen, &CanopenConfig::pdo_timing>(kTimings)},
    {"canopen.motion", "", "How a move is driven; profile_velocity needs mode 3 of the drives.",
     choice<kHead, kCanopen, &CanopenConfig::motion>(kMotions)},
    {"canopen.poll_hz", "Hz", "SYNCs, and positions of a moving axis. Of a resting axis: 2 Hz.",
     real<kHead, kCanopen, &CanopenConfig::poll_hz>(2.0, 1000.0)},
    {"canopen.homing_timeout_s", "s", "Patience for homing.",
     duration<kHead, kCanopen, &CanopenConfig::homing_timeout>(0.001, 600.0)},

    {"canopen_pan.node", "", "Node number of the drive.",
     integer<kHead, kCanopen, kPan, &CanopenAxisConfig::node>(1, 127)},
    {"canopen_pan.sense", "", "normal: pan counts up to the left, tilt upwards.",
     choice<kHead, kCanopen, kPan, &CanopenAxisConfig::sense>(kSenses)},
    {"canopen_pan.scale", "", "Whether counts_per_rad is as below or as the drive's objects 608F and 6091 say.",
     choice<kHead, kCanopen, kPan, &CanopenAxisConfig::scale>(kScales)},
    {"canopen_pan.counts_per_rad", "1/rad", "Positions of the drive in a radian of the axis.",
     real<kHead, kCanopen, kPan, &CanopenAxisConfig::counts_per_rad>(1.0, 1e9)},
    {"canopen_pan.speed_units_per_rad", "s/rad", "Unit of its speeds (6081, 60FF) in a radian a second; 0: counts per second.",
     real<kHead, kCanopen, kPan, &CanopenAxisConfig::speed_units_per_rad>(0.0, 1e9)},
    {"canopen_pan.acceleration_units_per_rad", "s2/rad", "The same of accelerations (6083, 6084); 0: counts per second squared.",
     real<kHead, kCanopen, kPan, &CanopenAxisConfig::acceleration_units_per_rad>(0.0, 1e9)},
    {"canopen_pan.min_deg", "deg", "Lowest angle allowed; the drive's own limits narrow it.",
     degrees<kHead, kCanopen, kPan, &CanopenAxisConfig::min_rad>(-360.0, 360.0)},
    {"canopen_pan.max_deg", "deg", "Highest angle allowed.",
     degrees<kHead, kCanopen, kPan, &CanopenAxisConfig::max_rad>(-360.0, 360.0)},
    {"canopen_pan.speed_max_deg_s", "deg/s", "Greatest speed allowed; the drive's own limit lowers it.",
     degrees<kHead, kCanopen, kPan, &CanopenAxisConfig::speed_max_radps>(0.001, 5000.0)},
    {"canopen_pan.acceleration_deg_s2", "deg/s2", "Acceleration set in the drive; 0: its own is kept.",
     degrees<kHead, kCanopen, kPan, &CanopenAxisConfig::acceleration_radps2>(0.0, 500'000.0)},
    {"canopen_pan.window_deg", "deg", "A move has ended within this of its target.",
     degrees<kHead, kCanopen, kPan, &CanopenAxisConfig::window_rad>(0.00001, 50.0)},
    {"canopen_pan.homing_method", "", "Object 6098, by the manufacturer's table; 0: refuse a drive that is not homed.",
     integer<kHead, kCanopen, kPan, &CanopenAxisConfig::homing_method>(-128, 127)},

    {"canopen_tilt.node", "", "Node number of the drive.",
     integer<kHead, kCanopen, kTilt, &CanopenAxisConfig::node>(1, 127)},
    {"canopen_tilt.sense", "", "normal: pan counts up to the left, tilt upwards.",
     choice<kHead, kCanopen, kTilt, &CanopenAxisConfig::sense>(kSenses)},
    {"canopen_tilt.scale", "", "Whether counts_per_rad is as below or as the drive's objects 608F and 6091 say.",
     choice<kHead, kCanopen, kTilt, &CanopenAxisConfig::scale>(kScales)},
    {"canopen_tilt.counts_per_rad", "1/rad", "Positions of the drive in a radian of the axis.",
     real<kHead, kCanopen, kTilt, &CanopenAxisConfig::counts_per_rad>(1.0, 1e9)},
    {"canopen_tilt.speed_units_per_rad", "s/rad", "Unit of its speeds (6081, 60FF) in a radian a second; 0: counts per second.",
     real<kHead, kCanopen, kTilt, &CanopenAxisConfig::speed_units_per_rad>(0.0, 1e9)},
    {"canopen_tilt.acceleration_units_per_rad", "s2/rad", "The same of accelerations (6083, 6084); 0: counts per second squared.",
     real<kHead, kCanopen, kTilt, &CanopenAxisConfig::acceleration_units_per_rad>(0.0, 1e9)},
    {"canopen_tilt.min_deg", "deg", "Lowest angle allowed; the drive's own limits narrow it.",
     degrees<kHead, kCanopen, kTilt, &CanopenAxisConfig::min_rad>(-360.0, 360.0)},
    {"canopen_tilt.max_deg", "deg", "Highest angle allowed.",
     degrees<kHead, kCanopen, kTilt, &CanopenAxisConfig::max_rad>(-360.0, 360.0)},
    {"canopen_tilt.speed_max_deg_s", "deg/s", "Greatest speed allowed; the drive's own limit lowers it.",
     degrees<kHead, kCanopen, kTilt, &CanopenAxisConfig::speed_max_radps>(0.001, 5000.0)},
    {"canopen_tilt.acceleration_deg_s2", "deg/s2", "Acceleration set in the drive; 0: its own is kept.",
     degrees<kHead, kCanopen, kTilt, &CanopenAxisConfig::acceleration_radps2>(0.0, 500'000.0)},
    {"canopen_tilt.window_deg", "deg", "A move has ended within this of its target.",
     degrees<kHead, kCanopen, kTilt, &CanopenAxisConfig::window_rad>(0.00001, 50.0)},
    {"canopen_tilt.homing_method", "", "Object 6098, by the manufacturer's table; 0: refuse a drive that is not homed.",
     integer<kHead, kCanopen, kTilt, &CanopenAxisConfig::homing_method>(-128, 127)},
};
// clang-format on

}  // namespace

SettingRows head_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
