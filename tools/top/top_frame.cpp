#include "tools/top/top_frame.hpp"

#include "core/config.hpp"
#include "core/fix.hpp"
#include "firmware/status/status_text.hpp"
#include "tools/output/text_output.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <numbers>
#include <string_view>

namespace slamsensor::tools {

void SensorView::restart_if_new(std::int64_t initialization) {
  if (initialization_ == initialization) {
    return;
  }
  initialization_ = initialization;
  pose_.reset();
  status_.reset();
  counters_ = {};
  map_.clear();
  path_W_.clear();
}

void SensorView::on_pose(const firmware::PoseMessage& pose, hal::Stamp now) {
  pose_ = pose;
  pose_time_ = now;
  const core::Pose2 pose_W{pose.x_m, pose.y_m, pose.heading_rad};
  const bool is_finite = std::isfinite(pose_W.x_m) && std::isfinite(pose_W.y_m);
  if (static_cast<core::FixStatus>(pose.status) != core::FixStatus::Fix || !is_finite) {
    return;
  }
  if (path_W_.size() == kPathMax) {
    path_W_.pop_front();
  }
  path_W_.push_back(pose_W);
}

void SensorView::on_counters(const firmware::CountersMessage& message, hal::Stamp now) {
  std::vector<Counter>& counters = counters_[static_cast<std::size_t>(message.station)];
  const std::size_t first = static_cast<std::size_t>(message.part) * firmware::kLcmCounters;
  const std::size_t end = first + static_cast<std::size_t>(message.count);
  if (counters.size() < end || message.part + 1 == message.parts) {
    counters.resize(end);
  }
  for (std::size_t i = first; i < end; ++i) {
    const std::string_view name = firmware::text_of(message.name[i - first]);
    const std::int64_t value = message.value[i - first];
    Counter& counter = counters[i];
    if (counter.name == name && value != counter.value) {
      counter.changed = now;
    }
    counter.name = name;
    counter.value = value;
  }
}

void SensorView::on_map(const firmware::MapMessage& message) {
  map_.erase(map_.lower_bound(message.chunks), map_.end());
  if (message.chunk >= kMapChunksMax) {
    return;
  }
  std::vector<Landmark>& landmarks = map_[message.chunk];
  landmarks.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.count); ++i) {
    if (std::isfinite(message.x_m[i]) && std::isfinite(message.y_m[i])) {
      landmarks.push_back({{message.x_m[i], message.y_m[i]}, message.xi[i]});
    }
  }
}

void SensorView::on_message(const LcmMessageView& message, hal::Stamp now) {
  if (!message.channel.starts_with(prefix_)) {
    return;
  }
  if (const auto pose = firmware::decode_lcm<firmware::PoseMessage>(message.bytes)) {
    restart_if_new(pose->initialization);
    on_pose(*pose, now);
  } else if (const auto status = firmware::decode_lcm<firmware::StatusMessage>(message.bytes)) {
    restart_if_new(status->initialization);
    status_ = *status;
  } else if (const auto counters = firmware::decode_lcm<firmware::CountersMessage>(message.bytes)) {
    restart_if_new(counters->initialization);
    on_counters(*counters, now);
  } else if (const auto map = firmware::decode_lcm<firmware::MapMessage>(message.bytes)) {
    restart_if_new(map->initialization);
    on_map(*map);
  } else {
    return;
  }
  heard_ = now;
}

namespace {

std::string line_of(const char* channel, const std::string& type, const ChannelRecord& record,
                    const ChannelTable::Rate& rate, hal::Stamp now) {
  char text[256];
  std::snprintf(text, sizeof text, "%-24s %-24s %8s %9s %9s %10s", channel, type.c_str(),
                fixed_text(rate.messages_hz, 1).c_str(), amount_text(rate.bytes_per_s).c_str(),
                std::to_string(record.messages).c_str(), duration_text(now - record.last).c_str());
  return text;
}

std::string dump_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes.first(std::min<std::size_t>(bytes.size(), 24))) {
    char two[4];
    std::snprintf(two, sizeof two, "%02x ", byte);
    text += two;
  }
  return text + (bytes.size() > 24 ? "..." : "");
}

/// A line per LCM channel heard: name, type, rate, bandwidth, messages, time since the last, with number
/// `selected` marked; a heading above.
TextLines channel_lines(const ChannelTable& table, std::size_t selected, hal::Stamp now) {
  char heading[128];
  std::snprintf(heading, sizeof heading, "%-24s %-24s %8s %9s %9s %10s", "channel", "type", "per s",
                "bytes/s", "messages", "last");
  TextLines lines = {{heading, CellStyle::Bold}};
  std::size_t number = 0;
  for (const auto& [name, record] : table.channels()) {
    lines.push_back(
        {line_of(name.c_str(), lcm_type_text(record.last_message), record, table.rate(name, now), now),
         number++ == selected ? CellStyle::Inverse : CellStyle::Plain});
  }
  if (table.channels().empty()) {
    lines.push_back({"nothing heard yet", CellStyle::Dim});
  }
  if (table.left_out() > 0) {
    lines.push_back(
        {"more channels than are shown: " + std::to_string(table.left_out()) + " messages left out",
         CellStyle::Warning});
  }
  return lines;
}

/// The last message of channel number `selected`: its members when its type is known.
TextLines message_lines(const ChannelTable& table, std::size_t selected) {
  if (selected >= table.channels().size()) {
    return {};
  }
  const auto& [name, record] = *std::next(table.channels().begin(), static_cast<std::ptrdiff_t>(selected));
  TextLines lines = {
      {name + ": " + lcm_type_text(record.last_message) + ", " + std::to_string(record.last_bytes) + " bytes",
       CellStyle::Bold}};
  for (std::string& line : lcm_message_lines(record.last_message)) {
    lines.push_back({"  " + std::move(line)});
  }
  if (lines.size() == 1) {
    lines.push_back({"  " + dump_of(record.last_message)});
  }
  return lines;
}

constexpr double kCellAspect = 2.0;  ///< height of a cell over its width
constexpr double kSmallestSpan_m = 2.0;
// Beyond this nothing on the map can be distinguished, and arithmetic with it is not safe.
constexpr double kFarthest_m = 1e7;

/// The smallest upright rectangle around points.
struct Bounds {
  double x_min = std::numeric_limits<double>::infinity();
  double x_max = -std::numeric_limits<double>::infinity();
  double y_min = std::numeric_limits<double>::infinity();
  double y_max = -std::numeric_limits<double>::infinity();

  void add(double x_m, double y_m) {
    if (std::abs(x_m) < kFarthest_m && std::abs(y_m) < kFarthest_m) {
      x_min = std::min(x_min, x_m);
      x_max = std::max(x_max, x_m);
      y_min = std::min(y_min, y_m);
      y_max = std::max(y_max, y_m);
    }
  }
  [[nodiscard]] bool empty() const { return x_min > x_max; }
};

Bounds bounds_of(const SensorView& view) {
  Bounds bounds;
  for (const auto& [chunk, landmarks] : view.map()) {
    for (const SensorView::Landmark& landmark : landmarks) {
      bounds.add(landmark.position_W.x(), landmark.position_W.y());
    }
  }
  for (const core::Pose2& pose : view.path_W()) {
    bounds.add(pose.x_m, pose.y_m);
  }
  return bounds;
}

/// From metres to cells, the middle of the bounds in the middle of the box.
class Projection {
 public:
  Projection(const Bounds& bounds, const CanvasBox& box) : box_(box) {
    const double wide_m = std::max(kSmallestSpan_m, bounds.x_max - bounds.x_min);
    const double high_m = std::max(kSmallestSpan_m, bounds.y_max - bounds.y_min);
    metres_per_column_ = std::max(wide_m / (box.width - 1), high_m / kCellAspect / (box.height - 1));
    x_m_ = (bounds.x_min + bounds.x_max) / 2.0;
    y_m_ = (bounds.y_min + bounds.y_max) / 2.0;
  }

  void put(Canvas& canvas, double x_m, double y_m, std::string_view mark, CellStyle style) const {
    const double column = (x_m - x_m_) / metres_per_column_ + (box_.width - 1) / 2.0;
    const double row = (y_m_ - y_m) / (metres_per_column_ * kCellAspect) + (box_.height - 1) / 2.0;
    if (column > -0.5 && column < box_.width - 0.5 && row > -0.5 && row < box_.height - 0.5) {
      canvas.put(box_.x + static_cast<int>(std::lround(column)), box_.y + static_cast<int>(std::lround(row)),
                 mark, style);
    }
  }

  [[nodiscard]] double width_m() const { return metres_per_column_ * box_.width; }

 private:
  CanvasBox box_;
  double metres_per_column_ = 1.0;
  double x_m_ = 0.0;
  double y_m_ = 0.0;
};

std::string_view arrow_of(double heading_rad) {
  constexpr std::array<std::string_view, 4> kArrows = {">", "^", "<", "v"};
  if (!std::isfinite(heading_rad)) {
    return "?";
  }
  const double quarter = std::floor(core::wrap_angle(heading_rad) / (std::numbers::pi / 2.0) + 0.5);
  return kArrows[static_cast<std::size_t>(static_cast<int>(quarter) + 4) % 4];
}

void draw_marks(const SensorView& view, const Projection& projection, Canvas& canvas) {
  for (const auto& [chunk, landmarks] : view.map()) {
    for (const SensorView::Landmark& landmark : landmarks) {
      projection.put(canvas, landmark.position_W.x(), landmark.position_W.y(), ".", CellStyle::Plain);
    }
  }
  for (const core::Pose2& pose : view.path_W()) {
    projection.put(canvas, pose.x_m, pose.y_m, "+", CellStyle::Dim);
  }
  if (!view.path_W().empty()) {
    const core::Pose2& last = view.path_W().back();
    projection.put(canvas, last.x_m, last.y_m, arrow_of(last.heading_rad), CellStyle::Good);
  }
}

/// Draws the map of `view` into `box`, x to the right and y up, as large as it fits with equal axes (a cell
/// is twice as high as wide): '.' landmarks, '+' the path, an arrow '>', '^', '<' or 'v' the last fix by its
/// heading. The last row shows the width in m. Nothing in boxes of fewer than 8 by 4 cells.
void draw_map_sketch(const SensorView& view, const CanvasBox& box, Canvas& canvas) {
  if (box.width < 8 || box.height < 4) {
    return;
  }
  const Bounds bounds = bounds_of(view);
  if (bounds.empty()) {
    canvas.put(box.x, box.y, "no map yet", CellStyle::Dim);
    return;
  }
  const CanvasBox field{box.x, box.y, box.width, box.height - 1};
  const Projection projection(bounds, field);
  draw_marks(view, projection, canvas);
  canvas.put(box.x, box.y + box.height - 1, "|- " + fixed_text(projection.width_m(), 1) + " m wide -|",
             CellStyle::Dim);
}

using firmware::PoseMessage;
using firmware::StatusMessage;

using core::kDegree;
constexpr std::array<std::string_view, 2> kDeviceNames = {"pan-tilt   ", "rangefinder"};

std::string duration(std::int64_t ns) {
  return duration_text(hal::Stamp(ns));
}

std::string count(std::int64_t number, std::string_view one, std::string_view many) {
  return std::to_string(number) + ' ' + std::string(number == 1 ? one : many);
}

CellStyle style_of(firmware::SensorState state) {
  using enum firmware::SensorState;
  if (state == Fixed) {
    return CellStyle::Good;
  }
  return state == Faulted || state == Lost ? CellStyle::Bad : CellStyle::Warning;
}

void add_state(const StatusMessage& status, TextLines& lines) {
  const auto state = static_cast<firmware::SensorState>(status.state);
  std::string text = "state        " + std::string(firmware::to_string(state));
  if (static_cast<firmware::SourceMode>(status.source) == firmware::SourceMode::Emulated) {
    text += " (emulated)";
  }
  lines.push_back({text, style_of(state)});
  const bool fixed_once = status.time_to_first_fix_ns >= 0;
  lines.push_back(
      {"up           " + duration(status.uptime_ns) +
       (fixed_once ? ", first fix after " + duration(status.time_to_first_fix_ns) : ", no fix yet")});
}

std::string sigma_text(const std::array<double, 9>& covariance) {
  const double position_m = std::sqrt(covariance[0] + covariance[4]);
  const double heading_deg = std::sqrt(covariance[8]) / kDegree;
  return fixed_text(position_m, 3) + " m, " + fixed_text(heading_deg, 3) + " deg";
}

void add_place(const PoseMessage& pose, TextLines& lines) {
  const double turned_deg = core::wrap_angle(pose.heading_rad) / kDegree;
  const double heading_deg = turned_deg < 0.0 ? turned_deg + 360.0 : turned_deg;
  lines.push_back(
      {"  in map     " + std::to_string(pose.map) + (pose.map == pose.home ? ", home" : ", local")});
  lines.push_back(
      {"  x y        " + fixed_text(pose.x_m, 3) + " m, " + fixed_text(pose.y_m, 3) + " m", CellStyle::Bold});
  lines.push_back({"  heading    " + fixed_text(heading_deg, 2) + " deg", CellStyle::Bold});
  lines.push_back(
      {"  1 sigma    " + sigma_text(pose.covariance) + "; near " + sigma_text(pose.covariance_near)});
  lines.push_back({"  protection " + fixed_text(pose.protection_radius_m, 3) + " m"});
}

void add_pose(const SensorView& view, hal::Stamp now, TextLines& lines) {
  const PoseMessage& pose = *view.pose();
  const auto status = static_cast<core::FixStatus>(pose.status);
  const auto reason = static_cast<core::FixReason>(pose.reason);
  std::string text = "fix          " + std::string(core::to_string(status));
  if (reason != core::FixReason::None) {
    text += " (" + std::string(core::to_string(reason)) + ')';
  }
  text += ", scan " + std::to_string(pose.scan) + ", " + duration_text(now - view.pose_time()) + " ago";
  lines.push_back({text, status == core::FixStatus::Fix ? CellStyle::Good : CellStyle::Warning});
  if (core::has_pose(firmware::fix_of(pose))) {
    add_place(pose, lines);
  }
  std::string alarms;
  append_general(alarms, pose.expected_false_alarms, 3);
  lines.push_back({"  matches    " + std::to_string(pose.matches) + " of " +
                   std::to_string(pose.landmarks_seen) + " seen, expected false alarms " + alarms});
  lines.push_back({"  xi " + std::to_string(pose.error_xi) + ", W " + std::to_string(pose.weight_best) +
                   " over " + std::to_string(pose.weight_runner_up) + ", " +
                   count(pose.jumps, "jump", "jumps") + ", search " +
                   std::string(core::to_string(static_cast<core::SearchEnd>(pose.search_end)))});
}

void add_device(const StatusMessage& status, std::size_t i, TextLines& lines) {
  const auto state = static_cast<hal::DeviceState>(status.device_state[i]);
  std::string text = std::string(kDeviceNames[i]) + "  " + std::string(firmware::to_string(state));
  if (const auto model = firmware::text_of(status.device_model[i]); !model.empty()) {
    text += ", " + std::string(model);
  }
  if (status.device_recoveries[i] > 0) {
    text += ", back " + count(status.device_recoveries[i], "time", "times") + ", last in " +
            duration(status.device_last_recovery_ns[i]);
  }
  lines.push_back({text, state == hal::DeviceState::Ready ? CellStyle::Plain : CellStyle::Bad});
  if (const auto problem = firmware::text_of(status.device_problem[i]); !problem.empty()) {
    lines.push_back({"  " + std::string(problem), CellStyle::Warning});
  }
}

void add_head(const StatusMessage& status, TextLines& lines) {
  lines.push_back({"head         " + std::string(firmware::text_of(status.phase)) +
                   (status.held ? ", held" : "") + ", scan " + std::to_string(status.scan) + ", line " +
                   std::to_string(status.line) + " of " + std::to_string(status.lines)});
  if (const auto problem = firmware::text_of(status.problem); !problem.empty()) {
    lines.push_back({"  " + std::string(problem), CellStyle::Warning});
  }
  lines.push_back({"  pan tilt   " + fixed_text(status.pan_rad / kDegree, 2) + " deg, " +
                   fixed_text(status.tilt_rad / kDegree, 2) + " deg"});
  lines.push_back({"  readings   " + amount_text(status.readings_hz) + "/s, " +
                   amount_text(static_cast<double>(status.readings)) + " in all"});
  lines.push_back({"  latency    " + fixed_text(status.latency_s * 1e3, 2) + " ms +- " +
                   fixed_text(status.latency_sigma_s * 1e3, 2) + ", worst wake-up " +
                   duration(status.wake_latency_max_ns) + (status.realtime ? "" : ", not real-time")});
  for (std::size_t i = 0; i < firmware::kLcmDevices; ++i) {
    add_device(status, i, lines);
  }
}

void add_slam(const StatusMessage& status, TextLines& lines) {
  lines.push_back({"slam         " + count(status.fixes, "fix", "fixes") + " of " +
                   count(status.scans, "scan", "scans") + ", " +
                   count(status.hypotheses, "hypothesis", "hypotheses")});
  lines.push_back(
      {"  to the fix " + duration(status.process_last_ns) + ", worst " + duration(status.process_max_ns)});
  lines.push_back({"map          " + std::string(firmware::text_of(status.map_name)) + ", " +
                   count(status.landmarks, "landmark", "landmarks") + ", revision " +
                   std::to_string(status.map_revision) + (status.map_frozen ? ", frozen" : "")});
  if (status.local_maps > 0) {
    lines.push_back({"  and        " + count(status.local_maps, "local map", "local maps") + " with " +
                     count(status.local_landmarks, "landmark", "landmarks")});
  }
  const bool was_saved = status.map_saved_ago_ns >= 0;
  lines.push_back({"  " +
                       (was_saved ? "saved " + duration(status.map_saved_ago_ns) + " ago" : "never saved") +
                       (status.map_unsaved ? ", changed since" : ""),
                   status.map_unsaved && !was_saved ? CellStyle::Warning : CellStyle::Plain});
  if (status.recording) {
    lines.push_back({"recording", CellStyle::Good});
  }
}

/// State, fix, sensor head, devices, SLAM and map of `view` as lines for a person.
TextLines sensor_lines(const SensorView& view, hal::Stamp now) {
  TextLines lines;
  if (view.status()) {
    add_state(*view.status(), lines);
  } else {
    lines.push_back({"state        no status heard yet", CellStyle::Warning});
  }
  if (view.pose()) {
    add_pose(view, now, lines);
  } else {
    lines.push_back({"fix          none heard yet", CellStyle::Warning});
  }
  if (view.status()) {
    add_head(*view.status(), lines);
    add_slam(*view.status(), lines);
  }
  return lines;
}

/// Every counter that is not 0, by station, those that grew within the last 10 s marked; how many are 0.
TextLines counter_lines(const SensorView& view, hal::Stamp now) {
  constexpr hal::Stamp kRecent = std::chrono::seconds(10);
  TextLines lines;
  for (std::size_t station = 0; station < firmware::kLcmStationNames.size(); ++station) {
    const auto& counters = view.counters(static_cast<firmware::LcmStation>(station));
    const auto zeros =
        std::count_if(counters.begin(), counters.end(), [](const auto& c) { return c.value == 0; });
    lines.push_back({std::string(firmware::kLcmStationNames.at(station)) + "  (" +
                         std::to_string(counters.size()) + " counters, " + std::to_string(zeros) + " at 0)",
                     CellStyle::Bold});
    for (const SensorView::Counter& counter : counters) {
      if (counter.value != 0) {
        const bool is_recent = counter.changed != hal::Stamp::min() && now - counter.changed <= kRecent;
        std::string text = "  " + counter.name;
        text.resize(std::max<std::size_t>(text.size() + 1, 44), ' ');
        lines.push_back({text + std::to_string(counter.value) + (is_recent ? "  growing" : ""),
                         is_recent ? CellStyle::Warning : CellStyle::Plain});
      }
    }
  }
  return lines;
}

constexpr int kTextWidth = 64;    // of the sensor's lines, beside a map
constexpr int kMapWidthMin = 24;  // narrower maps go below the text
constexpr int kPageTop = 2;

void draw_heading(const TopState& state, Canvas& canvas) {
  constexpr std::array<std::string_view, 3> kPages = {" 1 sensor ", " 2 counters ", " 3 channels "};
  canvas.put(0, 0, std::string(static_cast<std::size_t>(canvas.width()), ' '), CellStyle::Inverse);
  canvas.put(1, 0, "slamsensor top", CellStyle::Inverse);
  int x = 18;
  for (std::size_t i = 0; i < kPages.size(); ++i) {
    const bool is_chosen = static_cast<std::size_t>(state.choice.page) == i;
    canvas.put(x, 0, kPages.at(i), is_chosen ? CellStyle::Bold : CellStyle::Inverse);
    x += static_cast<int>(kPages.at(i).size());
  }
  canvas.put(x + 2, 0, "q quit", CellStyle::Inverse);
}

TextLine situation(const TopState& state, hal::Stamp now) {
  if (!state.problem.empty()) {
    return {state.problem, CellStyle::Bad};
  }
  if (!state.sensor.heard()) {
    return {"nothing heard from a sensor on " + state.sensor.prefix() + "* for " +
                duration_text(now - state.started) + "; is it running, and LCM enabled?",
            CellStyle::Warning};
  }
  const hal::Stamp silence = now - *state.sensor.heard();
  if (silence >= kSilentAfter) {
    return {"sensor silent for " + duration_text(silence) + "; what follows is old", CellStyle::Bad};
  }
  std::string text = "listening to " + state.sensor.prefix() + "*";
  if (state.refused + state.dropped > 0) {
    text += ", " + std::to_string(state.refused) + " foreign datagrams, " + std::to_string(state.dropped) +
            " messages in pieces lost";
  }
  return {text, CellStyle::Dim};
}

void draw_sensor(const TopState& state, hal::Stamp now, Canvas& canvas) {
  const TextLines lines = sensor_lines(state.sensor, now);
  const int left = canvas.height() - kPageTop;
  if (canvas.width() >= kTextWidth + 1 + kMapWidthMin) {
    put_lines(canvas, {0, kPageTop, kTextWidth, left}, lines);
    draw_map_sketch(state.sensor, {kTextWidth + 1, kPageTop, canvas.width() - kTextWidth - 1, left}, canvas);
    return;
  }
  const int below = put_lines(canvas, {0, kPageTop, canvas.width(), left}, lines);
  draw_map_sketch(state.sensor, {0, below, canvas.width(), canvas.height() - below}, canvas);
}

void draw_counters(const TopState& state, hal::Stamp now, Canvas& canvas) {
  TextLines lines = counter_lines(state.sensor, now);
  const int hidden = std::clamp(state.choice.first_line, 0, std::max(0, static_cast<int>(lines.size()) - 1));
  lines.erase(lines.begin(), lines.begin() + hidden);
  put_lines(canvas, {0, kPageTop, canvas.width(), canvas.height() - kPageTop}, lines);
}

void draw_channels(const TopState& state, hal::Stamp now, Canvas& canvas) {
  const std::size_t selected =
      std::min(state.choice.channel, std::max<std::size_t>(state.channels.channels().size(), 1) - 1);
  TextLines lines = channel_lines(state.channels, selected, now);
  // The heading stays; the list is scrolled so that the selected channel is within its half of the screen.
  const int rows = std::max(2, (canvas.height() - kPageTop) / 2);
  const int hidden = std::max(0, static_cast<int>(selected) + 2 - rows);
  lines.erase(lines.begin() + 1, lines.begin() + 1 + hidden);
  const int below = put_lines(canvas, {0, kPageTop, canvas.width(), rows}, lines);
  put_lines(canvas, {0, below + 1, canvas.width(), canvas.height() - below - 1},
            message_lines(state.channels, selected));
}

}  // namespace

void TopState::on_message(const LcmMessageView& message, hal::Stamp now) {
  channels.add(message, now);
  sensor.on_message(message, now);
}

Canvas draw_frame(const TopState& state, int width, int height, hal::Stamp now) {
  Canvas canvas(width, height);
  draw_heading(state, canvas);
  put_lines(canvas, {0, 1, canvas.width(), 1}, {situation(state, now)});
  switch (state.choice.page) {
    case TopPage::Sensor:
      draw_sensor(state, now, canvas);
      break;
    case TopPage::Counters:
      draw_counters(state, now, canvas);
      break;
    case TopPage::Channels:
      draw_channels(state, now, canvas);
      break;
  }
  return canvas;
}

}  // namespace slamsensor::tools
