#pragma once

#include "firmware/lcm/lcm_sink.hpp"
#include "firmware/recording/recorder.hpp"
#include "firmware/recording/recording_links.hpp"
#include "firmware/recording/tape_writer.hpp"
#include "firmware/serving/epoch_sink.hpp"

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

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
