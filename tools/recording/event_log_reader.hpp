#pragma once

#include "firmware/recording/event_log.hpp"

#include <cstdint>
#include <istream>
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
/// taken for bytes that are there, never for those that a head promises.
class EventLogReader {
 public:
  /// Reads `log`, which can seek and outlives this, from its beginning.
  explicit EventLogReader(std::istream& log);

  /// The next event, or nothing at the end.
  [[nodiscard]] std::optional<LogEvent> next();

  /// Bytes that belong to no event, so far; those of a truncated last event are not among them.
  [[nodiscard]] std::uint64_t bytes_passed_over() const noexcept {
    return passed_over_ - (truncated_at_ ? offset_ - *truncated_at_ : 0);
  }
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

}  // namespace slamsensor::tools
