#include "firmware/config/rows/setting_path.hpp"
#include "firmware/config/rows/setting_rows.hpp"
#include "hal/rangefinder/lwnx_products.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;
using hal::BenewakeCanConfig;
using hal::BenewakeConfig;
using hal::BenewakeSerialConfig;
using hal::LwnxConfig;
using hal::RangeConfig;
using hal::SampleClockConfig;

// Names of the enumerators, in their order.
constexpr std::string_view kPolicies[] = {"keep", "change"};
constexpr std::string_view kModes[] = {"readings", "readings_mm", "raw_readings"};
constexpr std::string_view kModels[] = {"tf03", "tfmini", "tfmini_plus", "tfmini_s", "tf02"};
constexpr std::string_view kCommands[] = {"none", "as_serial"};

constexpr std::uint32_t kRateWidths[] = {0, 1, 2, 4};

constexpr auto kHead = &Config::head;
constexpr auto kLwnx = &HeadConfig::lwnx;
constexpr auto kSerial = &HeadConfig::benewake_serial;
constexpr auto kDevice = &BenewakeSerialConfig::device;
constexpr auto kCan = &HeadConfig::benewake_can;
constexpr auto kClock = &RangeConfig::clock;

constexpr Section kSections[] = {
    {"lwnx", "Rangefinder of LightWare that speaks LWNX. Line rate and product are found."},
    {"benewake", "Rangefinder of Benewake, on whichever line."},
    {"benewake_serial", "The same on a serial line."},
    {"benewake_can", "The same on a CAN bus."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"lwnx.baud", "baud", "Line rate that is tried first; the others of this list follow.",
     one_of<kHead, kLwnx, &LwnxConfig::baud>(hal::kLwnxBauds)},
    {"lwnx.baud_policy", "", "keep: the device stays at the rate at which it is found. change: baud is stored in it.",
     choice<kHead, kLwnx, &LwnxConfig::baud_policy>(kPolicies)},
    {"lwnx.mode", "", "A packet for each reading, in cm or mm, or 20,000 readings a second without strength.",
     choice<kHead, kLwnx, &LwnxConfig::mode>(kModes)},
    {"lwnx.rate_hz", "Hz", "Readings per second; the nearest that the product has. Not for raw_readings.",
     real<kHead, kLwnx, &LwnxConfig::rate_hz>(0.1, 20'000.0)},
    {"lwnx.range_max_m", "m", "What is farther counts as no return.",
     real<kHead, kLwnx, &LwnxConfig::range, &RangeConfig::range_max_m>(0.1, 10'000.0)},
    {"lwnx.weak_below", "", "Strength, in the device's unit, below which a distance is not trusted.",
     real<kHead, kLwnx, &LwnxConfig::range, &RangeConfig::weak_below>(0.0, 1e9)},
    {"lwnx.saturated_from", "", "Strength from which a distance is not trusted; inf: as the product's table says.",
     real<kHead, kLwnx, &LwnxConfig::range, &RangeConfig::saturated_from>(1e-6, kInfinity)},
    {"lwnx.clock_timing", "", "Whether readings come at a constant rate, from which their times are then found.",
     choice<kHead, kLwnx, &LwnxConfig::range, kClock, &SampleClockConfig::timing>(kClockTimings)},
    {"lwnx.clock_tolerance_ppm", "ppm", "The device's rate is within this of its nominal one.",
     real<kHead, kLwnx, &LwnxConfig::range, kClock, &SampleClockConfig::tolerance_ppm>(0.0, 100'000.0)},
    {"lwnx.clock_lump_s", "s", "Bytes are handed over in lumps of at most this; what is later is a gap.",
     duration<kHead, kLwnx, &LwnxConfig::range, kClock, &SampleClockConfig::lump>(0.0, 1.0)},
    {"lwnx.clock_stop_s", "s", "A pause after which the device's phase is taken to be new.",
     duration<kHead, kLwnx, &LwnxConfig::range, kClock, &SampleClockConfig::stop>(0.001, 60.0)},
    {"lwnx.lost_signal_counter", "", "Misses until the device says \"lost\"; before that it repeats old distances.",
     integer<kHead, kLwnx, &LwnxConfig::lost_signal_counter>(1, 250)},
    {"lwnx.rate_width", "", "Bytes of the update rate's value; 0: as the product's table says.",
     one_of<kHead, kLwnx, &LwnxConfig::rate_width>(kRateWidths)},
    {"lwnx.reading_unit_m", "m", "Unit of a distance in command 44; 0: as the product's table says.",
     real<kHead, kLwnx, &LwnxConfig::reading_unit_m>(0.0, 1.0)},
    {"lwnx.reply_patience_s", "s", "Patience for the answer to a command.",
     duration<kHead, kLwnx, &LwnxConfig::reply_patience>(0.01, 10.0)},

    {"benewake.model", "", "Product.",
     choice<kHead, kSerial, kDevice, &BenewakeConfig::model>(kModels)},
    {"benewake.rate_hz", "Hz", "Readings per second: n, 10 n, 100 n or 1000 n with n from 1 to 9, or 10000.",
     real<kHead, kSerial, kDevice, &BenewakeConfig::rate_hz>(1.0, 10'000.0)},
    {"benewake.range_max_m", "m", "What is farther counts as no return.",
     real<kHead, kSerial, kDevice, &BenewakeConfig::range, &RangeConfig::range_max_m>(0.1, 10'000.0)},
    {"benewake.weak_below", "", "Strength, in the device's unit, below which a distance is not trusted. 0: as its manual says.",
     real<kHead, kSerial, kDevice, &BenewakeConfig::range, &RangeConfig::weak_below>(0.0, 1e9)},
    {"benewake.saturated_from", "", "Strength from which a distance is not trusted; inf: none.",
     real<kHead, kSerial, kDevice, &BenewakeConfig::range, &RangeConfig::saturated_from>(1e-6, kInfinity)},
    {"benewake.clock_timing", "", "Whether readings come at a constant rate, from which their times are then found.",
     choice<kHead, kSerial, kDevice, &BenewakeConfig::range, kClock, &SampleClockConfig::timing>(kClockTimings)},
    {"benewake.clock_tolerance_ppm", "ppm", "The device's rate is within this of its nominal one.",
     real<kHead, kSerial, kDevice, &BenewakeConfig::range, kClock, &SampleClockConfig::tolerance_ppm>(0.0, 100'000.0)},
    {"benewake.clock_lump_s", "s", "Bytes are handed over in lumps of at most this; what is later is a gap.",
     duration<kHead, kSerial, kDevice, &BenewakeConfig::range, kClock, &SampleClockConfig::lump>(0.0, 1.0)},
    {"benewake.clock_stop_s", "s", "A pause after which the device's phase is taken to be new.",
     duration<kHead, kSerial, kDevice, &BenewakeConfig::range, kClock, &SampleClockConfig::stop>(0.001, 60.0)},
    {"benewake.over_range_cm", "cm", "What the device says for \"nothing\"; also set in a TF03.",
     integer<kHead, kSerial, kDevice, &BenewakeConfig::over_range_cm>(0, 65'535)},
    {"benewake.reply_patience_s", "s", "Patience for the answer to a command.",
     duration<kHead, kSerial, kDevice, &BenewakeConfig::reply_patience>(0.01, 10.0)},

    {"benewake_serial.baud", "baud", "Line rate that is tried first.",
     integer<kHead, kSerial, &BenewakeSerialConfig::baud>(9600, 4'000'000)},
    {"benewake_serial.baud_policy", "", "change: a device found at another rate is set to baud until its power goes.",
     choice<kHead, kSerial, &BenewakeSerialConfig::policy>(kPolicies)},

    {"benewake_can.device_id", "", "Identifier of the frames with readings.",
     hexadecimal<kHead, kCan, &BenewakeCanConfig::device_id>(0, 0x1FFF'FFFF)},
    {"benewake_can.device_id_is_extended", "", "Whether that identifier has 29 bits instead of 11.",
     boolean<kHead, kCan, &BenewakeCanConfig::device_id_is_extended>()},
    {"benewake_can.host_id", "", "Identifier of the frames with commands.",
     hexadecimal<kHead, kCan, &BenewakeCanConfig::host_id>(0, 0x1FFF'FFFF)},
    {"benewake_can.host_id_is_extended", "", "Whether that identifier has 29 bits instead of 11.",
     boolean<kHead, kCan, &BenewakeCanConfig::host_id_is_extended>()},
    {"benewake_can.bitrate", "bit/s", "Bit rate of the bus, for the times of readings; it is set in the system's network.",
     integer<kHead, kCan, &BenewakeCanConfig::bitrate>(10'000, 1'000'000)},
    {"benewake_can.commands", "", "none: the device takes no commands on CAN and must already send at rate_hz.",
     choice<kHead, kCan, &BenewakeCanConfig::commands>(kCommands)},
};
// clang-format on

}  // namespace

SettingRows rangefinder_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
