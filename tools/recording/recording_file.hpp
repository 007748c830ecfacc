#pragma once

#include "core/fix.hpp"
#include "core/reading.hpp"
#include "firmware/lcm/lcm_messages.hpp"
#include "firmware/recording/event_log.hpp"
#include "tools/input/text.hpp"
#include "tools/recording/playback.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <istream>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// One event of a log; valid until the next is read.
struct LogEvent {
  std::int64_t number = 0;
  std::int64_t utime_us = 0;
  std::string_view channel;
  std::span<const std::uint8_t> data;
};

/// Reads an LCM event log (firmware/recording/event_log.hpp), also one that is damaged: it hunts for the sync
/// word, passes over heads that cannot be, and takes a truncated tail for what it is, the end. Memory is
/// taken for bytes that are there, never for those that a head promises. (Not liblcm's reader: it ends at the
/// first event whose head is damaged.)
class EventLogReader {
 public:
  /// Reads `log`, which can seek and outlives this, from its beginning.
  explicit EventLogReader(std::istream& log);

  /// The next event, or nothing at the end.
  [[nodiscard]] std::optional<LogEvent> next();

  /// Bytes that belong to no event, so far; those of a truncated last event are not among them.
  [[nodiscard]] std::uint64_t bytes_passed_over() const noexcept;
  /// Whether the log ends within an event.
  [[nodiscard]] bool is_truncated() const noexcept { return truncated_at_.has_value(); }
  /// Where the next event is looked for.
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }

 private:
  struct Head;

  [[nodiscard]] bool find_sync();
  [[nodiscard]] std::optional<LogEvent> event_here();
  [[nodiscard]] std::size_t read_at(std::uint64_t offset, std::span<std::uint8_t> into);
  void pass_over(std::uint64_t bytes) noexcept;

  std::istream& log_;
  std::uint64_t size_;
  std::uint64_t offset_ = 0;
  std::optional<std::int64_t> last_number_;
  std::uint64_t passed_over_ = 0;
  std::uint64_t doubtful_begin_ = 0;  // of what follows the head of the last event whose lengths are in doubt
  std::uint64_t doubtful_end_ = 0;
  std::optional<std::uint64_t> truncated_at_;  // unless an event is found behind it
  std::vector<std::uint8_t> body_;
  std::vector<std::uint8_t> window_;
};

/// The events of a log that several were joined to, as `cat a b` does: each part numbers its events anew.
class LogPartReader {
 public:
  /// Of `log`, which outlives this.
  explicit LogPartReader(std::istream& log) : log_(log) {}

  /// The next event, as EventLogReader gives it.
  [[nodiscard]] std::optional<LogEvent> next();

  /// Of the event that was given last; the first part is 0.
  [[nodiscard]] std::size_t part() const noexcept { return part_; }
  [[nodiscard]] const EventLogReader& log() const noexcept { return log_; }

 private:
  EventLogReader log_;
  std::int64_t last_number_ = -1;
  std::size_t part_ = 0;
};

/// Whether a file that begins with `bytes` is an event log.
[[nodiscard]] bool is_event_log(std::string_view bytes) noexcept;

/// A scan that the sensor sent as landmarks.
struct LoggedScan {
  std::int64_t number = 0;
  core::ScanTime time;
  std::vector<core::ScanLandmark> landmarks;  ///< heaviest first
};

/// The scans in the slamsensor.scan_t messages of an LCM event log, on whichever channel they are, in their
/// order. A scan of which a message is missing is refused, not given out.
class ScanLog {
 public:
  /// Those of the recording `part` of the file (RecordingFile::part).
  ScanLog(const std::filesystem::path& path, std::size_t part);

  /// The next scan, or nothing after the last.
  [[nodiscard]] std::optional<LoggedScan> next();

  /// What was wrong with scans that were refused so far, each in a sentence.
  [[nodiscard]] const std::vector<std::string>& refused() const noexcept { return refused_; }
  /// Messages read so far.
  [[nodiscard]] std::size_t messages() const noexcept { return messages_; }

 private:
  [[nodiscard]] std::optional<firmware::ScanMessage> next_message();
  void add(const firmware::ScanMessage& message);
  void refuse_scan();

  std::string name_;
  std::ifstream file_;
  LogPartReader log_;
  std::size_t part_;
  LoggedScan scan_;
  std::int32_t chunks_ = 0;                   // that scan_ has so far; 0: none is begun
  std::int64_t begun_by_ = 0;                 // initialization of the daemon that sent it
  std::optional<std::int64_t> refused_scan_;  // the last
  std::vector<std::string> refused_;
  std::size_t messages_ = 0;
};

/// All of one recording but its tape, or of any other LCM event log. The tape is read chunk by chunk.
struct RecordingFile {
  std::filesystem::path path;
  std::size_t part = 0;  ///< which of the recordings in the file, where several were joined
  std::uint64_t events = 0;
  std::optional<std::string> config;  ///< TOML of the settings in force
  std::vector<std::uint8_t> map;      ///< the file of the map that the run began with; empty without one
  std::int64_t chunks = 0;            ///< of tape, undamaged
  std::int64_t scan_messages = 0;     ///< slamsensor.scan_t
  std::vector<firmware::MapOrder> orders;
  std::map<hal::Stamp, core::Fix>
      fixes;                        ///< as they were sent, by the end of their scan on the sensor's clock
  bool is_truncated = false;        ///< it ends within an event, as a log does whose logger was killed
  std::vector<std::string> damage;  ///< what is wrong with the file, each in a sentence

  [[nodiscard]] bool has_scans() const noexcept { return chunks > 0 || scan_messages > 0; }
};

/// Whether `path` is a file that begins as an LCM event log does.
[[nodiscard]] bool is_event_log_file(const std::filesystem::path& path);

/// Reads all of `path` once. Each recording in it, at least one, in the order of the file. Damage is no
/// error: what is whole counts.
[[nodiscard]] tl::expected<std::vector<RecordingFile>, InputError> open_recordings(
    const std::filesystem::path& path);

/// The undamaged chunks of the tape of `recording`, in the order of the file.
[[nodiscard]] std::unique_ptr<ChunkSource> open_tape(const RecordingFile& recording);

}  // namespace slamsensor::tools
