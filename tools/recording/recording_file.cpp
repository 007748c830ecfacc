#include "tools/recording/recording_file.hpp"

#include "firmware/lcm/lcm_messages.hpp"
#include "firmware/recording/event_log.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace slamsensor::tools {
namespace {

using firmware::read_big_endian;

constexpr std::size_t kSyncBytes = sizeof firmware::kEventSync;
constexpr std::size_t kHuntBytes = std::size_t{64} * 1024;
constexpr std::size_t kDoubtfulMax = std::size_t{1} << 20;

std::array<std::uint8_t, kSyncBytes> sync_bytes() noexcept {
  std::array<std::uint8_t, kSyncBytes> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(firmware::kEventSync >> (8 * (bytes.size() - 1 - i)));
  }
  return bytes;
}

std::uint64_t size_of(std::istream& log) {
  log.seekg(0, std::ios::end);
  const std::streamoff size = log.tellg();
  return size > 0 ? static_cast<std::uint64_t>(size) : 0;
}

}  // namespace

struct EventLogReader::Head {
  std::int64_t number = 0;
  std::int64_t utime_us = 0;
  std::uint32_t channel_size = 0;
  std::uint32_t data_size = 0;

  [[nodiscard]] bool is_possible() const noexcept {
    return number >= 0 && channel_size > 0 && channel_size <= firmware::kEventChannelMax &&
           data_size <= firmware::kEventDataMax;
  }
  [[nodiscard]] std::uint64_t size() const noexcept {
    return firmware::kEventHeadBytes + std::uint64_t{channel_size} + data_size;
  }
};

EventLogReader::EventLogReader(std::istream& log) : log_(log), size_(size_of(log)) {
}

/// Fills `into` as far as the log reaches.
std::size_t EventLogReader::read_at(std::uint64_t offset, std::span<std::uint8_t> into) {
  log_.clear();
  log_.seekg(static_cast<std::streamoff>(offset));
  log_.read(reinterpret_cast<char*>(into.data()), static_cast<std::streamsize>(into.size()));
  return static_cast<std::size_t>(log_.gcount());
}

void EventLogReader::pass_over(std::uint64_t bytes) noexcept {
  passed_over_ += bytes;
  offset_ += bytes;
}

std::uint64_t EventLogReader::bytes_passed_over() const noexcept {
  const std::uint64_t end = truncated_at_.value_or(offset_);
  const std::uint64_t of_doubtful_event = std::min(end, doubtful_end_) - std::min(end, doubtful_begin_);
  return passed_over_ - (offset_ - end) - of_doubtful_event;
}

/// Moves on to the next sync word; false when there is none.
bool EventLogReader::find_sync() {
  static const auto kSync = sync_bytes();
  window_.resize(kSyncBytes);  // mostly it is here
  while (offset_ + kSyncBytes <= size_) {
    const std::span<const std::uint8_t> window(window_.data(), read_at(offset_, window_));
    const auto found = std::search(window.begin(), window.end(), kSync.begin(), kSync.end());
    if (found != window.end()) {
      pass_over(static_cast<std::uint64_t>(found - window.begin()));
      return true;
    }
    if (window.size() < kSyncBytes) {
      break;
    }
    pass_over(window.size() - (kSyncBytes - 1));  // it may begin in the last three bytes
    window_.resize(kHuntBytes);
  }
  pass_over(size_ - offset_);
  return false;
}

/// The event whose sync word is here; past its head or past all of it when it is one, else where it was.
std::optional<LogEvent> EventLogReader::event_here() {
  std::array<std::uint8_t, firmware::kEventHeadBytes> bytes{};
  const bool is_whole = read_at(offset_, bytes) == bytes.size();
  const std::span<const std::uint8_t> all = bytes;
  const Head head{
      read_big_endian<std::int64_t>(all.subspan(4)), read_big_endian<std::int64_t>(all.subspan(12)),
      read_big_endian<std::uint32_t>(all.subspan(20)), read_big_endian<std::uint32_t>(all.subspan(24))};
  if (!is_whole || (head.is_possible() && offset_ + head.size() > size_)) {
    truncated_at_ = truncated_at_.value_or(offset_);
    return std::nullopt;
  }
  if (!head.is_possible()) {
    return std::nullopt;
  }
  // The lengths of an event that no other follows are in doubt: it is taken when its number is the next one,
  // and another is looked for from its head on.
  std::array<std::uint8_t, kSyncBytes> after{};
  const std::size_t count = read_at(offset_ + head.size(), after);
  const bool is_followed =
      std::equal(after.begin(), after.begin() + static_cast<std::ptrdiff_t>(count), sync_bytes().begin());
  if (!is_followed && (!last_number_ || head.number - 1 != *last_number_ || head.data_size > kDoubtfulMax)) {
    return std::nullopt;
  }
  body_.resize(static_cast<std::size_t>(head.size() - bytes.size()));
  if (read_at(offset_ + bytes.size(), body_) != body_.size()) {
    return std::nullopt;
  }
  truncated_at_.reset();
  if (offset_ >= doubtful_end_) {  // no event was found within the last one in doubt
    passed_over_ = bytes_passed_over();
  }
  doubtful_begin_ = is_followed ? 0 : offset_ + bytes.size();
  doubtful_end_ = is_followed ? 0 : offset_ + head.size();
  offset_ += is_followed ? head.size() : bytes.size();
  last_number_ = head.number;
  const std::span<const std::uint8_t> body = body_;
  return LogEvent{head.number,
                  head.utime_us,
                  {reinterpret_cast<const char*>(body.data()), head.channel_size},
                  body.subspan(head.channel_size)};
}

std::optional<LogEvent> EventLogReader::next() {
  while (find_sync()) {
    if (const auto event = event_here()) {
      return event;
    }
    pass_over(1);
  }
  return std::nullopt;
}

std::optional<LogEvent> LogPartReader::next() {
  const auto event = log_.next();
  if (event) {
    part_ += event->number < last_number_ ? 1 : 0;
    last_number_ = event->number;
  }
  return event;
}

bool is_event_log(std::string_view bytes) noexcept {
  const auto sync = sync_bytes();
  return bytes.size() >= sync.size() &&
         std::equal(sync.begin(), sync.end(), bytes.begin(),
                    [](auto a, char b) { return a == static_cast<std::uint8_t>(b); });
}

using firmware::ScanMessage;

ScanLog::ScanLog(const std::filesystem::path& path, std::size_t part)
    : name_(path.string()), file_(path, std::ios::binary), log_(file_), part_(part) {
}

std::optional<ScanMessage> ScanLog::next_message() {
  while (const auto event = log_.next()) {
    if (log_.part() != part_) {
      continue;
    }
    if (const auto message = firmware::decode_lcm<ScanMessage>(event->data)) {
      ++messages_;
      return message;
    }
  }
  return std::nullopt;
}

void ScanLog::add(const ScanMessage& message) {
  if (chunks_ == 0) {
    scan_ = {message.scan, firmware::scan_time_of(message), {}};
    begun_by_ = message.initialization;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.count); ++i) {
    scan_.landmarks.push_back({{message.x_m[i], message.y_m[i]}, message.weight[i], message.diameter_m[i]});
  }
  ++chunks_;
}

void ScanLog::refuse_scan() {
  refused_.push_back(name_ + ": scan " + std::to_string(scan_.number) + ": message " +
                     std::to_string(chunks_) + " of it is missing");
  refused_scan_ = scan_.number;
  chunks_ = 0;
}

std::optional<LoggedScan> ScanLog::next() {
  while (const auto message = next_message()) {
    const bool goes_on = chunks_ > 0 && message->scan == scan_.number &&
                         message->initialization == begun_by_ && message->chunk == chunks_;
    if (chunks_ > 0 && !goes_on) {
      refuse_scan();
    }
    if (chunks_ == 0 && message->chunk != 0) {
      if (refused_scan_ != message->scan) {
        scan_.number = message->scan;
        refuse_scan();
      }
      continue;
    }
    add(*message);
    if (chunks_ == message->chunks) {
      chunks_ = 0;
      return std::move(scan_);
    }
  }
  if (chunks_ > 0) {
    refuse_scan();
  }
  return std::nullopt;
}

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
  if (std::none_of(parts.begin(), parts.end(), [](const RecordingFile& part) { return part.has_scans(); })) {
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
