#include "firmware/control/status_json.hpp"

#include "core/config.hpp"
#include "core/fix_names.hpp"
#include "firmware/control/json_writer.hpp"
#include "firmware/supervision/status_parts.hpp"

#include <utility>

namespace slamsensor::firmware {
namespace {

void write_seconds(JsonWriter& json, std::string_view name, hal::Stamp time) {
  json.key(name);
  time == hal::kNever ? json.null() : json.value(hal::to_seconds(time));
}

void write_matrix(JsonWriter& json, std::string_view name, const Eigen::Matrix3d& matrix) {
  json.key(name).begin_array();
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = 0; column < 3; ++column) {
      json.value(matrix(row, column));
    }
  }
  json.end_array();
}

void write_pose(JsonWriter& json, const core::Fix& fix) {
  json.member("map", fix.map).member("x_m", fix.pose_W.x_m).member("y_m", fix.pose_W.y_m);
  json.member("heading_rad", fix.pose_W.heading_rad);
  json.member("heading_deg", fix.pose_W.heading_rad / core::kDegree);
  write_matrix(json, "covariance", fix.covariance);
  const auto sigma = pose_sigma(fix.covariance);
  json.key("sigma_m");
  sigma ? json.value(sigma->position_m) : json.null();
  json.key("sigma_heading_rad");
  sigma ? json.value(sigma->heading_rad) : json.null();
  json.member("protection_radius_m", fix.protection_radius_m);
  write_matrix(json, "covariance_near", fix.covariance_near);
  const auto near = pose_sigma(fix.covariance_near);
  json.key("sigma_near_m");
  near ? json.value(near->position_m) : json.null();
  json.member("error_xi", fix.error_xi);
}

void write_no_pose(JsonWriter& json) {
  for (const char* name :
       {"map", "x_m", "y_m", "heading_rad", "heading_deg", "covariance", "sigma_m", "sigma_heading_rad",
        "protection_radius_m", "covariance_near", "sigma_near_m", "error_xi"}) {
    json.key(name).null();
  }
}

void write_fix(JsonWriter& json, const core::Fix& fix) {
  json.begin_object();
  json.member("status", to_string(fix.status)).member("reason", to_string(fix.reason));
  json.member("search_end", to_string(fix.search_end)).member("scan", fix.scan);
  json.member("start_utc_ns", std::int64_t{fix.time.start_utc.count()});
  json.member("middle_utc_ns", std::int64_t{fix.time.middle_utc.count()});
  json.member("end_utc_ns", std::int64_t{fix.time.end_utc.count()});
  json.member("home", fix.home);
  has_pose(fix) ? write_pose(json, fix) : write_no_pose(json);
  json.member("matches", fix.matches).member("landmarks_seen", fix.landmarks_seen);
  json.member("landmarks_in_map", fix.landmarks_in_map);
  json.member("expected_false_alarms", fix.expected_false_alarms);
  json.member("weight_best", fix.weight_best).member("weight_runner_up", fix.weight_runner_up);
  json.member("jumps", fix.jumps);
  json.end_object();
}

void write_devices(JsonWriter& json, const SensorStatus& status) {
  json.begin_object();
  for (const NamedDevice& device : devices_of(status)) {
    json.key(device.key).begin_object();
    json.member("state", to_string(device.status->state)).member("problem", device.status->problem.view());
    json.member("model", device.status->model.view()).member("recoveries", device.status->recoveries);
    write_seconds(json, "last_recovery_s", device.status->last_recovery);
    json.end_object();
  }
  json.end_object();
}

void write_counters(JsonWriter& json, const SensorStatus& status) {
  json.begin_object();
  for (const NamedCounters& station : counters_of(status)) {
    json.key(station.key).begin_object();
    for (const hal::Counter& counter : station.table->all()) {
      json.member(counter.name, counter.value);
    }
    json.end_object();
  }
  json.end_object();
}

void write_head(JsonWriter& json, const HeadStatus& head) {
  json.begin_object();
  json.member("phase", head.phase).member("problem", head.problem.view()).member("held", head.held);
  json.member("scan", head.scan).member("line", head.line).member("lines", head.lines);
  json.member("pan_rad", head.pan_rad).member("tilt_rad", head.tilt_rad);
  for (const auto& [name, angle] : {std::pair("roll_rad", &core::Attitude::roll_rad),
                                    std::pair("pitch_rad", &core::Attitude::pitch_rad)}) {
    json.key(name);
    head.attitude ? json.value((*head.attitude).*angle) : json.null();
  }
  json.member("latency_s", head.latency_s).member("latency_sigma_s", head.latency_sigma_s);
  json.member("readings_hz", head.readings_hz).member("readings", head.readings);
  write_seconds(json, "wake_latency_max_s", head.wake_latency_max);
  json.end_object();
}

void write_slam(JsonWriter& json, const SlamStatus& slam) {
  json.begin_object();
  json.member("scans", slam.scans).member("fixes", slam.fixes).member("landmarks", slam.landmarks);
  json.member("hypotheses", slam.hypotheses).member("local_maps", slam.local_maps);
  json.member("local_landmarks", slam.local_landmarks);
  write_seconds(json, "process_last_s", slam.process_last);
  write_seconds(json, "process_max_s", slam.process_max);
  json.end_object();
}

void write_map(JsonWriter& json, const SensorStatus& status) {
  json.begin_object();
  json.member("name", status.map_name.view()).member("landmarks", status.slam.landmarks);
  json.member("revision", status.slam.map_revision).member("frozen", status.slam.frozen);
  json.member("unsaved", status.map_unsaved);
  write_seconds(json, "saved_ago_s", status.map_saved_ago);
  json.end_object();
}

void write_report(JsonWriter& json, const FixReport& report) {
  json.member("source", to_string(report.source));
  write_seconds(json, "uptime_s", report.uptime);
  write_seconds(json, "time_to_first_fix_s", report.time_to_first_fix.value_or(hal::kNever));
  json.member("initialization", report.initialization);
}

}  // namespace

std::string status_json(const SensorStatus& status) {
  JsonWriter json;
  json.begin_object().member("state", to_string(status.state));
  write_report(json, status.report);
  write_fix(json.key("fix"), status.report.fix);
  write_devices(json.key("devices"), status);
  write_head(json.key("head"), status.head);
  write_slam(json.key("slam"), status.slam);
  write_map(json.key("map"), status);
  json.member("realtime", status.realtime).member("recording", status.recording);
  write_counters(json.key("counters"), status);
  return json.end_object().text();
}

std::string fix_json(const SensorStatus& status) {
  JsonWriter json;
  write_fix(json, status.report.fix);
  return json.text();
}

std::string counters_json(const SensorStatus& status) {
  JsonWriter json;
  write_counters(json, status);
  return json.text();
}

std::string devices_json(const SensorStatus& status) {
  JsonWriter json;
  write_devices(json, status);
  return json.text();
}

}  // namespace slamsensor::firmware
