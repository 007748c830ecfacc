#pragma once

#include "firmware/lcm/lcm_sink.hpp"
#include "firmware/recording/event_log.hpp"
#include "firmware/recording/recording_links.hpp"
#include "firmware/recording/tape_format.hpp"
#include "firmware/recording/tape_writer.hpp"
#include "firmware/serving/epoch_sink.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::firmware {

struct RecorderConfig {
  std::filesystem::path path;
  ExistingFile existing = ExistingFile::Refuse;
  std::uint64_t bytes_max = ~std::uint64_t{0};  ///< an event that would lead beyond it ends the recording
};

/// How a recording stands.
enum class RecorderState : std::uint8_t {
  Recording,
  Full,    ///< the largest size is reached: what is in the file is whole
  Failed,  ///< the disk refused; the recording has ended
  Closed,
};

/// Writes a recording: an LCM event log of all that a run began with, got from its devices, and sent. Any
/// program that reads such logs can read it; `slamsensor replay` does the run again from it. One thread,
/// which may have to wait for the disk.
///
/// Order: config, then the map if there was one, then tape and messages as they come. Times are UTC in
/// microseconds.
class Recorder {
 public:
  [[nodiscard]] static tl::expected<Recorder, hal::InitError> create(const RecorderConfig& config);

  /// The settings in force (config_toml).
  void config(std::int64_t utime_us, std::string_view toml);
  /// The map that the run begins with, as its file.
  void map(std::int64_t utime_us, std::span<const std::uint8_t> file);
  void tape(std::int64_t utime_us, const TapeChunk& chunk);
  void order(std::int64_t utime_us, const MapOrder& order);
  /// An LCM message of the sensor as it was sent.
  void message(std::int64_t utime_us, std::string_view channel, std::span<const std::uint8_t> data);
  void nmea(std::int64_t utime_us, std::string_view sentences);

  /// Hands what was written to the system; call it once a second.
  void flush();
  /// Ends the recording; false when not all of it is on the disk.
  [[nodiscard]] bool close();

  [[nodiscard]] RecorderState state() const noexcept { return state_; }
  /// The state for a person: what happened and what to do.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::uint64_t bytes() const noexcept { return log_.bytes(); }
  [[nodiscard]] std::uint64_t events() const noexcept { return log_.events(); }
  /// Events that came after the recording had ended, or were too long.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  Recorder(EventLogWriter log, const RecorderConfig& config) : log_(std::move(log)), config_(config) {}
  void write(std::int64_t utime_us, std::string_view channel, std::span<const std::uint8_t> data);
  void write_text(std::int64_t utime_us, std::string_view channel, std::string_view text);

  EventLogWriter log_;
  RecorderConfig config_;
  RecorderState state_ = RecorderState::Recording;
  std::uint64_t dropped_ = 0;
  std::vector<std::uint8_t> encoded_;
};

/// A recording of the running sensor: the tape that the scan thread writes, and everything that the publish
/// thread sends, in one file. Made and ended by the supervisor; the publish thread saves.
class RecordingSession final : public MessageTap, public EpochSink {
 public:
  /// Takes `recorder` over. `utc_ahead` is by how much UTC is ahead of the monotonic clock.
  explicit RecordingSession(Recorder recorder, std::filesystem::path path);

  /// Scan thread: written to by the taps on its links.
  [[nodiscard]] TapeWriter& tape() noexcept { return tape_; }

  /// Publish thread: what the tape holds goes to the file.
  void save(std::int64_t utime_us);
  /// Supervisor: an order to the map, before scan `scan` of the recording.
  void order(std::int64_t utime_us, const MapOrder& order);
  /// Supervisor, when neither scan nor publish thread use it any more: ends tape and file. The text says what
  /// became of it.
  [[nodiscard]] std::string finish(std::int64_t utime_us);

  /// Any thread: "recording to FILE, 123456 bytes".
  [[nodiscard]] std::string text() const;
  [[nodiscard]] bool is_recording() const;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

  void published(std::string_view channel, std::span<const std::uint8_t> bytes) noexcept override;

  void step(hal::Stamp) noexcept override {}
  void send(std::span<const char> epoch, const OutputTime& now) noexcept override;
  [[nodiscard]] std::size_t poll_on(std::span<pollfd>) const noexcept override { return 0; }
  [[nodiscard]] std::string_view problem() const noexcept override { return {}; }
  [[nodiscard]] std::span<const hal::Counter> counters() const noexcept override { return {}; }

 private:
  static constexpr std::size_t kChunksInFlight = 32;  // 1 MB: half a minute of a 20 kHz rangefinder

  std::filesystem::path path_;
  TapeRing ring_{kChunksInFlight};
  TapeWriter tape_{ring_};
  mutable std::mutex mutex_;
  Recorder recorder_;
  std::int64_t utime_us_ = 0;  // of the publish thread's present turn
};

}  // namespace slamsensor::firmware
