#pragma once

#include "core/geometry/pose2.hpp"
#include "firmware/lcm/lcm_messages.hpp"
#include "hal/stamp.hpp"
#include "tools/spy/channel_table.hpp"
#include "tools/spy/lcm_receiver.hpp"
#include "tools/top/canvas.hpp"

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// What is known of one sensor from the LCM messages it has sent. Times are the reader's own.
class SensorView {
 public:
  static constexpr std::size_t kPathMax = 2000;
  static constexpr std::int32_t kMapChunksMax = 3000;  ///< 90,000 landmarks; more are not shown

  struct Landmark {
    core::Point2 position_W = core::Point2::Zero();
    std::int32_t xi = 0;
  };
  struct Counter {
    std::string name;
    std::int64_t value = 0;
    hal::Stamp changed = hal::Stamp::min();  ///< when it was last seen to grow
  };

  /// Takes in a message on one of the channels that begin with `prefix`; others, and broken ones, are left
  /// alone. A new start of the sensor begins a new view.
  explicit SensorView(std::string prefix) : prefix_(std::move(prefix)) {}
  void on_message(const LcmMessageView& message, hal::Stamp now);

  [[nodiscard]] const std::string& prefix() const { return prefix_; }
  [[nodiscard]] const std::optional<firmware::PoseMessage>& pose() const { return pose_; }
  [[nodiscard]] const std::optional<firmware::StatusMessage>& status() const { return status_; }
  [[nodiscard]] hal::Stamp pose_time() const { return pose_time_; }
  [[nodiscard]] const std::vector<Counter>& counters(firmware::LcmStation station) const {
    return counters_.at(static_cast<std::size_t>(station));
  }
  /// Every chunk of the map as it was last heard, by its number.
  [[nodiscard]] const std::map<std::int32_t, std::vector<Landmark>>& map() const { return map_; }
  /// Poses of the last kPathMax fixes.
  [[nodiscard]] const std::deque<core::Pose2>& path_W() const { return path_W_; }
  /// When anything was last heard; none before.
  [[nodiscard]] std::optional<hal::Stamp> heard() const { return heard_; }

 private:
  void restart_if_new(std::int64_t initialization);
  void on_pose(const firmware::PoseMessage& pose, hal::Stamp now);
  void on_counters(const firmware::CountersMessage& message, hal::Stamp now);
  void on_map(const firmware::MapMessage& message);

  std::string prefix_;
  std::optional<hal::Stamp> heard_;
  std::optional<std::int64_t> initialization_;
  std::optional<firmware::PoseMessage> pose_;
  hal::Stamp pose_time_{};
  std::optional<firmware::StatusMessage> status_;
  std::array<std::vector<Counter>, firmware::kLcmStationNames.size()> counters_;
  std::map<std::int32_t, std::vector<Landmark>> map_;
  std::deque<core::Pose2> path_W_;
};

enum class TopPage : std::uint8_t { Sensor, Counters, Channels };

/// What the person has chosen.
struct TopChoice {
  TopPage page = TopPage::Sensor;
  std::size_t channel = 0;  ///< selected on the page of channels
  int first_line = 0;       ///< scrolled to on the page of counters
};

/// What a frame is drawn from.
struct TopState {
  explicit TopState(const std::string& prefix) : sensor(prefix) {}

  SensorView sensor;
  ChannelTable channels;
  TopChoice choice;
  std::string problem;  ///< of listening; empty: none
  hal::Stamp started{};
  std::uint64_t refused = 0;  ///< datagrams that were not LCM's
  std::uint64_t dropped = 0;  ///< messages of which fragments were lost

  /// Takes in a message.
  void on_message(const LcmMessageView& message, hal::Stamp now);
};

/// How long a sensor may say nothing before it counts as silent.
inline constexpr hal::Stamp kSilentAfter = std::chrono::seconds(12);

/// The chosen page, at whatever size: a heading with the keys, a line that says what is wrong with listening
/// or that the sensor is silent, then the page.
[[nodiscard]] Canvas draw_frame(const TopState& state, int width, int height, hal::Stamp now);

}  // namespace slamsensor::tools
