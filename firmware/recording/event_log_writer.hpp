#pragma once

#include "firmware/recording/event_log.hpp"
#include "hal/init_error.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

enum class ExistingFile : std::uint8_t { Refuse, Replace };

/// Writes an LCM event log. The file holds whole events at every moment that the disk allows: what a failed
/// write left of an event is cut off again. After a failure nothing more is written. May wait for the disk.
class EventLogWriter {
 public:
  /// A new, empty log at `path`; the folder exists. The error says what to do.
  [[nodiscard]] static tl::expected<EventLogWriter, hal::InitError> create(const std::filesystem::path& path,
                                                                           ExistingFile existing);

  EventLogWriter(EventLogWriter&& other) noexcept;
  EventLogWriter& operator=(EventLogWriter&&) = delete;
  ~EventLogWriter();

  /// Appends an event at `utime_us`. False when it is not in the log: the channel or the data is too long or
  /// empty, or the log has failed.
  [[nodiscard]] bool write(std::int64_t utime_us, std::string_view channel,
                           std::span<const std::uint8_t> data);

  /// Everything appended is handed to the system; false when the log has failed.
  [[nodiscard]] bool flush();

  /// The same, on the disk, and the file is closed; false when the log has failed, before or now.
  [[nodiscard]] bool close();

  /// Of the file when all is flushed.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return on_file_ + pending_.size(); }
  [[nodiscard]] std::uint64_t events() const noexcept { return events_; }

  /// The system's error number of the failure, 0 before.
  [[nodiscard]] int error() const noexcept { return error_; }

 private:
  explicit EventLogWriter(int fd) noexcept : fd_(fd) {}
  void fail(int error) noexcept;

  int fd_;
  int error_ = 0;
  std::vector<std::uint8_t> pending_;  // whole events
  std::uint64_t on_file_ = 0;
  std::uint64_t events_ = 0;
};

}  // namespace slamsensor::firmware
