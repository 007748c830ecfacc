#include "firmware/config/rows/setting_path.hpp"
#include "firmware/config/rows/setting_rows.hpp"
#include "firmware/config/rows/text_rules.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;
using hal::ReopenConfig;
using hal::Rs485Config;
using hal::SerialConfig;
using hal::SerialFormat;
using hal::SerialLine;

// Names of the enumerators, in their order.
constexpr std::string_view kPanTilts[] = {"ptu", "canopen"};
constexpr std::string_view kRangefinders[] = {"lwnx", "benewake_serial", "benewake_can", "point_laser"};
constexpr std::string_view kParities[] = {"none", "even", "odd"};
constexpr std::string_view kLatencies[] = {"as_is", "low"};
constexpr std::string_view kLevels[] = {"low", "high"};
constexpr std::string_view kEchoes[] = {"off", "on"};

constexpr auto kHead = &Config::head;
constexpr auto kPanPort = &HeadConfig::pan_tilt_port;
constexpr auto kRangePort = &HeadConfig::rangefinder_port;
constexpr auto kLine = &SerialConfig::line;
constexpr auto kFormat = &SerialLine::format;
constexpr auto kReopen = &SerialConfig::reopen;
constexpr auto kRs485 = &SerialConfig::rs485;

constexpr Section kSections[] = {
    {"head", "The devices of the sensor head. Of the sections below, those of the chosen devices count."},
    {"pan_tilt_port", "Serial port of the pan-tilt unit, for pan_tilt = \"ptu\". The line rate: [ptu]."},
    {"pan_tilt_rs485", "RS-485 on that port.",
     [](Config& config) { config.head.pan_tilt_port.rs485.reset(); }},
    {"rangefinder_port",
     "Serial port of the rangefinder, but for \"benewake_can\". The line rate: the device's own section."},
    {"rangefinder_rs485", "RS-485 on that port.",
     [](Config& config) { config.head.rangefinder_port.rs485.reset(); }},
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
    {"pan_tilt_port.data_bits", "", "Data bits of a character.",
     integer<kHead, kPanPort, kLine, kFormat, &SerialFormat::data_bits>(7, 8)},
    {"pan_tilt_port.parity", "", "Parity of a character.",
     choice<kHead, kPanPort, kLine, kFormat, &SerialFormat::parity>(kParities)},
    {"pan_tilt_port.stop_bits", "", "Stop bits of a character.",
     integer<kHead, kPanPort, kLine, kFormat, &SerialFormat::stop_bits>(1, 2)},
    {"pan_tilt_port.latency", "", "Whether the driver is asked to hand over bytes at once.",
     choice<kHead, kPanPort, &SerialConfig::latency>(kLatencies)},
    {"pan_tilt_port.reopen_first_s", "s", "Wait before a lost port is opened again; doubled at each failure ...",
     duration<kHead, kPanPort, kReopen, &ReopenConfig::first>(0.001, 60.0)},
    {"pan_tilt_port.reopen_longest_s", "s", "... up to this.",
     duration<kHead, kPanPort, kReopen, &ReopenConfig::longest>(0.001, 60.0)},

    {"pan_tilt_rs485.rts_while_sending", "", "Level of RTS while bytes are sent.",
     choice<kHead, kPanPort, kRs485, &Rs485Config::rts_while_sending>(kLevels)},
    {"pan_tilt_rs485.rts_after_sending", "", "Level of RTS at all other times.",
     choice<kHead, kPanPort, kRs485, &Rs485Config::rts_after_sending>(kLevels)},
    {"pan_tilt_rs485.delay_before_send_ms", "ms", "From RTS to the first byte.",
     integer<kHead, kPanPort, kRs485, &Rs485Config::delay_before_send_ms>(0, 1000)},
    {"pan_tilt_rs485.delay_after_send_ms", "ms", "From the last byte to RTS.",
     integer<kHead, kPanPort, kRs485, &Rs485Config::delay_after_send_ms>(0, 1000)},
    {"pan_tilt_rs485.receive_own", "", "Whether what is sent is also received.",
     choice<kHead, kPanPort, kRs485, &Rs485Config::receive_own>(kEchoes)},

    {"rangefinder_port.path", "", "Terminal device; a stable name.",
     free_text<kHead, kRangePort, &SerialConfig::path>(kDevicePath)},
    {"rangefinder_port.data_bits", "", "Data bits of a character.",
     integer<kHead, kRangePort, kLine, kFormat, &SerialFormat::data_bits>(7, 8)},
    {"rangefinder_port.parity", "", "Parity of a character.",
     choice<kHead, kRangePort, kLine, kFormat, &SerialFormat::parity>(kParities)},
    {"rangefinder_port.stop_bits", "", "Stop bits of a character.",
     integer<kHead, kRangePort, kLine, kFormat, &SerialFormat::stop_bits>(1, 2)},
    {"rangefinder_port.latency", "", "Whether the driver is asked to hand over bytes at once.",
     choice<kHead, kRangePort, &SerialConfig::latency>(kLatencies)},
    {"rangefinder_port.reopen_first_s", "s", "Wait before a lost port is opened again; doubled at each failure ...",
     duration<kHead, kRangePort, kReopen, &ReopenConfig::first>(0.001, 60.0)},
    {"rangefinder_port.reopen_longest_s", "s", "... up to this.",
     duration<kHead, kRangePort, kReopen, &ReopenConfig::longest>(0.001, 60.0)},

    {"rangefinder_rs485.rts_while_sending", "", "Level of RTS while bytes are sent.",
     choice<kHead, kRangePort, kRs485, &Rs485Config::rts_while_sending>(kLevels)},
    {"rangefinder_rs485.rts_after_sending", "", "Level of RTS at all other times.",
     choice<kHead, kRangePort, kRs485, &Rs485Config::rts_after_sending>(kLevels)},
    {"rangefinder_rs485.delay_before_send_ms", "ms", "From RTS to the first byte.",
     integer<kHead, kRangePort, kRs485, &Rs485Config::delay_before_send_ms>(0, 1000)},
    {"rangefinder_rs485.delay_after_send_ms", "ms", "From the last byte to RTS.",
     integer<kHead, kRangePort, kRs485, &Rs485Config::delay_after_send_ms>(0, 1000)},
    {"rangefinder_rs485.receive_own", "", "Whether what is sent is also received.",
     choice<kHead, kRangePort, kRs485, &Rs485Config::receive_own>(kEchoes)},
};
// clang-format on

}  // namespace

SettingRows head_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
