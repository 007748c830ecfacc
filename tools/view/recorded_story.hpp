#pragma once

#include "tools/input/text.hpp"
#include "tools/view/sensor_story.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// A recording (or any LCM log of a sensor's messages) that can be looked at as it stood at any moment. The
/// messages that a story is made of are kept in memory; the devices' bytes are not.
class RecordedStory {
 public:
  /// A mark on the time line: a scan and its status.
  struct Mark {
    std::int64_t utime_us = 0;
    std::int8_t status = 0;
  };

  /// Reads `path` once. An error when it is no log or has no message of a sensor with that prefix.
  [[nodiscard]] static tl::expected<RecordedStory, InputError> open(const std::filesystem::path& path,
                                                                    const std::string& prefix);

  [[nodiscard]] std::int64_t begin_us() const { return begin_us_; }
  [[nodiscard]] std::int64_t end_us() const { return end_us_; }
  [[nodiscard]] const std::vector<Mark>& marks() const { return marks_; }
  [[nodiscard]] const std::vector<StoryEvent>& events() const { return events_; }
  [[nodiscard]] const std::string& warning() const { return warning_; }  ///< damage; empty without

  /// Shows places on the earth by this datum if the recording has none.
  void offer_datum(const std::optional<firmware::Datum>& datum);

  /// The story up to `utime_us`, valid until the next call. Going on is quick; going back begins anew.
  [[nodiscard]] const SensorStory& at(std::int64_t utime_us);

 private:
  struct Message {
    std::int64_t utime_us = 0;
    std::string channel;
    std::vector<std::uint8_t> bytes;
  };

  explicit RecordedStory(std::string prefix) : prefix_(std::move(prefix)), story_(prefix_) {}
  [[nodiscard]] SensorStory fresh() const;
  void index();

  std::string prefix_;
  std::vector<Message> messages_;  // by time
  std::optional<firmware::MapFile> map_;
  std::optional<firmware::Datum> datum_;
  DatumSource datum_source_ = DatumSource::Recording;
  std::vector<Mark> marks_;
  std::vector<StoryEvent> events_;
  std::string warning_;
  std::int64_t begin_us_ = 0;
  std::int64_t end_us_ = 0;
  SensorStory story_;
  std::size_t next_ = 0;  // the first message that `story_` has not taken in
};

}  // namespace slamsensor::tools
