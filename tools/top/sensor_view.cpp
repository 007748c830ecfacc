#include "tools/top/sensor_view.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace slamsensor::tools
