#include "firmware/config/rows/nmea_sentence_list.hpp"
#include "firmware/config/rows/setting_path.hpp"
#include "firmware/config/rows/setting_rows.hpp"
#include "firmware/config/rows/text_rules.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;

// Names of the enumerators, in their order.
constexpr std::string_view kQualities[] = {"autonomous", "rtk_fixed", "rtk_float"};
// Talkers that gpsd and the other readers of the stream recognise.
constexpr std::string_view kTalkers[] = {"GP", "GN", "IN", "GA", "II", "EC"};

constexpr auto kDaemon = &Config::daemon;
constexpr auto kSerial = &DaemonConfig::nmea_serial;
constexpr auto kTcp = &DaemonConfig::nmea_tcp;
constexpr auto kLcm = &DaemonConfig::lcm;

constexpr Access<std::vector<std::string>> kSentences = {
    [](Config& config, const std::vector<std::string>& names) { choose_sentences(names, config.nmea); },
    [](const Config& config) { return std::optional(chosen_sentences(config.nmea)); }};

constexpr Section kSections[] = {
    {"nmea", "NMEA 0183 output."},
    {"datum", "Ties the map frame to the earth. Without it no latitude or longitude is ever emitted.",
     [](Config& config) { config.datum.reset(); }},
    {"fix", "What becomes of a fix."},
    {"lcm", "LCM output. The sensor only transmits."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"nmea.talker", "", "First two letters of every sentence.",
     text<&Config::nmea, &NmeaConfig::talker>(kTalkers), Apply::Live},
    {"nmea.quality", "", "What a live fix calls itself: GGA quality and RMC mode 1 A, 4 R or 5 F.",
     choice<&Config::nmea, &NmeaConfig::quality>(kQualities), Apply::Live},
    {"nmea.sentences", "", "Sentences of an epoch; HDT only with a position, THS always, ZDA once a second.",
     TextListSetting{kSentences, &kSentence, {1, kNmeaSentenceNames.size()}}, Apply::Live},
    {"nmea.landmark_sigma_m", "m", "1 sigma of a landmark's place: the unit of HDOP, and the RMS of GST.",
     real<&Config::nmea, &NmeaConfig::landmark_sigma_m>(0.001, 100.0), Apply::Live},
    {"nmea.prompt", "", "The answer of a scan also at once, between two regular epochs.",
     boolean<&Config::nmea, &NmeaConfig::prompt>(), Apply::Live},
    {"nmea.rate_hz", "Hz", "Epochs per second.",
     real<kDaemon, &DaemonConfig::nmea_rate_hz>(0.1, 10.0), Apply::Live},
    {"nmea.serial_path", "", "Serial output: terminal device, a stable name; empty: none.",
     free_text<kDaemon, kSerial, &NmeaSerialConfig::path>(kOptionalDevicePath)},
    {"nmea.serial_baud", "baud", "Its line rate.",
     integer<kDaemon, kSerial, &NmeaSerialConfig::baud>(4800, 12'000'000)},
    {"nmea.tcp", "", "Whether clients can connect over TCP, for example gpsd.",
     boolean<kDaemon, kTcp, &NmeaTcpConfig::enabled>()},
    {"nmea.tcp_address", "", "IPv4 or IPv6 address to listen on.",
     free_text<kDaemon, kTcp, &NmeaTcpConfig::address>(kIpAddress)},
    {"nmea.tcp_port", "", "Port to listen on.",
     integer<kDaemon, kTcp, &NmeaTcpConfig::port>(1, 65'535)},
    {"nmea.tcp_clients_max", "", "Clients served at a time.",
     integer<kDaemon, kTcp, &NmeaTcpConfig::clients_max>(1, 64)},

    {"datum.latitude_deg", "deg", "Latitude of the map's origin, WGS 84, north positive.",
     real<&Config::datum, &Datum::latitude_deg>(-90.0, 90.0), Apply::Live},
    {"datum.longitude_deg", "deg", "Longitude of the map's origin, east positive.",
     real<&Config::datum, &Datum::longitude_deg>(-180.0, 180.0), Apply::Live},
    {"datum.height_m", "m", "Height of the map's plane above the ellipsoid; the altitude of GGA.",
     real<&Config::datum, &Datum::height_m>(-1000.0, 10'000.0), Apply::Live},
    {"datum.bearing_deg", "deg", "True bearing of the map's x axis, clockwise from north (90: x is east, y north).",
     real<&Config::datum, &Datum::bearing_deg>(0.0, 360.0), Apply::Live},

    {"fix.stale_s", "s", "Without a scan for this long the last fix is no fix any more.",
     real<kDaemon, &DaemonConfig::fix, &FixConfig::stale_s>(1.0, 86'400.0), Apply::Live},

    {"lcm.enabled", "", "Whether anything is sent over LCM.",
     boolean<kDaemon, kLcm, &LcmConfig::enabled>()},
    {"lcm.url", "", "Network of LCM; empty: LCM_DEFAULT_URL, else LCM's own default, which stays on this machine.",
     free_text<kDaemon, kLcm, &LcmConfig::url>(kLcmUrl)},
    {"lcm.prefix", "", "First part of the channels POSE, STATUS, COUNTERS, MAP and SCAN.",
     free_text<kDaemon, kLcm, &LcmConfig::prefix>(kLcmPrefix)},
    {"lcm.bot_core_channel", "", "Channel of bot_core.pose_t; empty: none.",
     free_text<kDaemon, kLcm, &LcmConfig::bot_core_channel>(kLcmChannel)},
    {"lcm.status_hz", "Hz", "Statuses per second.",
     real<kDaemon, kLcm, &LcmConfig::status_hz>(0.1, 10.0), Apply::Live},
    {"lcm.map_period_s", "s", "Between two transmissions of a changed map.",
     real<kDaemon, kLcm, &LcmConfig::map_period_s>(0.1, 3600.0), Apply::Live},
};
// clang-format on

}  // namespace

SettingRows output_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
