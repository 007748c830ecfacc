#include "firmware/lcm/status_message.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

void put_device(const DeviceStatus& device, LcmDevice place, StatusMessage& message) noexcept {
  const auto i = static_cast<std::size_t>(place);
  message.device_state[i] = static_cast<std::int8_t>(device.state);
  message.device_problem[i] = to_lcm_text<192>(device.problem.view());
  message.device_model[i] = to_lcm_text<80>(device.model.view());
  message.device_recoveries[i] = device.recoveries;
  message.device_last_recovery_ns[i] = device.last_recovery.count();
}

void put_head(const HeadStatus& head, StatusMessage& message) noexcept {
  message.held = head.held;
  message.phase = to_lcm_text<16>(head.phase);
  message.problem = to_lcm_text<192>(head.problem.view());
  message.head_monotonic_ns = head.stamp.count();
  message.scan = head.scan;
  message.line = head.line;
  message.lines = head.lines;
  message.pan_rad = head.pan_rad;
  message.tilt_rad = head.tilt_rad;
  message.latency_s = head.latency_s;
  message.latency_sigma_s = head.latency_sigma_s;
  message.readings_hz = head.readings_hz;
  message.readings = static_cast<std::int64_t>(head.readings);
  message.wake_latency_max_ns = head.wake_latency_max.count();
}

void put_slam(const SlamStatus& slam, StatusMessage& message) noexcept {
  message.map_frozen = slam.frozen;
  message.scans = slam.scans;
  message.fixes = slam.fixes;
  message.landmarks = slam.landmarks;
  message.hypotheses = slam.hypotheses;
  message.local_maps = slam.local_maps;
  message.local_landmarks = slam.local_landmarks;
  message.map_revision = static_cast<std::int64_t>(slam.map_revision);
  message.process_last_ns = slam.process_last.count();
  message.process_max_ns = slam.process_max.count();
}

constexpr bool is_code(std::int8_t code, auto last) noexcept {
  return code >= 0 && code <= static_cast<std::int8_t>(last);
}

std::size_t parts_of(std::size_t counters) noexcept {
  return std::max<std::size_t>(1, (counters + kLcmCounters - 1) / kLcmCounters);
}

}  // namespace

bool is_sound(const StatusMessage& message) noexcept {
  const bool devices = std::all_of(message.device_state.begin(), message.device_state.end(),
                                   [](auto state) { return is_code(state, hal::DeviceState::Faulted); });
  return devices && is_code(message.state, SensorState::Faulted) &&
         is_code(message.source, SourceMode::Emulated);
}

std::size_t encode_status(const SensorStatus& status, hal::Stamp utc, std::span<std::uint8_t> out) noexcept {
  StatusMessage message;
  message.utime = utc.count() / 1000;
  message.initialization = static_cast<std::int64_t>(status.report.initialization);
  message.uptime_ns = status.report.uptime.count();
  message.time_to_first_fix_ns =
      status.report.time_to_first_fix ? status.report.time_to_first_fix->count() : -1;
  message.state = static_cast<std::int8_t>(status.state);
  message.source = static_cast<std::int8_t>(status.report.source);
  message.realtime = status.realtime;
  message.recording = status.recording;
  message.map_unsaved = status.map_unsaved;
  message.map_name = to_lcm_text<64>(status.map_name.view());
  message.map_saved_ago_ns = status.map_saved_ago == hal::kNever ? -1 : status.map_saved_ago.count();
  put_head(status.head, message);
  put_device(status.head.pan_tilt, LcmDevice::PanTilt, message);
  put_device(status.head.rangefinder, LcmDevice::Rangefinder, message);
  put_slam(status.slam, message);
  return encode_lcm(message, out);
}

bool is_sound(const CountersMessage& message) noexcept {
  return is_code(message.station, LcmStation::Outputs) && message.part >= 0 && message.part < message.parts &&
         message.parts <= static_cast<std::int8_t>(kLcmCounterParts) && message.count >= 0 &&
         message.count <= static_cast<std::int8_t>(kLcmCounters);
}

std::span<const hal::Counter> counters_of(const SensorStatus& status, LcmStation station) noexcept {
  switch (station) {
    case LcmStation::PanTilt:
      return status.head.pan_tilt.counters.all();
    case LcmStation::Rangefinder:
      return status.head.rangefinder.counters.all();
    case LcmStation::Head:
      return status.head.counters.all();
    case LcmStation::Slam:
      return status.slam.counters.all();
    case LcmStation::Outputs:
      break;
  }
  return status.outputs.all();
}

std::size_t encode_counters(const SensorStatus& status, hal::Stamp utc, LcmStation station, std::size_t part,
                            std::span<std::uint8_t> out) noexcept {
  const std::span<const hal::Counter> counters = counters_of(status, station);
  const std::size_t parts = parts_of(counters.size());
  if (part >= parts) {
    return 0;
  }
  const std::span<const hal::Counter> sent =
      counters.subspan(part * kLcmCounters, std::min(kLcmCounters, counters.size() - part * kLcmCounters));
  CountersMessage message;
  message.utime = utc.count() / 1000;
  message.initialization = static_cast<std::int64_t>(status.report.initialization);
  message.station = static_cast<std::int8_t>(station);
  message.part = static_cast<std::int8_t>(part);
  message.parts = static_cast<std::int8_t>(parts);
  message.count = static_cast<std::int8_t>(sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    message.value[i] = static_cast<std::int64_t>(sent[i].value);
    message.name[i] = to_lcm_text<40>(sent[i].name);
  }
  return encode_lcm(message, out);
}

}  // namespace slamsensor::firmware
