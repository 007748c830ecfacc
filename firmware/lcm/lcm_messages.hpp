#pragma once

#include "core/fix.hpp"
#include "core/mapping/landmark_map.hpp"
#include "core/reading.hpp"
#include "firmware/lcm/message.hpp"
#include "firmware/status/sensor_status.hpp"
#include "hal/stamp.hpp"

namespace slamsensor::firmware {

/// slamsensor.pose_t (types/slamsensor_pose_t.lcm): one FixReport. Units, frames and codes stand in the .lcm
/// file.
struct PoseMessage {
  std::int64_t utime = 0;
  std::int64_t scan_start_utc_ns = 0;
  std::int64_t scan_middle_utc_ns = 0;
  std::int64_t scan_end_utc_ns = 0;
  std::int64_t scan_end_monotonic_ns = 0;
  std::int64_t report_monotonic_ns = 0;
  std::int64_t uptime_ns = 0;
  std::int64_t time_to_first_fix_ns = -1;
  std::int64_t initialization = 0;
  std::int64_t scan = 0;
  std::int8_t status = 0;
  std::int8_t reason = 0;
  std::int8_t search_end = 0;
  std::int8_t source = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;
  std::array<double, 9> covariance{};
  std::int64_t error_xi = 0;
  std::int64_t matches = 0;
  std::int64_t landmarks_seen = 0;
  std::int64_t landmarks_in_map = 0;
  double expected_false_alarms = 0.0;
  std::int64_t weight_best = 0;
  std::int64_t weight_runner_up = 0;
  std::int64_t jumps = 0;
  std::int64_t map = 0;
  std::int64_t home = 0;
  double protection_radius_m = 0.0;
  std::array<double, 9> covariance_near{};

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("scan_start_utc_ns", m.scan_start_utc_ns);
    visit("scan_middle_utc_ns", m.scan_middle_utc_ns);
    visit("scan_end_utc_ns", m.scan_end_utc_ns);
    visit("scan_end_monotonic_ns", m.scan_end_monotonic_ns);
    visit("report_monotonic_ns", m.report_monotonic_ns);
    visit("uptime_ns", m.uptime_ns);
    visit("time_to_first_fix_ns", m.time_to_first_fix_ns);
    visit("initialization", m.initialization);
    visit("scan", m.scan);
    visit("status", m.status);
    visit("reason", m.reason);
    visit("search_end", m.search_end);
    visit("source", m.source);
    visit("x_m", m.x_m);
    visit("y_m", m.y_m);
    visit("heading_rad", m.heading_rad);
    visit("covariance", m.covariance);
    visit("error_xi", m.error_xi);
    visit("matches", m.matches);
    visit("landmarks_seen", m.landmarks_seen);
    visit("landmarks_in_map", m.landmarks_in_map);
    visit("expected_false_alarms", m.expected_false_alarms);
    visit("weight_best", m.weight_best);
    visit("weight_runner_up", m.weight_runner_up);
    visit("jumps", m.jumps);
    visit("map", m.map);
    visit("home", m.home);
    visit("protection_radius_m", m.protection_radius_m);
    visit("covariance_near", m.covariance_near);
  }
};

/// Whether the codes of `message` are those of enumerators.
[[nodiscard]] bool is_sound(const PoseMessage& message) noexcept;

/// bot_core.pose_t, known to libbot's viewers (types/bot_core_pose_t.lcm).
struct BotCorePose {
  std::int64_t utime = 0;
  std::array<double, 3> pos{};
  std::array<double, 3> vel{};
  std::array<double, 4> orientation{};
  std::array<double, 3> rotation_rate{};
  std::array<double, 3> accel{};

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("pos", m.pos);
    visit("vel", m.vel);
    visit("orientation", m.orientation);
    visit("rotation_rate", m.rotation_rate);
    visit("accel", m.accel);
  }
};

[[nodiscard]] constexpr bool is_sound(const BotCorePose& /*message*/) noexcept {
  return true;
}

/// Writes slamsensor.pose_t of `report` into `out` and returns its length, 0 when it does not fit.
[[nodiscard]] std::size_t encode_pose(const FixReport& report, std::span<std::uint8_t> out) noexcept;

/// Writes bot_core.pose_t of `report` into `out` and returns its length. That type cannot say that a pose is
/// not valid, so only a fix is written: else 0, as when it does not fit. Height, velocity, rotation rate and
/// acceleration are 0: nothing is known of them.
[[nodiscard]] std::size_t encode_bot_core_pose(const FixReport& report, std::span<std::uint8_t> out) noexcept;

/// The fix in a sound `message`, as it was in the report.
[[nodiscard]] core::Fix fix_of(const PoseMessage& message) noexcept;

/// Landmarks in one slamsensor.scan_t.
inline constexpr std::size_t kScanChunkLandmarks = 40;

/// slamsensor.scan_t (types/slamsensor_scan_t.lcm): a share of the landmarks of one scan, in the sensor
/// frame. All of them, in the order of the chunks, are what core::Slam::process was given.
struct ScanMessage {
  std::int64_t utime = 0;
  std::int64_t initialization = 0;
  std::int64_t scan = 0;
  std::int64_t scan_start_utc_ns = 0;
  std::int64_t scan_middle_utc_ns = 0;
  std::int64_t scan_end_utc_ns = 0;
  std::int64_t scan_end_monotonic_ns = 0;
  std::int32_t landmarks = 0;
  std::int32_t chunk = 0;
  std::int32_t chunks = 1;
  std::int32_t count = 0;
  std::array<double, kScanChunkLandmarks> x_m{};
  std::array<double, kScanChunkLandmarks> y_m{};
  std::array<double, kScanChunkLandmarks> weight{};
  std::array<double, kScanChunkLandmarks> diameter_m{};

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("initialization", m.initialization);
    visit("scan", m.scan);
    visit("scan_start_utc_ns", m.scan_start_utc_ns);
    visit("scan_middle_utc_ns", m.scan_middle_utc_ns);
    visit("scan_end_utc_ns", m.scan_end_utc_ns);
    visit("scan_end_monotonic_ns", m.scan_end_monotonic_ns);
    visit("landmarks", m.landmarks);
    visit("chunk", m.chunk);
    visit("chunks", m.chunks);
    visit("count", m.count);
    visit("x_m", m.x_m);
    visit("y_m", m.y_m);
    visit("weight", m.weight);
    visit("diameter_m", m.diameter_m);
  }
};

/// Whether chunk numbers and counts agree: `count` is what chunk `chunk` of `landmarks` landmarks holds.
[[nodiscard]] bool is_sound(const ScanMessage& message) noexcept;

/// A scan to be sent.
struct LcmScanView {
  std::uint64_t initialization = 0;  ///< FixReport::initialization
  std::uint32_t scan = 0;            ///< Fix::scan
  core::ScanTime time;
  std::span<const core::ScanLandmark> landmarks;
};

/// Messages that a scan takes: at least one, even without landmarks.
[[nodiscard]] std::uint32_t scan_chunks(const LcmScanView& scan) noexcept;

/// Writes chunk number `chunk` (from 0, below scan_chunks) into `out` and returns its length; 0 when there is
/// no such chunk or it does not fit.
[[nodiscard]] std::size_t encode_scan_chunk(const LcmScanView& scan, std::uint32_t chunk,
                                            std::span<std::uint8_t> out) noexcept;

/// When the scan of a sound `message` was made.
[[nodiscard]] core::ScanTime scan_time_of(const ScanMessage& message) noexcept;

/// slamsensor.rivals_t (types/slamsensor_rivals_t.lcm): the rival places of one ambiguous scan.
struct RivalsMessage {
  std::int64_t utime = 0;
  std::int64_t initialization = 0;
  std::int64_t scan = 0;
  std::int32_t count = 0;
  std::array<double, kRivalsMax> x_m{};
  std::array<double, kRivalsMax> y_m{};
  std::array<double, kRivalsMax> heading_rad{};
  std::array<std::int32_t, kRivalsMax> matches{};

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("initialization", m.initialization);
    visit("scan", m.scan);
    visit("count", m.count);
    visit("x_m", m.x_m);
    visit("y_m", m.y_m);
    visit("heading_rad", m.heading_rad);
    visit("matches", m.matches);
  }
};

/// Whether `count` is within its bounds.
[[nodiscard]] constexpr bool is_sound(const RivalsMessage& message) noexcept {
  return message.count >= 0 && message.count <= static_cast<std::int32_t>(kRivalsMax);
}

/// Rivals to be sent.
struct LcmRivalsView {
  std::uint64_t initialization = 0;  ///< FixReport::initialization
  std::uint32_t scan = 0;            ///< Fix::scan
  core::ScanTime time;
  RivalPlaces rivals;
};

/// Writes slamsensor.rivals_t of `view` into `out` and returns its length; 0 when it has no rivals or it does
/// not fit.
[[nodiscard]] std::size_t encode_rivals(const LcmRivalsView& view, std::span<std::uint8_t> out) noexcept;

/// Landmarks in one slamsensor.map_t.
inline constexpr std::size_t kMapChunkLandmarks = 25;

/// slamsensor.map_t (types/slamsensor_map_t.lcm): a share of the landmarks of the map, in the map frame.
/// Chunks of one `initialization` and `revision` belong together.
struct MapMessage {
  std::int64_t utime = 0;
  std::int64_t initialization = 0;
  std::int64_t revision = 0;
  std::int32_t landmarks = 0;
  std::int32_t chunk = 0;
  std::int32_t chunks = 1;
  std::int32_t count = 0;
  std::array<std::int64_t, kMapChunkLandmarks> id{};
  std::array<double, kMapChunkLandmarks> x_m{};
  std::array<double, kMapChunkLandmarks> y_m{};
  std::array<double, kMapChunkLandmarks> sigma_m{};
  std::array<double, kMapChunkLandmarks> diameter_m{};
  std::array<std::int32_t, kMapChunkLandmarks> xi{};
  std::array<std::int32_t, kMapChunkLandmarks> sightings{};
  std::array<std::int32_t, kMapChunkLandmarks> last_scan{};

  static constexpr void members(auto& m, auto&& visit) {
    visit("utime", m.utime);
    visit("initialization", m.initialization);
    visit("revision", m.revision);
    visit("landmarks", m.landmarks);
    visit("chunk", m.chunk);
    visit("chunks", m.chunks);
    visit("count", m.count);
    visit("id", m.id);
    visit("x_m", m.x_m);
    visit("y_m", m.y_m);
    visit("sigma_m", m.sigma_m);
    visit("diameter_m", m.diameter_m);
    visit("xi", m.xi);
    visit("sightings", m.sightings);
    visit("last_scan", m.last_scan);
  }
};

/// Whether chunk numbers and counts agree: `count` is what chunk `chunk` of `landmarks` landmarks holds.
[[nodiscard]] bool is_sound(const MapMessage& message) noexcept;

/// A map to be sent; both lists have the same length.
struct LcmMapView {
  hal::Stamp utc{};                  ///< when the lists were copied
  std::uint64_t initialization = 0;  ///< FixReport::initialization
  std::uint64_t revision = 0;        ///< SlamStatus::map_revision
  std::span<const core::MapLandmark> landmarks;
  std::span<const core::Point2> positions_W;
};

/// Messages that a map takes: at least one, even when it is empty.
[[nodiscard]] std::uint32_t map_chunks(const LcmMapView& map) noexcept;

/// Writes chunk number `chunk` (from 0, below map_chunks) into `out` and returns its length; 0 when there is
/// no such chunk or it does not fit.
[[nodiscard]] std::size_t encode_map_chunk(const LcmMapView& map, std::uint32_t chunk,
                                           std::span<std::uint8_t> out) noexcept;

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
