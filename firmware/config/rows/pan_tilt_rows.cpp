#include "firmware/config/rows/setting_path.hpp"
#include "firmware/config/rows/setting_rows.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;
using hal::CanopenAxisConfig;
using hal::CanopenConfig;
using hal::PtuConfig;

// Names of the enumerators, in their order.
constexpr std::string_view kResets[] = {"never", "if_unreferenced", "always"};
constexpr std::string_view kDelimiters[] = {"space", "carriage_return"};
constexpr std::string_view kPacings[] = {"line_rate", "at_once"};
constexpr std::string_view kSenses[] = {"normal", "reversed"};
constexpr std::string_view kRecoveries[] = {"never", "writes_eeprom"};
constexpr std::string_view kScales[] = {"configured", "from_drive"};
constexpr std::string_view kHomings[] = {"never", "if_not_homed", "always"};
constexpr std::string_view kFaultResets[] = {"never", "at_start"};
constexpr std::string_view kFeedbacks[] = {"automatic", "mapped_pdo", "default_pdo", "sdo"};
constexpr std::string_view kTimings[] = {"sync", "event"};
constexpr std::string_view kMotions[] = {"profile_position", "profile_velocity"};

constexpr auto kHead = &Config::head;
constexpr auto kPtu = &HeadConfig::ptu;
constexpr auto kCanopen = &HeadConfig::canopen;
constexpr auto kPan = &CanopenConfig::pan;
constexpr auto kTilt = &CanopenConfig::tilt;

constexpr Section kSections[] = {
    {"ptu",
     "Pan-tilt unit of Directed Perception / FLIR. Its limits, resolution and speeds are asked of it."},
    {"canopen", "Pan-tilt unit of two CiA 402 drives on one CANopen bus."},
    {"canopen_pan", "Its pan drive."},
    {"canopen_tilt", "Its tilt drive."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"ptu.rates_baud", "baud", "Line rates at which the unit is looked for, in this order.",
     integers<kHead, kPtu, &PtuConfig::rates_baud>(300, 921'600, {1, 8})},
    {"ptu.fast_baud", "baud", "Line rate changed to after start-up, not saved in the unit; 0: stay.",
     integer<kHead, kPtu, &PtuConfig::fast_baud>(0, 921'600)},
    {"ptu.reset", "", "When a start-up drives both axes into their stops to find the zero.",
     choice<kHead, kPtu, &PtuConfig::reset>(kResets)},
    {"ptu.delimiter", "", "What ends a command.",
     choice<kHead, kPtu, &PtuConfig::delimiter>(kDelimiters)},
    {"ptu.pacing", "", "Whether bytes take their time on the line; at_once for USB and network bridges.",
     choice<kHead, kPtu, &PtuConfig::pacing>(kPacings)},
    {"ptu.pan_sense", "", "normal: pan counts up to the left.",
     choice<kHead, kPtu, &PtuConfig::pan_sense>(kSenses)},
    {"ptu.tilt_sense", "", "normal: tilt counts up upwards.",
     choice<kHead, kPtu, &PtuConfig::tilt_sense>(kSenses)},
    {"ptu.network_recovery", "", "Whether a silent unit's network identity is taken away; its EEPROM wears.",
     choice<kHead, kPtu, &PtuConfig::network_recovery>(kRecoveries)},
    {"ptu.poll_hz", "Hz", "Positions asked for of a moving axis; the line may allow less.",
     real<kHead, kPtu, &PtuConfig::poll_hz>(1.0, 200.0)},
    {"ptu.rest_poll_hz", "Hz", "The same of a resting axis.",
     real<kHead, kPtu, &PtuConfig::rest_poll_hz>(0.1, 200.0)},
    {"ptu.query_timeout_s", "s", "Patience for the answer to a query, beside its time on the line.",
     duration<kHead, kPtu, &PtuConfig::query_timeout>(0.001, 600.0)},
    {"ptu.motion_timeout_s", "s", "The same for a move.",
     duration<kHead, kPtu, &PtuConfig::motion_timeout>(0.001, 600.0)},
    {"ptu.mode_timeout_s", "s", "The same for a change of mode.",
     duration<kHead, kPtu, &PtuConfig::mode_timeout>(0.001, 600.0)},
    {"ptu.reset_timeout_s", "s", "The same for a reset; also how long a unit found resetting is waited for.",
     duration<kHead, kPtu, &PtuConfig::reset_timeout>(0.001, 600.0)},
    {"ptu.wake_wait_s", "s", "Pause after the characters that end a monitor scan.",
     duration<kHead, kPtu, &PtuConfig::wake_wait>(0.001, 600.0)},
    {"ptu.drain_s", "s", "Silence that ends what an error left on the line.",
     duration<kHead, kPtu, &PtuConfig::drain>(0.001, 600.0)},
    {"ptu.baud_wait_s", "s", "From a change of the line rate to the first byte at it.",
     duration<kHead, kPtu, &PtuConfig::baud_wait>(0.001, 600.0)},
    {"ptu.retry_wait_s", "s", "Rest before a faulted unit is started up again.",
     duration<kHead, kPtu, &PtuConfig::retry_wait>(0.001, 600.0)},
    {"ptu.move_latency_max_s", "s", "From a command to its motion; a move that begins later is disbelieved.",
     duration<kHead, kPtu, &PtuConfig::move_latency_max>(0.0, 600.0)},
    {"ptu.stamp_slack_s", "s", "What an axis may be off its motion profile in time: as much as a tick of the unit.",
     duration<kHead, kPtu, &PtuConfig::stamp_slack>(0.0, 600.0)},
    {"ptu.half_width_max_s", "s", "Positions of a moving axis that are less sure in time are not used.",
     duration<kHead, kPtu, &PtuConfig::half_width_max>(1e-6, 600.0)},

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
    {"canopen.poll_hz", "Hz", "SYNCs, and positions of a moving axis.",
     real<kHead, kCanopen, &CanopenConfig::poll_hz>(1.0, 1000.0)},
    {"canopen.rest_poll_hz", "Hz", "Positions of a resting axis.",
     real<kHead, kCanopen, &CanopenConfig::rest_poll_hz>(0.1, 1000.0)},
    {"canopen.heartbeat_s", "s", "Heartbeat asked of the drives.",
     duration<kHead, kCanopen, &CanopenConfig::heartbeat>(0.01, 30.0)},
    {"canopen.heartbeat_timeout_s", "s", "Silence after which a drive is lost; longer than heartbeat_s.",
     duration<kHead, kCanopen, &CanopenConfig::heartbeat_timeout>(0.01, 600.0)},
    {"canopen.sdo_timeout_s", "s", "Patience for the answer to an SDO.",
     duration<kHead, kCanopen, &CanopenConfig::sdo_timeout>(0.001, 600.0)},
    {"canopen.sdo_attempts", "", "Times that an SDO is sent.",
     integer<kHead, kCanopen, &CanopenConfig::sdo_attempts>(1, 10)},
    {"canopen.boot_wait_s", "s", "From boot-up or NMT command to the first SDO.",
     duration<kHead, kCanopen, &CanopenConfig::boot_wait>(0.001, 600.0)},
    {"canopen.state_timeout_s", "s", "Patience for one change of a drive's state.",
     duration<kHead, kCanopen, &CanopenConfig::state_timeout>(0.001, 600.0)},
    {"canopen.homing_timeout_s", "s", "Patience for homing.",
     duration<kHead, kCanopen, &CanopenConfig::homing_timeout>(0.001, 600.0)},
    {"canopen.acknowledge_timeout_s", "s", "Patience for the acknowledgement of a set-point.",
     duration<kHead, kCanopen, &CanopenConfig::acknowledge_timeout>(0.001, 600.0)},
    {"canopen.position_timeout_s", "s", "Silence of positions after which a drive is lost.",
     duration<kHead, kCanopen, &CanopenConfig::position_timeout>(0.001, 600.0)},
    {"canopen.retry_first_s", "s", "Wait before a start-up is tried again; doubled at each failure ...",
     duration<kHead, kCanopen, &CanopenConfig::retry_first>(0.001, 600.0)},
    {"canopen.retry_longest_s", "s", "... up to this.",
     duration<kHead, kCanopen, &CanopenConfig::retry_longest>(0.001, 600.0)},
    {"canopen.sync_half_width_s", "s", "How unsure the moment is at which a drive latches its position for a SYNC.",
     duration<kHead, kCanopen, &CanopenConfig::sync_half_width>(0.0, 600.0)},

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

SettingRows pan_tilt_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
