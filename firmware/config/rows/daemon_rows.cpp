#include "firmware/config/rows/setting_rows.hpp"
#include "firmware/config/rows/text_rules.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;

// Lists of names are those of the enumerators, in their order.

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

constexpr std::string_view kModes[] = {"required", "optional", "off"};
constexpr auto kRealtime = &DaemonConfig::realtime;

constexpr std::string_view kPolarities[] = {"active_high", "active_low"};
constexpr std::string_view kBiases[] = {"as_is", "disabled", "pull_up", "pull_down"};
constexpr auto kGpio = &DaemonConfig::gpio;

constexpr Section kSections[] = {
    {"nmea", "NMEA 0183 output."},
    {"datum", "Ties the map frame to the earth. Without it no latitude or longitude is ever emitted.",
     [](Config& config) { config.datum.reset(); }},
    {"fix", "What becomes of a fix."},
    {"lcm", "LCM output. The sensor only transmits."},
    {"realtime", "What the threads that read the devices and find the pose ask of the machine."},
    {"map", "Where maps are kept."},
    {"control", "How the running sensor is controlled."},
    {"record", "Recordings of all that comes in and goes out."},
    {"gpio", "Lines of a GPIO chip that the sensor uses. A chip is \"/dev/gpiochip0\" or its label."},
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
    {"lcm.prefix", "", "First part of the channels POSE, RIVALS, STATUS, COUNTERS, MAP and SCAN.",
     free_text<kDaemon, kLcm, &LcmConfig::prefix>(kLcmPrefix)},
    {"lcm.bot_core_channel", "", "Channel of bot_core.pose_t; empty: none.",
     free_text<kDaemon, kLcm, &LcmConfig::bot_core_channel>(kLcmChannel)},

    {"realtime.mode", "", "required: no start without it; optional: as much as is granted, and the log says so.",
     choice<kDaemon, kRealtime, &RealtimeConfig::mode>(kModes)},
    {"realtime.slam_deadline_s", "s", "For the pose of a scan; then the search is cut.",
     real<kDaemon, kRealtime, &RealtimeConfig::slam_deadline_s>(0.01, 600.0)},

    {"map.directory", "", "Folder of the maps.",
     free_text<kDaemon, &DaemonConfig::map_store, &MapStoreConfig::directory>(kFolder)},
    {"map.name", "", "Map that is loaded at start and saved to.",
     free_text<kDaemon, &DaemonConfig::map_store, &MapStoreConfig::name>(kMapName)},
    {"map.autosave_s", "s", "Between two saves of a changed map; 0: never by itself.",
     real<kDaemon, &DaemonConfig::map_store, &MapStoreConfig::autosave_s>(0.0, 86'400.0), Apply::Live},
    {"map.frozen", "", "Localise only: the map never changes, in memory or on disk.",
     boolean<kDaemon, &DaemonConfig::map_store, &MapStoreConfig::frozen>(), Apply::Live},

    {"control.socket", "", "Path of the control socket of 'slamsensor ctl'.",
     free_text<kDaemon, &DaemonConfig::control, &ControlConfig::socket>(kSocketPath)},

    {"record.directory", "", "Folder of the recordings.",
     free_text<kDaemon, &DaemonConfig::record, &RecordConfig::directory>(kFolder)},
    {"record.size_max_mb", "MB", "A recording that reaches it is ended.",
     integer<kDaemon, &DaemonConfig::record, &RecordConfig::size_max_mb>(1, 1'000'000), Apply::Live},

    {"gpio.trigger_chip", "", "Input whose active edge asks for one scan: chip or its label; empty: not used.",
     free_text<kDaemon, kGpio, &GpioConfig::trigger, &GpioInputSetting::chip>(kGpioChip)},
    {"gpio.trigger_line", "", "Its line of the chip.",
     integer<kDaemon, kGpio, &GpioConfig::trigger, &GpioInputSetting::line>(0, 1023)},
    {"gpio.trigger_polarity", "", "Level at which it is active.",
     choice<kDaemon, kGpio, &GpioConfig::trigger, &GpioInputSetting::polarity>(kPolarities)},
    {"gpio.trigger_bias", "", "Pull resistor of the chip.",
     choice<kDaemon, kGpio, &GpioConfig::trigger, &GpioInputSetting::bias>(kBiases)},
    {"gpio.interlock_chip", "", "Input that allows scanning while active: chip or its label; empty: not used.",
     free_text<kDaemon, kGpio, &GpioConfig::interlock, &GpioInputSetting::chip>(kGpioChip)},
    {"gpio.interlock_line", "", "Its line of the chip.",
     integer<kDaemon, kGpio, &GpioConfig::interlock, &GpioInputSetting::line>(0, 1023)},
    {"gpio.interlock_polarity", "", "Level at which it is active.",
     choice<kDaemon, kGpio, &GpioConfig::interlock, &GpioInputSetting::polarity>(kPolarities)},
    {"gpio.interlock_bias", "", "Pull resistor of the chip.",
     choice<kDaemon, kGpio, &GpioConfig::interlock, &GpioInputSetting::bias>(kBiases)},
    {"gpio.led_chip", "", "Output on with a fix, blinking while devices are missing: chip or its label; empty: not used.",
     free_text<kDaemon, kGpio, &GpioConfig::led, &GpioOutputSetting::chip>(kGpioChip)},
    {"gpio.led_line", "", "Its line of the chip.",
     integer<kDaemon, kGpio, &GpioConfig::led, &GpioOutputSetting::line>(0, 1023)},
    {"gpio.led_polarity", "", "Level at which it is active.",
     choice<kDaemon, kGpio, &GpioConfig::led, &GpioOutputSetting::polarity>(kPolarities)},
    {"gpio.pulse_chip", "", "Output active for pulse_s at each new fix: chip or its label; empty: not used.",
     free_text<kDaemon, kGpio, &GpioConfig::pulse, &GpioOutputSetting::chip>(kGpioChip)},
    {"gpio.pulse_line", "", "Its line of the chip.",
     integer<kDaemon, kGpio, &GpioConfig::pulse, &GpioOutputSetting::line>(0, 1023)},
    {"gpio.pulse_polarity", "", "Level at which it is active.",
     choice<kDaemon, kGpio, &GpioConfig::pulse, &GpioOutputSetting::polarity>(kPolarities)},
    {"gpio.pulse_s", "s", "Length of that pulse.",
     real<kDaemon, kGpio, &GpioConfig::pulse_s>(0.001, 10.0)},
};
// clang-format on

}  // namespace

SettingRows daemon_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
