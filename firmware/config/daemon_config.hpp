#pragma once

#include <cstdint>
#include <string>

namespace slamsensor::firmware {

/// What scan and SLAM thread ask of the machine.
enum class RealtimeMode : std::uint8_t {
  Required,  ///< real-time scheduling and locked memory, or the daemon refuses to start
  Optional,  ///< as much as is granted; the log and the status say what is missing
  Off,       ///< not asked for
};

struct RealtimeConfig {
  RealtimeMode mode = RealtimeMode::Optional;
  double scan_period_s = 0.00073;      ///< [0.0005, 0.01] s between two looks at the devices; off the grid of
                                       ///< their own milliseconds, so that roundings average out
  double scan_deadline_s = 0.005;      ///< [0.0005, 0.1] s: a look that ends later than this after it was
                                       ///< due is a counted miss
  double slam_deadline_s = 5.0;        ///< [0.01, 600] s for the pose of a scan; then the search is cut
  std::uint32_t scanlines_queued = 8;  ///< [2, 64] scanlines between scan and SLAM thread
};

/// What becomes of a fix.
struct FixConfig {
  double stale_s = 600.0;  ///< [1, 86400] s without a scan after which the last fix is no fix any more
};

struct NmeaSerialConfig {
  std::string path;             ///< "/dev/ttyS1", a stable name; empty: no serial output
  std::uint32_t baud = 38'400;  ///< [4800, 12000000]
};

struct NmeaTcpConfig {
  bool enabled = false;
  std::string address = "127.0.0.1";  ///< IPv4 or IPv6 to listen on
  std::uint32_t port = 10'110;        ///< [1, 65535] (10110: NMEA 0183 over IP, IANA)
  std::uint32_t clients_max = 8;      ///< [1, 64]
};

/// The LCM channels. The daemon only transmits.
struct LcmConfig {
  bool enabled = true;
  std::string url;                        ///< empty: LCM_DEFAULT_URL, else LCM's own default (ttl 0)
  std::string prefix = "SLAMSENSOR_";     ///< of the own channels: POSE, STATUS, COUNTERS, MAP, SCAN
  std::string bot_core_channel = "POSE";  ///< of bot_core.pose_t; empty: none
  double map_period_s = 5.0;              ///< [0.1, 3600] between two transmissions of a changed map
};

struct MapStoreConfig {
  std::string directory = "/var/lib/slamsensor/maps";
  std::string name = "default";  ///< the map that is loaded at start and saved to; [A-Za-z0-9_-], 1..64
  double autosave_s = 60.0;      ///< [0, 86400] s between two saves of a changed map; 0: never by itself
  bool frozen = false;           ///< localise only: the map never changes, in memory or on disk
};

struct ControlConfig {
  std::string socket = "/run/slamsensor/control";
};

struct RecordConfig {
  std::string directory = "/var/lib/slamsensor/recordings";
  std::uint32_t size_max_mb = 1024;  ///< [1, 1000000]: a recording that reaches it is ended
};

/// A line of a GPIO chip that the daemon uses; an empty chip: not used.
enum class GpioPolaritySetting : std::uint8_t { ActiveHigh, ActiveLow };
enum class GpioBiasSetting : std::uint8_t { AsIs, Disabled, PullUp, PullDown };

struct GpioInputSetting {
  std::string chip;        ///< "/dev/gpiochip0" or its label
  std::uint32_t line = 0;  ///< [0, 1023]
  GpioPolaritySetting polarity = GpioPolaritySetting::ActiveHigh;
  GpioBiasSetting bias = GpioBiasSetting::AsIs;
  double debounce_s = 0.005;  ///< [0, 1]
};

struct GpioOutputSetting {
  std::string chip;
  std::uint32_t line = 0;
  GpioPolaritySetting polarity = GpioPolaritySetting::ActiveHigh;
};

struct GpioConfig {
  GpioInputSetting trigger;    ///< its active edge asks for one scan
  GpioInputSetting interlock;  ///< active: scanning is allowed. Inactive, or a line that cannot be read: not
  GpioOutputSetting led;       ///< on with a fix, off without, blinking while the devices are not there
  GpioOutputSetting pulse;     ///< active for `pulse_s` at each new fix
  double pulse_s = 0.1;        ///< [0.001, 10]
};

/// Settings of the daemon beside those of the sensor head and the method.
struct DaemonConfig {
  RealtimeConfig realtime;
  FixConfig fix;
  NmeaSerialConfig nmea_serial;
  NmeaTcpConfig nmea_tcp;
  double nmea_rate_hz = 1.0;  ///< [0.1, 10] epochs per second
  LcmConfig lcm;
  MapStoreConfig map_store;
  ControlConfig control;
  RecordConfig record;
  GpioConfig gpio;
};

}  // namespace slamsensor::firmware
