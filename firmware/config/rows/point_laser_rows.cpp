#include "firmware/config/rows/point_lists.hpp"
#include "firmware/config/rows/setting_path.hpp"
#include "firmware/config/rows/setting_rows.hpp"
#include "firmware/config/rows/text_rules.hpp"
#include "hal/rangefinder/point_record.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;
using hal::PointLaserConfig;
using hal::RangeConfig;
using hal::SampleClockConfig;

// Names of the enumerators, in their order.
constexpr std::string_view kPresets[] = {"astech_lds70a", "mdl_laserace_im_hr", "custom"};
constexpr std::string_view kLayouts[] = {"from_manual", "unverified"};
constexpr std::string_view kSearches[] = {"this_baud", "usual_bauds"};
constexpr std::string_view kRecords[] = {"ascii_decimal", "ascii_hex", "packed7", "pair"};
constexpr std::string_view kPrefixes[] = {"required", "optional"};
constexpr std::string_view kOrders[] = {"big_endian", "little_endian"};

constexpr auto kHead = &Config::head;
constexpr auto kLaser = &HeadConfig::point_laser;
constexpr auto kClock = &RangeConfig::clock;

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

constexpr Section kSections[] = {
    {"point_laser", "Any other rangefinder on a serial line that sends its readings by itself."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"point_laser.preset", "", "Product whose values stand where a key of this section is not written.",
     choice<kHead, &HeadConfig::point_laser_preset>(kPresets)},
    {"point_laser.product", "", "Name in messages and in the status.",
     free_text<kHead, kLaser, &PointLaserConfig::product>(kProductName)},
    {"point_laser.layout", "", "unverified: the status says that the layout below was not found in a manual.",
     choice<kHead, kLaser, &PointLaserConfig::layout>(kLayouts)},
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
    {"point_laser.clock_tolerance_ppm", "ppm", "The device's rate is within this of its nominal one.",
     real<kHead, kLaser, &PointLaserConfig::range, kClock, &SampleClockConfig::tolerance_ppm>(0.0, 100'000.0)},
    {"point_laser.clock_lump_s", "s", "Bytes are handed over in lumps of at most this; what is later is a gap.",
     duration<kHead, kLaser, &PointLaserConfig::range, kClock, &SampleClockConfig::lump>(0.0, 1.0)},
    {"point_laser.clock_stop_s", "s", "A pause after which the device's phase is taken to be new.",
     duration<kHead, kLaser, &PointLaserConfig::range, kClock, &SampleClockConfig::stop>(0.001, 60.0)},
    {"point_laser.resolution_m", "m", "Smallest step of a distance.",
     real<kHead, kLaser, &PointLaserConfig::resolution_m>(0.0, 100.0)},
    {"point_laser.record", "", "How a reading is written: decimal or hexadecimal text, 7 bits a byte, or two bytes without a frame.",
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
    {"point_laser.prefix_is", "", "Whether every record has the prefix.",
     choice<kHead, kLaser, &PointLaserConfig::prefix_is>(kPrefixes)},
    {"point_laser.width", "", "Characters of a text record without its terminator; 0: any, then a lost digit may go unseen.",
     integer<kHead, kLaser, &PointLaserConfig::width>(0, 48)},
    {"point_laser.decimals", "", "Digits after the point; -1: any.",
     integer<kHead, kLaser, &PointLaserConfig::decimals>(-1, 9)},
    {"point_laser.strength_separator", "", "What stands between distance and strength; empty: there is no strength.",
     FreeTextSetting{kStrengthSeparator, &kSeparator}},
    {"point_laser.packed_bytes", "", "Bytes of a packed7 record.",
     integer<kHead, kLaser, &PointLaserConfig::packed_bytes>(2, 3)},
    {"point_laser.byte_order", "", "Of a pair.",
     choice<kHead, kLaser, &PointLaserConfig::order>(kOrders)},
    {"point_laser.stop", "", "Command that stops the device, with its end of line; empty: none.",
     free_text<kHead, kLaser, &PointLaserConfig::stop>(kCommand)},
    {"point_laser.set_up", "", "Commands sent between stop and start.",
     texts<kHead, kLaser, &PointLaserConfig::set_up>(kCommand, {0, hal::kPointCommandsMax})},
    {"point_laser.start", "", "Command that starts the readings; empty: none.",
     free_text<kHead, kLaser, &PointLaserConfig::start>(kCommand)},
    {"point_laser.settle_s", "s", "Pause after each command.",
     duration<kHead, kLaser, &PointLaserConfig::settle>(0.0, 10.0)},
};
// clang-format on

}  // namespace

SettingRows point_laser_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
