#include "firmware/config/rows/setting_path.hpp"
#include "firmware/config/rows/setting_rows.hpp"
#include "firmware/config/rows/text_rules.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;
using core::Attitude;
using hal::Cia410Config;
using hal::IioConfig;

// Names of the enumerators, in their order.
constexpr std::string_view kSources[] = {"none", "fixed", "can", "iio"};
constexpr std::string_view kLongSlopes[] = {"front_down", "front_up"};
constexpr std::string_view kLateralSlopes[] = {"left_up", "left_down"};

constexpr auto kScanHead = &Config::scan_head;
constexpr auto kLevelling = &SensorHeadConfig::levelling;
constexpr auto kHead = &Config::head;
constexpr auto kCia410 = &HeadConfig::cia410;
constexpr auto kIio = &HeadConfig::iio;

constexpr Section kSections[] = {
    {"inclination",
     "How the sensor leans, and what tells it. Roll is positive when the left side is up, pitch when the "
     "front is down."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"inclination.source", "", "none: it stands upright; fixed: roll_deg and pitch_deg; can: CiA 410 inclinometer; iio: accelerometer.",
     choice<kScanHead, kLevelling, &LevellingConfig::source>(kSources)},
    {"inclination.roll_deg", "deg", "Roll of the sensor, for source = \"fixed\".",
     degrees<kScanHead, kLevelling, &LevellingConfig::fixed, &Attitude::roll_rad>(-45.0, 45.0)},
    {"inclination.pitch_deg", "deg", "Pitch of the sensor, for source = \"fixed\".",
     degrees<kScanHead, kLevelling, &LevellingConfig::fixed, &Attitude::pitch_rad>(-45.0, 45.0)},
    {"inclination.offset_roll_deg", "deg", "Roll that the device tells while the sensor stands upright.",
     degrees<kScanHead, kLevelling, &LevellingConfig::offset, &Attitude::roll_rad>(-180.0, 180.0)},
    {"inclination.offset_pitch_deg", "deg", "Pitch that the device tells while the sensor stands upright.",
     degrees<kScanHead, kLevelling, &LevellingConfig::offset, &Attitude::pitch_rad>(-90.0, 90.0)},
    {"inclination.max_age_s", "s", "Without a measurement for longer than this the sensor does not scan.",
     real<kScanHead, kLevelling, &LevellingConfig::max_age_s>(0.2, 60.0)},
    {"inclination.max_lean_deg", "deg", "A sensor that leans by more does not scan.",
     degrees<kScanHead, kLevelling, &LevellingConfig::max_lean_rad>(1.0, 45.0)},
    {"inclination.moved_deg", "deg", "Tilted by more than this during a scan, the carrier has moved.",
     degrees<kScanHead, kLevelling, &LevellingConfig::moved_rad>(0.05, 45.0)},
    {"inclination.can_interface", "", "CAN interface of the inclinometer; its bit rate is the system's.",
     free_text<kHead, kCia410, &Cia410Config::interface>(kInterface)},
    {"inclination.can_node", "", "Its node number.",
     integer<kHead, kCia410, &Cia410Config::node>(1, 127)},
    {"inclination.can_long_slope", "", "What its longitudinal slope means when it is positive.",
     choice<kHead, kCia410, &Cia410Config::long_slope>(kLongSlopes)},
    {"inclination.can_lateral_slope", "", "What its lateral slope means when it is positive.",
     choice<kHead, kCia410, &Cia410Config::lateral_slope>(kLateralSlopes)},
    {"inclination.can_poll_hz", "Hz", "Measurements asked for.",
     real<kHead, kCia410, &Cia410Config::poll_hz>(0.1, 50.0)},
    {"inclination.iio_device", "", "Accelerometer: its name or label (\"adxl345\"), \"iio:device0\", or its folder.",
     free_text<kHead, kIio, &IioConfig::device>(kIioDevice)},
    {"inclination.iio_gravity_share_max", "", "An acceleration off 9.81 m/s^2 by a larger share is not that of rest.",
     real<kHead, kIio, &IioConfig::gravity_share_max>(0.001, 0.5)},
    {"inclination.iio_poll_hz", "Hz", "Readings of it.",
     real<kHead, kIio, &IioConfig::poll_hz>(1.0, 200.0)},
    {"inclination.iio_mean_s", "s", "A measurement is the mean of readings for so long.",
     real<kHead, kIio, &IioConfig::mean_s>(0.0, 10.0)},
};
// clang-format on

}  // namespace

SettingRows inclination_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
