#pragma once

#include "firmware/lcm/message.hpp"
#include "firmware/status/sensor_status.hpp"

namespace slamsensor::firmware {

/// Places of the two devices in the arrays of StatusMessage.
enum class LcmDevice : std::uint8_t { PanTilt, Rangefinder };
inline constexpr std::size_t kLcmDevices = 2;

/// slamsensor.status_t (types/slamsensor_status_t.lcm): SensorStatus without its fix, which pose_t has, and
/// without its counters, which counters_t has. Units and codes stand in the .lcm file.
struct StatusMessage {
  std::int64_t utime = 0;
  std::int64_t initialization = 0;
  std::int64_t uptime_ns = 0;
  std::int64_t time_to_first_fix_ns = -1;
  std::int8_t state = 0;
  std::int8_t source = 0;
  bool held = false;
  bool realtime = false;
  bool recording = false;
  bool map_frozen = false;
  bool map_unsaved = false;
  LcmText<16> phase{};
  LcmText<192> problem{};
  std::array<std::int8_t, kLcmDevices> device_state{};
  std::array<LcmText<192>, kLcmDevices> device_problem{};
  std::array<LcmText<80>, kLcmDevices> device_model{};
  std::array<std::int64_t, kLcmDevices> device_recoveries{};
  std::array<std::int64_t, kLcmDevices> device_last_recovery_ns{};
  std::int64_t head_monotonic_ns = 0;
  std::int64_t scan = 0;
  std::int64_t line = 0;
  std::int64_t lines = 0;
  double pan_rad = 0.0;
  double tilt_rad = 0.0;
  double latency_s = 0.0;
  double latency_sigma_s = 0.0;
  double readings_hz = 0.0;
  std::int64_t readings = 0;
  std::int64_t wake_latency_max_ns = 0;
  std::int64_t scans = 0;
  std::int64_t fixes = 0;
  std::int64_t landmarks = 0;
  std::int64_t hypotheses = 0;
  std::int64_t local_maps = 0;
  std::int64_t local_landmarks = 0;
  std::int64_t map_revision = 0;
  std::int64_t process_last_ns = 0;
  std::int64_t process_max_ns = 0;
  LcmText<64> map_name{};
  std::int64_t map_saved_ago_ns = -1;

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("initialization", m.initialization);
    visit("uptime_ns", m.uptime_ns);
    visit("time_to_first_fix_ns", m.time_to_first_fix_ns);
    visit("state", m.state);
    visit("source", m.source);
    visit("held", m.held);
    visit("realtime", m.realtime);
    visit("recording", m.recording);
    visit("map_frozen", m.map_frozen);
    visit("map_unsaved", m.map_unsaved);
    visit("phase", m.phase);
    visit("problem", m.problem);
    visit("device_state", m.device_state);
    visit("device_problem", m.device_problem);
    visit("device_model", m.device_model);
    visit("device_recoveries", m.device_recoveries);
    visit("device_last_recovery_ns", m.device_last_recovery_ns);
    visit("head_monotonic_ns", m.head_monotonic_ns);
    visit("scan", m.scan);
    visit("line", m.line);
    visit("lines", m.lines);
    visit("pan_rad", m.pan_rad);
    visit("tilt_rad", m.tilt_rad);
    visit("latency_s", m.latency_s);
    visit("latency_sigma_s", m.latency_sigma_s);
    visit("readings_hz", m.readings_hz);
    visit("readings", m.readings);
    visit("wake_latency_max_ns", m.wake_latency_max_ns);
    visit("scans", m.scans);
    visit("fixes", m.fixes);
    visit("landmarks", m.landmarks);
    visit("hypotheses", m.hypotheses);
    visit("local_maps", m.local_maps);
    visit("local_landmarks", m.local_landmarks);
    visit("map_revision", m.map_revision);
    visit("process_last_ns", m.process_last_ns);
    visit("process_max_ns", m.process_max_ns);
    visit("map_name", m.map_name);
    visit("map_saved_ago_ns", m.map_saved_ago_ns);
  }
};

/// Whether the codes of `message` are those of enumerators.
[[nodiscard]] bool is_sound(const StatusMessage& message) noexcept;

/// Writes slamsensor.status_t of `status`, made at `utc`, into `out` and returns its length, 0 when it does
/// not fit.
[[nodiscard]] std::size_t encode_status(const SensorStatus& status, hal::Stamp utc,
                                        std::span<std::uint8_t> out) noexcept;

/// Whose counters a counters_t has.
enum class LcmStation : std::uint8_t { PanTilt, Rangefinder, Head, Slam, Outputs };
inline constexpr std::array<std::string_view, 5> kLcmStationNames = {"pan_tilt", "rangefinder", "head",
                                                                     "slam", "outputs"};

/// Counters in one counters_t.
inline constexpr std::size_t kLcmCounters = 24;
static_assert(kStatusCountersMax % kLcmCounters == 0);

/// Messages for the counters of one station.
inline constexpr std::size_t kLcmCounterParts = kStatusCountersMax / kLcmCounters;

/// slamsensor.counters_t (types/slamsensor_counters_t.lcm): up to kLcmCounters counters of one station.
struct CountersMessage {
  std::int64_t utime = 0;
  std::int64_t initialization = 0;
  std::int8_t station = 0;
  std::int8_t part = 0;
  std::int8_t parts = 1;
  std::int8_t count = 0;
  std::array<std::int64_t, kLcmCounters> value{};
  std::array<LcmText<40>, kLcmCounters> name{};

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("initialization", m.initialization);
    visit("station", m.station);
    visit("part", m.part);
    visit("parts", m.parts);
    visit("count", m.count);
    visit("value", m.value);
    visit("name", m.name);
  }
};

/// Whether station, part and count are within their bounds.
[[nodiscard]] bool is_sound(const CountersMessage& message) noexcept;

/// The counters of `station` in `status`.
[[nodiscard]] std::span<const hal::Counter> counters_of(const SensorStatus& status,
                                                        LcmStation station) noexcept;

/// Writes slamsensor.counters_t of `station` in `status`, its part number `part` (from 0), into `out` and
/// returns its length; 0 when there is no such part or it does not fit. A station without counters has one
/// part, with none.
[[nodiscard]] std::size_t encode_counters(const SensorStatus& status, hal::Stamp utc, LcmStation station,
                                          std::size_t part, std::span<std::uint8_t> out) noexcept;

}  // namespace slamsensor::firmware
