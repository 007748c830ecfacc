#include "tools/recording/recording_file.hpp"

#include "firmware/lcm/pose_message.hpp"
#include "firmware/lcm/scan_message.hpp"
#include "firmware/recording/messages.hpp"
#include "tools/input/file.hpp"
#include "tools/recording/event_log_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace slamsensor::tools {
namespace {

class FileChunks final : public ChunkSource {
 public:
  explicit FileChunks(const RecordingFile& recording)
      : file_(recording.path, std::ios::binary), log_(file_), part_(recording.part) {}

  std::optional<Chunk> next() override {
    while (const auto event = log_.next()) {
      if (log_.part() > part_) {
        break;
      }
      if (log_.part() < part_ || event->channel != firmware::kTapeChannel) {
        continue;
      }
      if (const auto block = firmware::decode_block(event->data)) {
        return Chunk{block->number, block->data};
      }
    }
    return std::nullopt;
  }

 private:
  std::ifstream file_;
  LogPartReader log_;
  std::size_t part_;
};

/// Sorts the events of a log into a RecordingFile.
class Sorter {
 public:
  explicit Sorter(RecordingFile& recording) : recording_(recording) {}

  void add(const LogEvent& event) {
    ++recording_.events;
    if (event.channel == firmware::kTapeChannel) {
      const bool is_good = firmware::decode_block(event.data).has_value();
      recording_.chunks += is_good ? 1 : 0;
      damaged_ += is_good ? 0 : 1;
    } else if (event.channel == firmware::kConfigChannel) {
      add_config(firmware::decode_text(event.data));
    } else if (event.channel == firmware::kMapChannel) {
      add_map(firmware::decode_block(event.data));
    } else if (event.channel == firmware::kOrderChannel) {
      add_order(firmware::decode_text(event.data));
    } else if (const auto pose = firmware::decode_lcm<firmware::PoseMessage>(event.data)) {
      const core::Fix fix = firmware::fix_of(*pose);
      recording_.fixes.try_emplace(fix.time.end_monotonic, fix);  // the first is as SLAM gave it
    } else if (firmware::decode_lcm<firmware::ScanMessage>(event.data)) {
      ++recording_.scan_messages;
    }
  }

  /// `bytes_lost` of the file belong to no event.
  void finish(std::uint64_t bytes_lost) {
    if (recording_.chunks > 0 && !recording_.config) {
      say("its settings (" + std::string(firmware::kConfigChannel) +
          ") are missing or damaged; the defaults and --config are used instead");
    }
    if (damaged_ > 0) {
      say(std::to_string(damaged_) + " of its own messages are damaged");
    }
    if (bytes_lost > 0) {
      say(std::to_string(bytes_lost) + " bytes belong to no event and were passed over");
    }
  }

 private:
  void say(const std::string& what) { recording_.damage.push_back(recording_.path.string() + ": " + what); }

  void add_config(const std::optional<firmware::Text>& text) {
    if (!text) {
      ++damaged_;
    } else if (!recording_.config) {
      recording_.config = text->text;
    }
  }

  void add_map(const std::optional<firmware::Block>& block) {
    if (!block) {
      say("the map that the run began with is damaged; it is played as if there had been none");
    } else if (recording_.map.empty()) {
      recording_.map.assign(block->data.begin(), block->data.end());
    }
  }

  void add_order(const std::optional<firmware::Text>& text) {
    const auto order = text ? firmware::parse_map_order(text->text) : std::nullopt;
    if (order) {
      recording_.orders.push_back(*order);
    } else {
      ++damaged_;
    }
  }

  RecordingFile& recording_;
  std::uint64_t damaged_ = 0;
};

/// All recordings of a file.
std::vector<RecordingFile> sorted_parts(std::istream& file, const std::filesystem::path& path) {
  LogPartReader log(file);
  std::vector<RecordingFile> parts;
  auto event = log.next();
  do {
    RecordingFile& recording = parts.emplace_back();
    recording.path = path;
    recording.part = log.part();
    Sorter sorter(recording);
    const std::uint64_t lost_before = parts.size() == 1 ? 0 : log.log().bytes_passed_over();
    for (; event && log.part() == recording.part; event = log.next()) {
      sorter.add(*event);
    }
    sorter.finish(log.log().bytes_passed_over() - lost_before);
  } while (event);
  parts.back().is_truncated = log.log().is_truncated();
  return parts;
}

}  // namespace

bool is_event_log_file(const std::filesystem::path& path) {
  const auto start = read_file(path, sizeof firmware::kEventSync);
  return start && is_event_log(*start);
}

tl::expected<std::vector<RecordingFile>, InputError> open_recordings(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return refuse(path.string(), std::string("cannot be opened: ") + std::strerror(errno));
  }
  std::vector<RecordingFile> parts = sorted_parts(file, path);
  const auto has_scans = [](const RecordingFile& part) { return part.chunks > 0 || part.scan_messages > 0; };
  if (std::none_of(parts.begin(), parts.end(), has_scans)) {
    return refuse(path.string(),
                  "is an LCM event log without scans: neither a tape (" +
                      std::string(firmware::kTapeChannel) +
                      ") nor slamsensor.scan_t messages; record with slamsensor record, or log the sensor's "
                      "SCAN channel");
  }
  return parts;
}

std::unique_ptr<ChunkSource> open_tape(const RecordingFile& recording) {
  return std::make_unique<FileChunks>(recording);
}

}  // namespace slamsensor::tools
