#include "firmware/config/rows/setting_rows.hpp"
#include "firmware/config/rows/text_rules.hpp"
#include "hal/rangefinder/lwnx_products.hpp"
#include "hal/rangefinder/point_record.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;
using core::Attitude;
using hal::BenewakeCanConfig;
using hal::BenewakeConfig;
using hal::BenewakeSerialConfig;
using hal::Cia410Config;
using hal::IioConfig;
using hal::LwnxConfig;
using hal::PointLaserConfig;
using hal::RangeConfig;
using hal::SampleClockConfig;

// Lists of names are those of the enumerators, in their order.

constexpr std::string_view kPolicies[] = {"keep", "change"};
constexpr std::string_view kModes[] = {"readings", "readings_mm", "raw_readings"};
constexpr std::string_view kModels[] = {"tf03", "tfmini", "tfmini_plus", "tfmini_s", "tf02"};
constexpr std::string_view kCommands[] = {"none", "as_serial"};
constexpr auto kHead = &Config::head;
constexpr auto kLwnx = &HeadConfig::lwnx;
constexpr auto kSerial = &HeadConfig::benewake_serial;
constexpr auto kDevice = &BenewakeSerialConfig::device;
constexpr auto kCan = &HeadConfig::benewake_can;
constexpr auto kClock = &RangeConfig::clock;

constexpr std::string_view kPresets[] = {"astech_lds70a", "mdl_laserace_im_hr", "custom"};
constexpr std::string_view kSearches[] = {"this_baud", "usual_bauds"};
constexpr std::string_view kRecords[] = {"ascii_decimal", "ascii_hex", "packed7"};
constexpr auto kLaser = &HeadConfig::point_laser;
using Texts = std::vector<std::string>;
constexpr Access<Texts> kCodes = {
    [](Config& config, const Texts& codes) { config.head.point_laser.codes = point_codes(codes); },
    [](const Config& config) { return std::optional(texts_of(config.head.point_laser.codes)); }};
constexpr Access<Texts> kTexts = {
    [](Config& config, const Texts& texts) { config.head.point_laser.texts = point_texts(texts); },
    [](const Config& config) { return std::optional(texts_of(config.head.point_laser.texts)); }};
constexpr Access<std::string> kStrengthSeparator = {
    [](Config& config, const std::string& text) {
      config.head.point_laser.strength_separator = text.empty() ? '\0' : text.front();
    },
    [](const Config& config) {
      const char separator = config.head.point_laser.strength_separator;
      return std::optional(separator == '\0' ? std::string() : std::string(1, separator));
    }};

constexpr std::string_view kSources[] = {"none", "fixed", "can", "iio"};
constexpr std::string_view kLongSlopes[] = {"front_down", "front_up"};
constexpr std::string_view kLateralSlopes[] = {"left_up", "left_down"};
constexpr auto kScanHead = &Config::scan_head;
constexpr auto kLevelling = &SensorHeadConfig::levelling;
constexpr auto kCia410 = &HeadConfig::cia410;
constexpr auto kIio = &HeadConfig::iio;

constexpr Section kSections[] = {
    {"lwnx", "Rangefinder of LightWare that speaks LWNX. Line rate and product are found."},
    {"benewake", "Rangefinder of Benewake, on whichever line."},
    {"benewake_serial", "The same on a serial line."},
    {"benewake_can", "The same on a CAN bus."},
    {"point_laser", "Any other rangefinder on a serial line that sends its readings by itself."},
    {"inclination",
     "How the sensor leans, and what measures it. Roll is positive when the left side is up, pitch when the "
     "front is down."},
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

    {"point_laser.preset", "", "Product whose values stand where a key of this section is not written.",
     choice<kHead, &HeadConfig::point_laser_preset>(kPresets)},
    {"point_laser.rate_hz", "Hz", "Readings per second that the device sends.",
     real<kHead, kLaser, &PointLaserConfig::rate_hz>(0.1, 50'000.0)},
    {"point_laser.baud", "baud", "Line rate.",
     integer<kHead, kLaser, &PointLaserConfig::baud>(300, 4'000'000)},
    {"point_laser.search", "", "usual_bauds: the device is also looked for at the other usual rates.",
     choice<kHead, kLaser, &PointLaserConfig::search>(kSearches)},
    {"point_laser.range_max_m", "m", "What is farther counts as no return.",
     real<kHead, kLaser, &PointLaserConfig::range, &RangeConfig::range_max_m>(0.1, 10'000.0)},
    {"point_laser.weak_below", "", "Strength, in the device's unit, below which a distance is not trusted.",
     real<kHead, kLaser, &PointLaserConfig::range, &RangeConfig::weak_below>(0.0, 1e9)},
    {"point_laser.saturated_from", "", "Strength from which a distance is not trusted; inf: none.",
     real<kHead, kLaser, &PointLaserConfig::range, &RangeConfig::saturated_from>(1e-6, kInfinity)},
    {"point_laser.clock_timing", "", "Whether readings come at a constant rate, from which their times are then found.",
     choice<kHead, kLaser, &PointLaserConfig::range, kClock, &SampleClockConfig::timing>(kClockTimings)},
    {"point_laser.record", "", "How a reading is written: decimal or hexadecimal text, or 7 bits a byte.",
     choice<kHead, kLaser, &PointLaserConfig::record>(kRecords)},
    {"point_laser.unit_m", "m", "Distance = number * unit_m + offset_m.",
     real<kHead, kLaser, &PointLaserConfig::unit_m>(1e-9, 1000.0)},
    {"point_laser.offset_m", "m", "See unit_m.",
     real<kHead, kLaser, &PointLaserConfig::offset_m>(-1000.0, 1000.0)},
    {"point_laser.codes", "", "Numbers, as their digits without the point, that are no distance, and what they mean.",
     TextListSetting{kCodes, &kPointCode, {0, hal::kPointCodesMax}}},
    {"point_laser.texts", "", "Texts that come instead of a reading, and what they mean.",
     TextListSetting{kTexts, &kPointText, {0, hal::kPointCodesMax}}},
    {"point_laser.terminator", "", "What ends a text record.",
     free_text<kHead, kLaser, &PointLaserConfig::terminator>(kTerminator)},
    {"point_laser.prefix", "", "What begins a text record.",
     free_text<kHead, kLaser, &PointLaserConfig::prefix>(kRecordPrefix)},
    {"point_laser.width", "", "Characters of a text record without its terminator; 0: any, then a lost digit may go unseen.",
     integer<kHead, kLaser, &PointLaserConfig::width>(0, 48)},
    {"point_laser.decimals", "", "Digits after the point; -1: any.",
     integer<kHead, kLaser, &PointLaserConfig::decimals>(-1, 9)},
    {"point_laser.strength_separator", "", "What stands between distance and strength; empty: there is no strength.",
     FreeTextSetting{kStrengthSeparator, &kSeparator}},
    {"point_laser.packed_bytes", "", "Bytes of a packed7 record.",
     integer<kHead, kLaser, &PointLaserConfig::packed_bytes>(2, 3)},
    {"point_laser.stop", "", "Command that stops the device, with its end of line; empty: none.",
     free_text<kHead, kLaser, &PointLaserConfig::stop>(kCommand)},
    {"point_laser.set_up", "", "Commands sent between stop and start.",
     texts<kHead, kLaser, &PointLaserConfig::set_up>(kCommand, {0, hal::kPointCommandsMax})},
    {"point_laser.start", "", "Command that starts the readings; empty: none.",
     free_text<kHead, kLaser, &PointLaserConfig::start>(kCommand)},
    {"point_laser.settle_s", "s", "Pause after each command.",
     duration<kHead, kLaser, &PointLaserConfig::settle>(0.0, 10.0)},

    {"inclination.source", "", "none: it stands upright; fixed: roll_deg and pitch_deg; can: CiA 410 inclinometer; iio: accelerometer.",
     choice<kScanHead, kLevelling, &LevellingConfig::source>(kSources)},
    {"inclination.roll_deg", "deg", "Roll of the sensor, for source = \"fixed\".",
     degrees<kScanHead, kLevelling, &LevellingConfig::fixed, &Attitude::roll_rad>(-45.0, 45.0)},
    {"inclination.pitch_deg", "deg", "Pitch of the sensor, for source = \"fixed\".",
     degrees<kScanHead, kLevelling, &LevellingConfig::fixed, &Attitude::pitch_rad>(-45.0, 45.0)},
    {"inclination.offset_roll_deg", "deg", "Roll that the device reports while the sensor stands upright.",
     degrees<kScanHead, kLevelling, &LevellingConfig::offset, &Attitude::roll_rad>(-180.0, 180.0)},
    {"inclination.offset_pitch_deg", "deg", "Pitch that the device reports while the sensor stands upright.",
     degrees<kScanHead, kLevelling, &LevellingConfig::offset, &Attitude::pitch_rad>(-90.0, 90.0)},
    {"inclination.max_lean_deg", "deg", "A sensor that leans by more does not scan.",
     degrees<kScanHead, kLevelling, &LevellingConfig::max_lean_rad>(1.0, 45.0)},
    {"inclination.can_interface", "", "CAN interface of the inclinometer; its bit rate is the system's.",
     free_text<kHead, kCia410, &Cia410Config::interface>(kInterface)},
    {"inclination.can_node", "", "Its node number.",
     integer<kHead, kCia410, &Cia410Config::node>(1, 127)},
    {"inclination.can_long_slope", "", "What its longitudinal slope means when it is positive.",
     choice<kHead, kCia410, &Cia410Config::long_slope>(kLongSlopes)},
    {"inclination.can_lateral_slope", "", "What its lateral slope means when it is positive.",
     choice<kHead, kCia410, &Cia410Config::lateral_slope>(kLateralSlopes)},
    {"inclination.iio_device", "", "Accelerometer: its name or label (\"adxl345\"), \"iio:device0\", or its folder.",
     free_text<kHead, kIio, &IioConfig::device>(kIioDevice)},
};
// clang-format on

}  // namespace

SettingRows rangefinder_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
