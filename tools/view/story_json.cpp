#include "tools/view/story_json.hpp"

#include "core/fix.hpp"
#include "firmware/output/nmea.hpp"
#include "firmware/status/status_text.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace slamsensor::tools {
namespace {

using Json = nlohmann::json;

constexpr double kSecond_us = 1e6;
constexpr double kSecond_ns = 1e9;

/// Millimetres are enough for a picture, and short.
Json metres(double value_m) {
  return std::isfinite(value_m) ? Json(std::round(value_m * 1e3) / 1e3) : Json();
}

/// JSON has no NaN.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

template <std::size_t kSize>
std::string text(const firmware::LcmText<kSize>& bytes) {
  std::string out(firmware::text_of(bytes));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');  // JSON is UTF-8
  return out;
}

Json points(const std::vector<core::Point2>& list) {
  Json out = Json::array();
  for (const core::Point2& point : list) {
    out.push_back(metres(point.x()));
    out.push_back(metres(point.y()));
  }
  return out;
}

/// What has passed since the end of the scan: before the pose was sent, and since then.
double since_scan_s(const firmware::PoseMessage& pose, std::int64_t came_us, std::int64_t now_us) {
  const auto before_ns = static_cast<double>(pose.report_monotonic_ns - pose.scan_end_monotonic_ns);
  return before_ns / kSecond_ns + static_cast<double>(now_us - came_us) / kSecond_us;
}

/// From the middle of the scan, of which the pose is, to its end.
double half_scan_s(const firmware::PoseMessage& pose) {
  return static_cast<double>(pose.scan_end_utc_ns - pose.scan_middle_utc_ns) / kSecond_ns;
}

Json datum_json(const SensorStory& story) {
  const auto& datum = story.datum();
  if (!datum) {
    return {};
  }
  const bool is_guess = story.datum_source() == DatumSource::Configuration;
  return {{"latitude", datum->latitude_deg},
          {"longitude", datum->longitude_deg},
          {"height", datum->height_m},
          {"bearing", datum->bearing_deg},
          {"of_configuration", is_guess}};
}

Json pose_json(const firmware::PoseMessage& pose) {
  const core::Fix fix = firmware::fix_of(pose);
  Json out = {{"status", core::to_string(fix.status)},
              {"reason", core::to_string(fix.reason)},
              {"words", firmware::fix_phrase(fix)},
              {"has_pose", core::has_pose(fix)},
              {"scan", pose.scan},
              {"map", pose.map},
              {"home", pose.home},
              {"xi", pose.error_xi},
              {"matches", pose.matches},
              {"seen", pose.landmarks_seen},
              {"in_map", pose.landmarks_in_map},
              {"false_alarms", number(pose.expected_false_alarms)},
              {"weight_best", pose.weight_best},
              {"weight_runner_up", pose.weight_runner_up},
              {"jumps", pose.jumps},
              {"search", core::to_string(fix.search_end)},
              {"emulated", pose.source != 0},
              {"uptime_s", static_cast<double>(pose.uptime_ns) / kSecond_ns}};
  out["first_fix_s"] = pose.time_to_first_fix_ns < 0
                           ? Json()
                           : Json(static_cast<double>(pose.time_to_first_fix_ns) / kSecond_ns);
  if (core::has_pose(fix)) {
    out["x"] = number(pose.x_m);
    out["y"] = number(pose.y_m);
    out["heading"] = number(pose.heading_rad);
    // xx, xy, yy of the position, and of the heading, in the map and relative to the landmarks about.
    out["cov"] = {number(pose.covariance[0]), number(pose.covariance[1]), number(pose.covariance[4])};
    out["cov_heading"] = number(pose.covariance[8]);
    out["near"] = {number(pose.covariance_near[0]), number(pose.covariance_near[1]),
                   number(pose.covariance_near[4])};
    out["protection"] = number(pose.protection_radius_m);
  }
  return out;
}

/// Where on the earth a fix is, as NMEA tells it.
void add_place(const firmware::PoseMessage& pose, const firmware::Datum& datum, Json& out) {
  if (static_cast<core::FixStatus>(pose.status) != core::FixStatus::Fix) {
    return;
  }
  const firmware::GeoPose place =
      firmware::GeoReference(datum).locate({pose.x_m, pose.y_m, pose.heading_rad});
  out["latitude"] = number(place.latitude_deg);
  out["longitude"] = number(place.longitude_deg);
  out["true_heading_deg"] = number(place.true_heading_deg);
}

Json device_json(const firmware::StatusMessage& status, std::size_t i) {
  return {{"name", i == 0 ? "Pan-tilt unit" : "Rangefinder"},
          {"state", firmware::to_string(static_cast<hal::DeviceState>(status.device_state[i]))},
          {"problem", text(status.device_problem[i])},
          {"model", text(status.device_model[i])},
          {"recoveries", status.device_recoveries[i]}};
}

Json status_json(const firmware::StatusMessage& status) {
  const auto seconds = [](std::int64_t ns) { return static_cast<double>(ns) / kSecond_ns; };
  const auto state = static_cast<std::size_t>(status.state);
  return {{"state", firmware::kSensorStateNames.at(state)},
          {"phase", text(status.phase)},
          {"problem", text(status.problem)},
          {"held", status.held},
          {"realtime", status.realtime},
          {"recording", status.recording},
          {"frozen", status.map_frozen},
          {"unsaved", status.map_unsaved},
          {"devices", {device_json(status, 0), device_json(status, 1)}},
          {"line", status.line},
          {"lines", status.lines},
          {"pan", number(status.pan_rad)},
          {"tilt", number(status.tilt_rad)},
          {"latency_s", number(status.latency_s)},
          {"readings_hz", number(status.readings_hz)},
          {"wake_max_s", seconds(status.wake_latency_max_ns)},
          {"scans", status.scans},
          {"fixes", status.fixes},
          {"landmarks", status.landmarks},
          {"hypotheses", status.hypotheses},
          {"local_maps", status.local_maps},
          {"local_landmarks", status.local_landmarks},
          {"process_last_s", seconds(status.process_last_ns)},
          {"process_max_s", seconds(status.process_max_ns)},
          {"map_name", text(status.map_name)},
          {"saved_ago_s", status.map_saved_ago_ns < 0 ? Json() : Json(seconds(status.map_saved_ago_ns))}};
}

/// None of them: null. A place that is no number is left out.
Json rivals_json(const firmware::RivalsMessage* rivals) {
  Json out;
  for (std::size_t i = 0; rivals != nullptr && i < static_cast<std::size_t>(rivals->count); ++i) {
    if (std::isfinite(rivals->x_m[i]) && std::isfinite(rivals->y_m[i]) &&
        std::isfinite(rivals->heading_rad[i])) {
      out.push_back({{"x", metres(rivals->x_m[i])},
                     {"y", metres(rivals->y_m[i])},
                     {"heading", rivals->heading_rad[i]},
                     {"matches", rivals->matches[i]}});
    }
  }
  return out;
}

Json counters_json(const SensorStory& story) {
  Json out = Json::object();
  for (std::size_t i = 0; i < firmware::kLcmStationNames.size(); ++i) {
    for (const auto& [name, value] : story.counters()[i]) {
      if (value != 0) {
        out[std::string(firmware::kLcmStationNames[i])][name] = value;
      }
    }
  }
  return out;
}

/// An array per property: a third of the bytes of an object per landmark.
Json chunk_json(const StoryChunk& chunk) {
  Json out;
  for (const char* const property : {"x", "y", "id", "xi", "sightings", "sigma"}) {
    out[property] = Json::array();
  }
  for (const StoryLandmark& landmark : chunk.landmarks) {
    out["x"].push_back(metres(landmark.position_W.x()));
    out["y"].push_back(metres(landmark.position_W.y()));
    out["id"].push_back(landmark.id);
    out["xi"].push_back(landmark.xi);
    out["sightings"].push_back(landmark.sightings);
    out["sigma"].push_back(metres(landmark.sigma_m));
  }
  return out;
}

void add_map(const SensorStory& story, StoryCursor& cursor, Json& out) {
  if (cursor.map_version == story.map_version()) {
    return;
  }
  Json set = Json::object();
  for (const auto& [number, chunk] : story.map()) {
    if (!cursor.map_version || chunk.version > *cursor.map_version) {
      set[std::to_string(number)] = chunk_json(chunk);
    }
  }
  const std::int32_t count = story.map().empty() ? 0 : story.map().rbegin()->first + 1;
  out["map"] = {{"chunks", count}, {"set", std::move(set)}};
  cursor.map_version = story.map_version();
}

/// Adds the member when it is another than the one told last.
void add_changed(const char* name, Json value, StoryCursor& cursor, Json& out) {
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string& told = cursor.told[name];
  if (told != text) {
    told = std::move(text);
    out[name] = std::move(value);
  }
}

Json local_maps_json(const SensorStory& story) {
  Json out = Json::object();
  for (const auto& [number_of_map, local] : story.local_maps()) {
    Json path = Json::array();
    for (const core::Pose2& pose : local.path_W) {
      path.push_back(metres(pose.x_m));
      path.push_back(metres(pose.y_m));
    }
    out[std::to_string(number_of_map)] = {{"points", points(local.landmarks_W)}, {"path", std::move(path)}};
  }
  return out;
}

void add_path(const SensorStory& story, StoryCursor& cursor, Json& out) {
  const StoryList<StoryFix>& path = story.path_W();
  const bool is_new = cursor.path_epoch != path.epoch || cursor.path < path.begin;
  const std::uint64_t from = is_new ? path.begin : cursor.path;
  Json list = Json::array();
  for (std::uint64_t i = from; i < path.end(); ++i) {
    const StoryFix& fix = path.items[i - path.begin];
    if (!fix.follows && i > path.begin) {
      list.insert(list.end(), {Json(), Json()});  // the line is broken here
    }
    list.push_back(metres(fix.pose_W.x_m));
    list.push_back(metres(fix.pose_W.y_m));
  }
  out["path"] = {{"restart", is_new}, {"add", std::move(list)}};
  cursor.path = path.end();
  cursor.path_epoch = path.epoch;
}

void add_events(const SensorStory& story, StoryCursor& cursor, Json& out) {
  const StoryList<StoryEvent>& events = story.events();
  Json list = Json::array();
  for (std::uint64_t i = std::max(cursor.events, events.begin); i < events.end(); ++i) {
    list.push_back(event_json(events.items[i - events.begin]));
  }
  out["events"] = std::move(list);
  cursor.events = events.end();
}

}  // namespace

Json event_json(const StoryEvent& event) {
  const char* const tone = event.tone == StoryTone::Good ? "good" : event.tone == StoryTone::Bad ? "bad" : "";
  return {{"t", static_cast<double>(event.utime_us) / kSecond_us}, {"tone", tone}, {"text", event.text}};
}

Json story_json(const SensorStory& story, std::int64_t now_us, StoryCursor& cursor) {
  Json out = {{"now", static_cast<double>(now_us) / kSecond_us}};
  if (const auto heard = story.heard_utime_us()) {
    out["heard_s"] = static_cast<double>(now_us - *heard) / kSecond_us;
  }
  Json pose;
  if (const auto& last = story.pose()) {
    pose = pose_json(*last);
    if (story.datum()) {
      add_place(*last, *story.datum(), pose);
    }
    if (last->scan_end_monotonic_ns != 0) {  // else no scan was made
      const double since_s = since_scan_s(*last, story.pose_utime_us(), now_us);
      out["since_scan_s"] = number(since_s);
      out["age_s"] = number(since_s + half_scan_s(*last));
    }
  }
  Json scan;
  if (const auto number_of_scan = story.scan_number()) {
    scan = {{"number", *number_of_scan}, {"points", points(story.scan_B())}};
  }
  add_changed("pose", std::move(pose), cursor, out);
  add_changed("status", story.status() ? status_json(*story.status()) : Json(), cursor, out);
  add_changed("datum", datum_json(story), cursor, out);
  add_changed("stale_s", story.stale_s() ? Json(*story.stale_s()) : Json(), cursor, out);
  add_changed("scan", std::move(scan), cursor, out);
  add_changed("rivals", rivals_json(story.rivals()), cursor, out);
  add_changed("counters", counters_json(story), cursor, out);
  add_changed("local_maps", local_maps_json(story), cursor, out);
  add_path(story, cursor, out);
  add_events(story, cursor, out);
  add_map(story, cursor, out);
  return out;
}

}  // namespace slamsensor::tools
