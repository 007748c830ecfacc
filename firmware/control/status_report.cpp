#include "firmware/control/status_report.hpp"

#include "core/config.hpp"
#include "core/fix.hpp"
#include "firmware/status/status_text.hpp"
#include "firmware/supervision/log.hpp"

#include <nlohmann/json.hpp>

#include <utility>

namespace slamsensor::firmware {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(hal::Stamp time) {
  return time == hal::kNever ? Json() : Json(hal::to_seconds(time));
}

Json json_of(const Eigen::Matrix3d& matrix) {
  Json values = Json::array();
  for (Eigen::Index i = 0; i < matrix.size(); ++i) {
    values.push_back(matrix(i / 3, i % 3));
  }
  return values;
}

Json sigma_json(const Eigen::Matrix3d& covariance, double PoseSigma::*part) {
  const auto sigma = pose_sigma(covariance);
  return sigma ? Json((*sigma).*part) : Json();
}

/// Null for all of it where there is no pose.
void add_pose(Json& out, const core::Fix& fix) {
  const Json pose = {{"map", fix.map},
                     {"x_m", fix.pose_W.x_m},
                     {"y_m", fix.pose_W.y_m},
                     {"heading_rad", fix.pose_W.heading_rad},
                     {"heading_deg", fix.pose_W.heading_rad / core::kDegree},
                     {"covariance", json_of(fix.covariance)},
                     {"sigma_m", sigma_json(fix.covariance, &PoseSigma::position_m)},
                     {"sigma_heading_rad", sigma_json(fix.covariance, &PoseSigma::heading_rad)},
                     {"protection_radius_m", fix.protection_radius_m},
                     {"covariance_near", json_of(fix.covariance_near)},
                     {"sigma_near_m", sigma_json(fix.covariance_near, &PoseSigma::position_m)},
                     {"error_xi", fix.error_xi}};
  for (const auto& [key, value] : pose.items()) {
    out[key] = has_pose(fix) ? value : Json();
  }
}

Json json_of(const core::Fix& fix) {
  Json out = {{"status", to_string(fix.status)},
              {"reason", to_string(fix.reason)},
              {"search_end", to_string(fix.search_end)},
              {"scan", fix.scan},
              {"start_utc_ns", fix.time.start_utc.count()},
              {"middle_utc_ns", fix.time.middle_utc.count()},
              {"end_utc_ns", fix.time.end_utc.count()},
              {"home", fix.home}};
  add_pose(out, fix);
  out["matches"] = fix.matches;
  out["landmarks_seen"] = fix.landmarks_seen;
  out["landmarks_in_map"] = fix.landmarks_in_map;
  out["expected_false_alarms"] = fix.expected_false_alarms;
  out["weight_best"] = fix.weight_best;
  out["weight_runner_up"] = fix.weight_runner_up;
  out["jumps"] = fix.jumps;
  out["home_replaced"] = fix.is_home_replaced;
  return out;
}

Json json_of_devices(const SensorStatus& status) {
  Json out = Json::object();
  for (const NamedDevice& device : devices_of(status)) {
    out[std::string(device.key)] = {{"state", to_string(device.status->state)},
                                    {"problem", device.status->problem.view()},
                                    {"model", device.status->model.view()},
                                    {"last_loss", device.status->last_loss.view()},
                                    {"recoveries", device.status->recoveries},
                                    {"last_recovery_s", json_of(device.status->last_recovery)}};
  }
  return out;
}

Json json_of_counters(const SensorStatus& status) {
  Json out = Json::object();
  for (const NamedCounters& station : counters_of(status)) {
    Json& table = out[std::string(station.key)] = Json::object();
    for (const hal::Counter& counter : station.table->all()) {
      table[std::string(counter.name)] = counter.value;
    }
  }
  return out;
}

Json json_of(const HeadStatus& head) {
  return {{"phase", head.phase},
          {"problem", head.problem.view()},
          {"held", head.held},
          {"scan", head.scan},
          {"line", head.line},
          {"lines", head.lines},
          {"pan_rad", head.pan_rad},
          {"tilt_rad", head.tilt_rad},
          {"roll_rad", head.attitude ? Json(head.attitude->roll_rad) : Json()},
          {"pitch_rad", head.attitude ? Json(head.attitude->pitch_rad) : Json()},
          {"latency_s", head.latency_s},
          {"latency_sigma_s", head.latency_sigma_s},
          {"readings_hz", head.readings_hz},
          {"readings", head.readings},
          {"wake_latency_max_s", json_of(head.wake_latency_max)}};
}

Json json_of(const SlamStatus& slam) {
  return {{"scans", slam.scans},
          {"fixes", slam.fixes},
          {"landmarks", slam.landmarks},
          {"hypotheses", slam.hypotheses},
          {"local_maps", slam.local_maps},
          {"local_landmarks", slam.local_landmarks},
          {"process_last_s", json_of(slam.process_last)},
          {"process_max_s", json_of(slam.process_max)}};
}

Json json_of_map(const SensorStatus& status) {
  return {{"name", status.map_name.view()},       {"landmarks", status.slam.landmarks},
          {"revision", status.slam.map_revision}, {"frozen", status.slam.frozen},
          {"unsaved", status.map_unsaved},        {"saved_ago_s", json_of(status.map_saved_ago)}};
}

/// In one line; what a device said in no UTF-8 becomes U+FFFD.
std::string written(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string field(std::string_view name, std::string_view value) {
  std::string line(name);
  line += ':';
  line.resize(std::max<std::size_t>(line.size() + 1, 16), ' ');
  line += value;
  return line;
}

std::string seconds(hal::Stamp time) {
  return decimal_text(hal::to_seconds(time), 1) + " s";
}

std::string milliseconds(hal::Stamp time) {
  return decimal_text(1e3 * hal::to_seconds(time), 2) + " ms";
}

std::string device_text(const DeviceStatus& device) {
  std::string text(to_string(device.state));
  if (!device.model.view().empty()) {
    text += ", " + std::string(device.model.view());
  }
  if (!device.problem.view().empty()) {
    text += ": " + std::string(device.problem.view());
  }
  if (device.recoveries > 0) {
    text += "; recovered " + std::to_string(device.recoveries) + " times, the last within " +
            milliseconds(device.last_recovery);
  }
  if (!device.last_loss.view().empty() && device.last_loss.view() != device.problem.view()) {
    text += "; last lost: " + std::string(device.last_loss.view());
  }
  return text;
}

std::string map_text(const SensorStatus& status) {
  std::string text(status.map_name.view());
  text += ", " + std::to_string(status.slam.landmarks) + " landmarks";
  text += local_maps_phrase(status.slam);
  text += status.slam.frozen ? ", frozen" : "";
  if (status.map_saved_ago == hal::kNever) {
    return text + (status.map_unsaved ? ", not saved yet" : ", nothing to save");
  }
  return text + (status.map_unsaved ? ", changed since it was saved " : ", saved ") +
         seconds(status.map_saved_ago) + " ago";
}

std::string scan_text(const HeadStatus& head) {
  std::string text(head.phase);
  text += ", scan " + std::to_string(head.scan) + ", line " + std::to_string(head.line) + " of " +
          std::to_string(head.lines) + ", " + decimal_text(head.readings_hz, 0) + " readings/s";
  if (head.held) {
    text += ", held";
  }
  return head.problem.view().empty() ? text : text + ": " + std::string(head.problem.view());
}

std::string slam_text(const SlamStatus& slam) {
  return std::to_string(slam.fixes) + " fixes of " + std::to_string(slam.scans) + " scans, " +
         std::to_string(slam.hypotheses) + " hypotheses, end of scan to fix " +
         milliseconds(slam.process_last) + " (worst " + milliseconds(slam.process_max) + ')';
}

/// "1 sigma", in the frame of the map or relative to the landmarks about.
void append_sigma(std::vector<std::string>& lines, std::string_view name, const Eigen::Matrix3d& covariance) {
  if (const auto sigma = pose_sigma(covariance)) {
    lines.push_back(field(name, decimal_text(sigma->position_m, 3) + " m, " +
                                    decimal_text(sigma->heading_rad / core::kDegree, 2) + " deg"));
  }
}

void append_pose(std::vector<std::string>& lines, const core::Fix& fix) {
  lines.push_back(field("map", std::to_string(fix.map) +
                                   (fix.map == fix.home ? ", home" : ", local: its place is not known yet")));
  lines.push_back(field("x", decimal_text(fix.pose_W.x_m, 3) + " m"));
  lines.push_back(field("y", decimal_text(fix.pose_W.y_m, 3) + " m"));
  lines.push_back(field("heading", decimal_text(fix.pose_W.heading_rad / core::kDegree, 2) +
                                       " deg, counter-clockwise from the map's x axis"));
  append_sigma(lines, "1 sigma", fix.covariance);
  append_sigma(lines, "1 sigma near", fix.covariance_near);
  lines.push_back(field("protection", decimal_text(fix.protection_radius_m, 3) +
                                          " m, exceeded with at most the configured risk"));
  lines.push_back(field("error xi", std::to_string(fix.error_xi)));
}

}  // namespace

std::string status_json(const SensorStatus& status) {
  const FixReport& report = status.report;
  return written({{"state", to_string(status.state)},
                  {"source", to_string(report.source)},
                  {"uptime_s", json_of(report.uptime)},
                  {"time_to_first_fix_s", json_of(report.time_to_first_fix.value_or(hal::kNever))},
                  {"initialization", report.initialization},
                  {"fix", json_of(report.fix)},
                  {"devices", json_of_devices(status)},
                  {"head", json_of(status.head)},
                  {"slam", json_of(status.slam)},
                  {"map", json_of_map(status)},
                  {"realtime", status.realtime},
                  {"recording", status.recording},
                  {"counters", json_of_counters(status)}});
}

std::string fix_json(const SensorStatus& status) {
  return written(json_of(status.report.fix));
}

std::string counters_json(const SensorStatus& status) {
  return written(json_of_counters(status));
}

std::string devices_json(const SensorStatus& status) {
  return written(json_of_devices(status));
}

std::vector<std::string> status_text(const SensorStatus& status) {
  const FixReport& report = status.report;
  std::vector<std::string> lines = {
      field("state", to_string(status.state)), field("fix", fix_phrase(status)),
      field("map", map_text(status)),          field("scan", scan_text(status.head)),
      field("slam", slam_text(status.slam)),
  };
  if (report.fix.is_home_replaced) {
    lines.push_back(field("datum", replaced_home(report.fix)));
  }
  for (std::string& line : devices_text(status)) {
    lines.push_back(std::move(line));
  }
  if (const auto& attitude = status.head.attitude) {
    lines.push_back(field("levelled by", "roll " + decimal_text(attitude->roll_rad / core::kDegree, 2) +
                                             " deg, pitch " +
                                             decimal_text(attitude->pitch_rad / core::kDegree, 2) + " deg"));
  }
  lines.push_back(field("latency", decimal_text(1e3 * status.head.latency_s, 3) + " ms, 1 sigma " +
                                       decimal_text(1e3 * status.head.latency_sigma_s, 3) + " ms"));
  lines.push_back(field("first fix", report.time_to_first_fix
                                         ? seconds(*report.time_to_first_fix) + " after start"
                                         : "not yet"));
  lines.push_back(field("uptime", seconds(report.uptime)));
  lines.push_back(field("source", to_string(report.source)));
  lines.push_back(field("real time", status.realtime ? "yes" : "no: the log says what is missing"));
  lines.push_back(field("recording", status.recording ? "yes" : "no"));
  return lines;
}

std::vector<std::string> fix_text(const SensorStatus& status) {
  const core::Fix& fix = status.report.fix;
  std::vector<std::string> lines = {
      field("status", to_string(fix.status)),
      field("reason", to_string(fix.reason)),
  };
  if (has_pose(fix)) {
    append_pose(lines, fix);
  }
  lines.push_back(field("landmarks", std::to_string(fix.matches) + " of " +
                                         std::to_string(fix.landmarks_seen) + " matched, " +
                                         std::to_string(fix.landmarks_in_map) + " in the map"));
  lines.push_back(field("false alarms", decimal_text(fix.expected_false_alarms, 9) + " expected"));
  lines.push_back(field("search", to_string(fix.search_end)));
  lines.push_back(field("scan", std::to_string(fix.scan)));
  lines.push_back(field("jumps", std::to_string(fix.jumps)));
  return lines;
}

std::vector<std::string> devices_text(const SensorStatus& status) {
  std::vector<std::string> lines;
  for (const NamedDevice& device : devices_of(status)) {
    lines.push_back(field(device.title, device_text(*device.status)));
  }
  return lines;
}

std::vector<std::string> counters_text(const SensorStatus& status) {
  std::vector<std::string> lines;
  for (const NamedCounters& station : counters_of(status)) {
    for (const hal::Counter& counter : station.table->all()) {
      lines.push_back(std::string(station.key) + '.' + std::string(counter.name) + ' ' +
                      std::to_string(counter.value));
    }
  }
  return lines;
}

}  // namespace slamsensor::firmware
