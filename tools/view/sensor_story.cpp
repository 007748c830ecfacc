#include "tools/view/sensor_story.hpp"

#include "core/fix.hpp"
#include "firmware/status/status_text.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr double kLocalCell_m = 0.7;  // landmarks of a local map nearer than this count once

bool is_finite(const core::Pose2& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.heading_rad);
}

core::Pose2 pose_of(const firmware::PoseMessage& pose) {
  return {pose.x_m, pose.y_m, pose.heading_rad};
}

core::FixStatus status_of(const firmware::PoseMessage& pose) {
  return static_cast<core::FixStatus>(pose.status);
}

std::string device_name(std::size_t device) {
  return device == 0 ? "pan-tilt unit" : "rangefinder";
}

}  // namespace

void SensorStory::tell(std::int64_t utime_us, StoryTone tone, std::string text) {
  events_.add({utime_us, tone, std::move(text)}, kEventsMax);
}

void SensorStory::restart_if_new(std::int64_t initialization, std::int64_t utime_us) {
  if (initialization_ == initialization) {
    return;
  }
  if (initialization_) {
    pose_.reset();
    status_.reset();
    counters_ = {};
    map_.clear();
    ++map_version_;
    path_W_.clear();
    local_maps_.clear();
    scan_B_.clear();
    scan_number_.reset();
    rivals_.reset();
    scan_receiving_ = scan_in_local_map_ = path_scan_ = -1;
    tell(utime_us, StoryTone::Neutral, "the sensor was started again");
  }
  initialization_ = initialization;
}

void SensorStory::tell_pose(const firmware::PoseMessage& pose, std::int64_t utime_us) {
  const bool is_first = !pose_;
  const bool is_other =
      is_first || pose.status != pose_->status || pose.reason != pose_->reason || pose.map != pose_->map;
  const core::FixStatus status = status_of(pose);
  if (is_other) {
    const StoryTone tone = status == core::FixStatus::Fix ? StoryTone::Good : StoryTone::Bad;
    const std::string phrase = firmware::fix_phrase(firmware::fix_of(pose));
    tell(utime_us, tone, (status == core::FixStatus::Fix ? "fix: " : "") + phrase);
  }
  if (!is_first && pose.jumps > pose_->jumps) {
    tell(utime_us, StoryTone::Neutral, "the best hypothesis changed: the pose may have jumped");
  }
  if (!is_first && pose.home != pose_->home && pose_->home != 0) {
    tell(utime_us, StoryTone::Neutral, "the home map is now map " + std::to_string(pose.home));
  }
}

void SensorStory::on_pose(const firmware::PoseMessage& pose, std::int64_t utime_us) {
  tell_pose(pose, utime_us);
  if (pose_ && pose.home != pose_->home) {
    path_W_.clear();
    path_scan_ = -1;
  }
  pose_ = pose;
  pose_utime_us_ = utime_us;
  if (status_of(pose) == core::FixStatus::Fix && is_finite(pose_of(pose)) && pose.scan != path_scan_) {
    path_W_.add({pose_of(pose), pose.scan == path_scan_ + 1}, kPathMax);
    path_scan_ = pose.scan;
  }
  extend_local_map();
}

void SensorStory::tell_status(const firmware::StatusMessage& status, std::int64_t utime_us) {
  const std::string_view problem = firmware::text_of(status.problem);
  if (!status_) {
    return;
  }
  if (problem != firmware::text_of(status_->problem)) {
    tell(utime_us, problem.empty() ? StoryTone::Good : StoryTone::Bad,
         problem.empty() ? std::string("the sensor head scans again") : std::string(problem));
  }
  for (std::size_t i = 0; i < firmware::kLcmDevices; ++i) {
    if (status.device_state[i] != status_->device_state[i]) {
      const auto state = static_cast<hal::DeviceState>(status.device_state[i]);
      const std::string_view why = firmware::text_of(status.device_problem[i]);
      tell(utime_us, state == hal::DeviceState::Ready ? StoryTone::Good : StoryTone::Bad,
           device_name(i) + ": " + std::string(firmware::to_string(state)) + (why.empty() ? "" : ", ") +
               std::string(why));
    }
  }
  const auto tell_switch = [&](bool now, bool before, const char* on, const char* off) {
    if (now != before) {
      tell(utime_us, StoryTone::Neutral, now ? on : off);
    }
  };
  tell_switch(status.map_frozen, status_->map_frozen, "the map is frozen", "the map may grow");
  tell_switch(status.recording, status_->recording, "recording", "the recording has ended");
  tell_switch(status.held, status_->held, "scanning is held", "scanning goes on");
  if (firmware::text_of(status.map_name) != firmware::text_of(status_->map_name)) {
    tell(utime_us, StoryTone::Neutral,
         "the map in use is '" + std::string(firmware::text_of(status.map_name)) + "'");
  }
}

void SensorStory::on_status(const firmware::StatusMessage& status, std::int64_t utime_us) {
  tell_status(status, utime_us);
  status_ = status;
  forget_tied_maps();
}

void SensorStory::on_counters(const firmware::CountersMessage& message) {
  Counters& counters = counters_[static_cast<std::size_t>(message.station)];
  const std::size_t first = static_cast<std::size_t>(message.part) * firmware::kLcmCounters;
  const std::size_t end = first + static_cast<std::size_t>(message.count);
  if (counters.size() < end || message.part + 1 == message.parts) {
    counters.resize(end);
  }
  for (std::size_t i = first; i < end; ++i) {
    counters[i] = {std::string(firmware::text_of(message.name[i - first])), message.value[i - first]};
  }
}

void SensorStory::continue_versions(std::uint64_t version) {
  map_version_ += version + 1;
  for (auto& [number, chunk] : map_) {
    chunk.version = map_version_;
  }
}

void SensorStory::set_chunk(std::int32_t number, std::vector<StoryLandmark> landmarks) {
  const auto [place, is_new] = map_.try_emplace(number);
  if (is_new || place->second.landmarks != landmarks) {
    place->second = {std::move(landmarks), map_version_ + 1};
    is_map_changed_ = true;
  }
}

void SensorStory::on_map(const firmware::MapMessage& message) {
  const auto gone = map_.lower_bound(message.chunks);
  is_map_changed_ = is_map_changed_ || gone != map_.end();
  map_.erase(gone, map_.end());
  if (message.chunk >= kMapChunksMax) {
    return;
  }
  std::vector<StoryLandmark> landmarks;
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.count); ++i) {
    if (std::isfinite(message.x_m[i]) && std::isfinite(message.y_m[i])) {
      landmarks.push_back({{message.x_m[i], message.y_m[i]},
                           message.id[i],
                           message.xi[i],
                           message.sightings[i],
                           message.last_scan[i],
                           std::isfinite(message.sigma_m[i]) ? std::max(0.0, message.sigma_m[i]) : 0.0});
    }
  }
  set_chunk(message.chunk, std::move(landmarks));
  if (message.chunk + 1 == std::min(message.chunks, kMapChunksMax) && is_map_changed_) {
    ++map_version_;  // readers get a map, not its parts
    is_map_changed_ = false;
  }
}

void SensorStory::on_map_file(const firmware::MapFile& map) {
  map_.clear();
  constexpr std::size_t kEach = firmware::kMapChunkLandmarks;
  constexpr std::size_t kMost = kEach * static_cast<std::size_t>(kMapChunksMax);
  for (std::size_t first = 0; first < std::min(map.landmarks.size(), kMost); first += kEach) {
    std::vector<StoryLandmark> landmarks;
    for (std::size_t i = first; i < std::min(map.landmarks.size(), first + kEach); ++i) {
      const core::MapLandmark& landmark = map.landmarks[i];
      landmarks.push_back({map.positions_W[i], landmark.id, static_cast<std::int32_t>(landmark.xi),
                           static_cast<std::int32_t>(landmark.sightings),
                           static_cast<std::int32_t>(landmark.last_scan),
                           static_cast<double>(landmark.sigma_m)});
    }
    set_chunk(static_cast<std::int32_t>(first / kEach), std::move(landmarks));
  }
  ++map_version_;
  is_map_changed_ = false;
  if (!datum_) {
    set_datum(map.about.datum, DatumSource::Recording);
  }
}

void SensorStory::on_scan(const firmware::ScanMessage& message) {
  if (message.scan != scan_receiving_) {
    scan_receiving_ = message.scan;
    scan_chunks_.clear();
  }
  if (message.chunk >= 100) {  // no scan has 5,000 landmarks
    return;
  }
  std::vector<core::Point2>& points = scan_chunks_[message.chunk];
  points.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.count); ++i) {
    if (std::isfinite(message.x_m[i]) && std::isfinite(message.y_m[i])) {
      points.emplace_back(message.x_m[i], message.y_m[i]);
    }
  }
  if (scan_chunks_.size() < static_cast<std::size_t>(message.chunks)) {
    return;
  }
  scan_B_.clear();
  for (const auto& [chunk, in_chunk] : scan_chunks_) {
    scan_B_.insert(scan_B_.end(), in_chunk.begin(), in_chunk.end());
  }
  scan_number_ = message.scan;
  extend_local_map();
}

const firmware::RivalsMessage* SensorStory::rivals() const {
  const bool are_of_pose =
      rivals_ && pose_ && status_of(*pose_) == core::FixStatus::Ambiguous && rivals_->scan == pose_->scan;
  return are_of_pose ? &*rivals_ : nullptr;
}

/// Once pose and landmarks of a scan that is known in a local map alone are both here.
void SensorStory::extend_local_map() {
  const bool is_local = pose_ && static_cast<core::FixReason>(pose_->reason) == core::FixReason::LocalMap;
  if (!is_local || scan_number_ != pose_->scan || pose_->scan == scan_in_local_map_ ||
      !is_finite(pose_of(*pose_))) {
    return;
  }
  scan_in_local_map_ = pose_->scan;
  StoryLocalMap& local = local_maps_[pose_->map];
  local.last_scan = pose_->scan;
  if (local.path_W.size() < kLocalLandmarksMax) {
    local.path_W.push_back(pose_of(*pose_));
  }
  for (const core::Point2& landmark_B : scan_B_) {
    const core::Point2 landmark_W = pose_of(*pose_) * landmark_B;
    const std::pair cell(std::llround(landmark_W.x() / kLocalCell_m),
                         std::llround(landmark_W.y() / kLocalCell_m));
    if (local.landmarks_W.size() < kLocalLandmarksMax && local.cells.insert(cell).second) {
      local.landmarks_W.push_back(landmark_W);
    }
  }
  forget_tied_maps();
}

/// The status says how many local maps there are: those that were extended longest ago are tied or gone.
void SensorStory::forget_tied_maps() {
  const std::size_t told =
      status_ ? static_cast<std::size_t>(std::max<std::int64_t>(0, status_->local_maps)) : kLocalMapsMax;
  // The status is a second old: the map of the newest scan may not be counted yet.
  const bool is_current = pose_ && static_cast<core::FixReason>(pose_->reason) == core::FixReason::LocalMap;
  const std::size_t kept = std::min(std::max(told, std::size_t{is_current ? 1U : 0U}), kLocalMapsMax);
  while (local_maps_.size() > kept) {
    local_maps_.erase(std::min_element(
        local_maps_.begin(), local_maps_.end(),
        [](const auto& a, const auto& b) { return a.second.last_scan < b.second.last_scan; }));
  }
}

void SensorStory::on_message(std::string_view channel, std::span<const std::uint8_t> bytes,
                             std::int64_t utime_us) {
  if (!channel.starts_with(prefix_)) {
    return;
  }
  if (const auto pose = firmware::decode_lcm<firmware::PoseMessage>(bytes)) {
    restart_if_new(pose->initialization, utime_us);
    on_pose(*pose, utime_us);
  } else if (const auto status = firmware::decode_lcm<firmware::StatusMessage>(bytes)) {
    restart_if_new(status->initialization, utime_us);
    on_status(*status, utime_us);
  } else if (const auto counters = firmware::decode_lcm<firmware::CountersMessage>(bytes)) {
    restart_if_new(counters->initialization, utime_us);
    on_counters(*counters);
  } else if (const auto map = firmware::decode_lcm<firmware::MapMessage>(bytes)) {
    restart_if_new(map->initialization, utime_us);
    on_map(*map);
  } else if (const auto scan = firmware::decode_lcm<firmware::ScanMessage>(bytes)) {
    restart_if_new(scan->initialization, utime_us);
    on_scan(*scan);
  } else if (const auto rivals = firmware::decode_lcm<firmware::RivalsMessage>(bytes)) {
    restart_if_new(rivals->initialization, utime_us);
    rivals_ = *rivals;
  } else {
    return;
  }
  heard_utime_us_ = utime_us;
}

}  // namespace slamsensor::tools
