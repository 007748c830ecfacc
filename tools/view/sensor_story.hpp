#pragma once

#include "core/geometry/pose2.hpp"
#include "firmware/config/sensor_config.hpp"
#include "firmware/lcm/lcm_messages.hpp"
#include "firmware/store/map_file.hpp"

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slamsensor::tools {

/// A list that only grows at its end and loses its beginning: readers remember how far they have read.
template <typename T>
struct StoryList {
  std::deque<T> items;
  std::uint64_t begin = 0;  ///< number of the first item that is left
  std::uint64_t epoch = 0;  ///< changes when all items became void

  [[nodiscard]] std::uint64_t end() const { return begin + items.size(); }

  void add(T item, std::size_t count_max) {
    items.push_back(std::move(item));
    if (items.size() > count_max) {
      items.pop_front();
      ++begin;
    }
  }
  void clear() {
    begin = end();
    items.clear();
    ++epoch;
  }
};

enum class StoryTone : std::uint8_t { Good, Bad, Neutral };

struct StoryEvent {
  std::int64_t utime_us = 0;
  StoryTone tone = StoryTone::Neutral;
  std::string text;
};

struct StoryLandmark {
  core::Point2 position_W = core::Point2::Zero();
  std::int64_t id = 0;
  std::int32_t xi = 0;
  std::int32_t sightings = 0;
  std::int32_t last_scan = 0;
  double sigma_m = 0.0;  ///< 0: not known

  [[nodiscard]] bool operator==(const StoryLandmark&) const = default;
};

/// A share of the home map. `version` is the first version of the map that has it like this.
struct StoryChunk {
  std::vector<StoryLandmark> landmarks;
  std::uint64_t version = 0;
};

/// A fix on the path; the line from the one before is drawn only when no scan between them was without.
struct StoryFix {
  core::Pose2 pose_W;
  bool follows = false;
};

/// Whose datum a story has.
enum class DatumSource : std::uint8_t { Sensor, Recording, Configuration };

/// A map that is not tied to the home map, as far as the scans of this story showed it.
struct StoryLocalMap {
  std::vector<core::Point2> landmarks_W;
  std::vector<core::Pose2> path_W;
  std::int64_t last_scan = 0;
  std::set<std::pair<std::int64_t, std::int64_t>> cells;  // that have a landmark already
};

/// What a sensor has told in LCM messages so far, live or in a recording: its state now, and what happened.
/// Memory is bounded, whatever comes. Times are UTC, us.
class SensorStory {
 public:
  static constexpr std::size_t kPathMax = 5000;
  static constexpr std::size_t kEventsMax = 500;
  static constexpr std::int32_t kMapChunksMax = 3000;  ///< 90,000 landmarks; more are not shown
  static constexpr std::size_t kLocalMapsMax = 16;
  static constexpr std::size_t kLocalLandmarksMax = 2000;

  explicit SensorStory(std::string prefix) : prefix_(std::move(prefix)) {}

  /// Takes in a message that came at `utime_us`; those of other channels or types are passed over.
  void on_message(std::string_view channel, std::span<const std::uint8_t> bytes, std::int64_t utime_us);
  /// The map that a recording begins with.
  void on_map_file(const firmware::MapFile& map);
  void set_datum(std::optional<firmware::Datum> datum, DatumSource source) {
    datum_ = datum;
    datum_source_ = source;
  }
  void set_stale_s(double stale_s) { stale_s_ = stale_s; }

  /// Counts map versions on from `version`, so that readers of an earlier story see that this is another.
  void continue_versions(std::uint64_t version);

  [[nodiscard]] const std::optional<firmware::PoseMessage>& pose() const { return pose_; }
  [[nodiscard]] std::int64_t pose_utime_us() const { return pose_utime_us_; }
  [[nodiscard]] const std::optional<firmware::StatusMessage>& status() const { return status_; }
  [[nodiscard]] std::optional<std::int64_t> heard_utime_us() const { return heard_utime_us_; }
  [[nodiscard]] const std::optional<firmware::Datum>& datum() const { return datum_; }
  [[nodiscard]] DatumSource datum_source() const { return datum_source_; }
  /// Without a scan for this long the last fix is no fix any more; none when that is not known.
  [[nodiscard]] std::optional<double> stale_s() const { return stale_s_; }
  /// Of the sensor's last start; none before its first message.
  [[nodiscard]] std::optional<std::int64_t> initialization() const { return initialization_; }

  /// Landmarks of the last whole scan (sensor frame), and its number; none before.
  [[nodiscard]] const std::vector<core::Point2>& scan_B() const { return scan_B_; }
  [[nodiscard]] std::optional<std::int64_t> scan_number() const { return scan_number_; }

  /// The rivals of the last pose; none when it is not ambiguous or they are not known.
  [[nodiscard]] const firmware::RivalsMessage* rivals() const;

  using Counters = std::vector<std::pair<std::string, std::int64_t>>;
  [[nodiscard]] const std::array<Counters, firmware::kLcmStationNames.size()>& counters() const {
    return counters_;
  }
  /// The fixes in the home map.
  [[nodiscard]] const StoryList<StoryFix>& path_W() const { return path_W_; }
  [[nodiscard]] const StoryList<StoryEvent>& events() const { return events_; }
  /// The home map: its chunks by number; `map_version` grows with it.
  [[nodiscard]] const std::map<std::int32_t, StoryChunk>& map() const { return map_; }
  [[nodiscard]] std::uint64_t map_version() const { return map_version_; }
  /// Local maps that are not tied yet, by their number.
  [[nodiscard]] const std::map<std::int64_t, StoryLocalMap>& local_maps() const { return local_maps_; }

 private:
  void restart_if_new(std::int64_t initialization, std::int64_t utime_us);
  void on_pose(const firmware::PoseMessage& pose, std::int64_t utime_us);
  void on_status(const firmware::StatusMessage& status, std::int64_t utime_us);
  void on_counters(const firmware::CountersMessage& message);
  void on_map(const firmware::MapMessage& message);
  void set_chunk(std::int32_t number, std::vector<StoryLandmark> landmarks);
  void on_scan(const firmware::ScanMessage& message);
  void extend_local_map();
  void forget_tied_maps();
  void tell(std::int64_t utime_us, StoryTone tone, std::string text);
  void tell_pose(const firmware::PoseMessage& pose, std::int64_t utime_us);
  void tell_status(const firmware::StatusMessage& status, std::int64_t utime_us);

  std::string prefix_;
  std::optional<std::int64_t> initialization_;
  std::optional<firmware::PoseMessage> pose_;
  std::int64_t pose_utime_us_ = 0;
  std::optional<firmware::StatusMessage> status_;
  std::optional<std::int64_t> heard_utime_us_;
  std::optional<firmware::Datum> datum_;
  DatumSource datum_source_ = DatumSource::Sensor;
  std::optional<double> stale_s_;
  std::map<std::int32_t, std::vector<core::Point2>> scan_chunks_;  // of the scan that is being received
  std::int64_t scan_receiving_ = -1;
  std::vector<core::Point2> scan_B_;
  std::optional<std::int64_t> scan_number_;
  std::optional<firmware::RivalsMessage> rivals_;  // the last that came
  std::int64_t scan_in_local_map_ = -1;            // the last scan that extended a local map
  std::array<Counters, firmware::kLcmStationNames.size()> counters_;
  StoryList<StoryFix> path_W_;
  std::int64_t path_scan_ = -1;
  StoryList<StoryEvent> events_;
  std::map<std::int32_t, StoryChunk> map_;
  std::uint64_t map_version_ = 0;
  bool is_map_changed_ = false;  // since map_version_
  std::map<std::int64_t, StoryLocalMap> local_maps_;
};

}  // namespace slamsensor::tools
