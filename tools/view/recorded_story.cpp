#include "tools/view/recorded_story.hpp"

#include "firmware/recording/event_log.hpp"
#include "tools/recording/recording_file.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <fstream>

namespace slamsensor::tools {
namespace {

/// The datum among the settings of a recording, if they have one.
std::optional<firmware::Datum> datum_in(std::string_view config) {
  const auto parse = [&]() -> std::optional<toml::table> {
    try {
      return toml::parse(config);
    } catch (const toml::parse_error&) {
      return std::nullopt;  // the datum is not shown; replay tells what is wrong with the file
    }
  };
  const std::optional<toml::table> table = parse();
  const auto value = [&](const char* key) -> std::optional<double> {
    return table ? table->at_path(std::string("datum.") + key).value<double>() : std::nullopt;
  };
  const auto latitude = value("latitude_deg");
  const auto longitude = value("longitude_deg");
  if (!latitude || !longitude) {
    return std::nullopt;
  }
  firmware::Datum datum;
  datum.latitude_deg = *latitude;
  datum.longitude_deg = *longitude;
  datum.height_m = value("height_m").value_or(datum.height_m);
  datum.bearing_deg = value("bearing_deg").value_or(datum.bearing_deg);
  return datum;
}

/// Whether messages of the channel are kept: those that only a replay needs are many times as long.
bool is_of_a_story(std::string_view channel, const std::string& prefix) {
  return channel.starts_with(prefix) && channel != firmware::kTapeChannel &&
         channel != firmware::kOrderChannel && channel != firmware::kNmeaChannel;
}

}  // namespace

tl::expected<RecordedStory, InputError> RecordedStory::open(const std::filesystem::path& path,
                                                            const std::string& prefix) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    return refuse(path.string(), "does not exist; name a recording of ctl record, record or lcm-logger");
  }
  if (std::filesystem::is_directory(path, ignored)) {
    return refuse(path.string(), "is a folder; name one of the recordings in it");
  }
  if (!is_event_log_file(path)) {
    return refuse(path.string(), "is no recording; name one of ctl record, record or lcm-logger");
  }
  RecordedStory story(prefix);
  std::ifstream file(path, std::ios::binary);
  EventLogReader log(file);
  while (const auto event = log.next()) {
    if (event->channel == firmware::kConfigChannel) {
      if (const auto text = firmware::decode_text(event->data)) {
        story.datum_ = datum_in(text->text);
      }
    } else if (event->channel == firmware::kMapChannel) {
      const auto block = firmware::decode_block(event->data);
      auto map = block ? firmware::decode_map(block->data, firmware::unlimited_capacities())
                       : tl::unexpected(firmware::MapFileError{});
      if (map) {
        story.map_ = std::move(*map);
      }
    } else if (is_of_a_story(event->channel, prefix)) {
      story.messages_.push_back(
          {event->utime_us, std::string(event->channel), {event->data.begin(), event->data.end()}});
    }
  }
  if (log.is_truncated() || log.bytes_passed_over() > 0) {
    story.warning_ = path.string() + ": the recording is damaged or cut; what is whole is shown";
  }
  story.index();
  if (story.marks_.empty()) {
    return refuse(path.string(), "holds no scan of a sensor on channels " + prefix +
                                     "...; name the prefix it was recorded with (--prefix)");
  }
  return story;
}

SensorStory RecordedStory::fresh() const {
  SensorStory story(prefix_);
  story.set_datum(datum_, datum_source_);
  if (map_) {
    story.on_map_file(*map_);
  }
  return story;
}

void RecordedStory::offer_datum(const std::optional<firmware::Datum>& datum) {
  if (!datum_ && !(map_ && map_->about.datum)) {
    datum_ = datum;
    datum_source_ = DatumSource::Configuration;
    story_ = fresh();
    next_ = 0;
  }
}

/// Runs through it once for the time line.
void RecordedStory::index() {
  std::stable_sort(messages_.begin(), messages_.end(),
                   [](const Message& a, const Message& b) { return a.utime_us < b.utime_us; });
  SensorStory story = fresh();
  std::uint64_t told = 0;
  for (const Message& message : messages_) {
    story.on_message(message.channel, message.bytes, message.utime_us);
    if (firmware::decode_lcm<firmware::PoseMessage>(message.bytes)) {
      marks_.push_back({message.utime_us, story.pose()->status});
    }
    for (; told < story.events().end(); ++told) {
      events_.push_back(story.events().items[told - story.events().begin]);
    }
  }
  if (!messages_.empty()) {
    begin_us_ = messages_.front().utime_us;
    end_us_ = messages_.back().utime_us;
  }
  story_ = fresh();
}

const SensorStory& RecordedStory::at(std::int64_t utime_us) {
  if (next_ > 0 && messages_[next_ - 1].utime_us > utime_us) {
    const std::uint64_t version = story_.map_version();
    story_ = fresh();
    story_.continue_versions(version);
    next_ = 0;
  }
  for (; next_ < messages_.size() && messages_[next_].utime_us <= utime_us; ++next_) {
    story_.on_message(messages_[next_].channel, messages_[next_].bytes, messages_[next_].utime_us);
  }
  return story_;
}

}  // namespace slamsensor::tools
