#include "firmware/recording/recorder.hpp"

#include <cstring>
#include <utility>

namespace slamsensor::firmware {

tl::expected<Recorder, hal::InitError> Recorder::create(const RecorderConfig& config) {
  return EventLogWriter::create(config.path, config.existing).map([&](EventLogWriter&& log) {
    return Recorder(std::move(log), config);
  });
}

void Recorder::write(std::int64_t utime_us, std::string_view channel, std::span<const std::uint8_t> data) {
  const std::size_t size = kEventHeadBytes + channel.size() + data.size();
  if (state_ == RecorderState::Recording && log_.bytes() + size > config_.bytes_max) {
    state_ = log_.flush() ? RecorderState::Full : RecorderState::Failed;
  }
  if (state_ != RecorderState::Recording || !log_.write(utime_us, channel, data)) {
    ++dropped_;
  }
  if (state_ == RecorderState::Recording && log_.error() != 0) {
    state_ = RecorderState::Failed;
  }
}

void Recorder::write_text(std::int64_t utime_us, std::string_view channel, std::string_view text) {
  encode(Text{utime_us, text}, encoded_);
  write(utime_us, channel, encoded_);
}

void Recorder::config(std::int64_t utime_us, std::string_view toml) {
  write_text(utime_us, kConfigChannel, toml);
}

void Recorder::map(std::int64_t utime_us, std::span<const std::uint8_t> file) {
  encode(Block{utime_us, 0, file}, encoded_);
  write(utime_us, kMapChannel, encoded_);
}

void Recorder::tape(std::int64_t utime_us, const TapeChunk& chunk) {
  encode(Block{utime_us, static_cast<std::int64_t>(chunk.number), chunk.bytes()}, encoded_);
  write(utime_us, kTapeChannel, encoded_);
}

void Recorder::order(std::int64_t utime_us, const MapOrder& order) {
  write_text(utime_us, kOrderChannel, text_of(order));
}

void Recorder::message(std::int64_t utime_us, std::string_view channel, std::span<const std::uint8_t> data) {
  write(utime_us, channel, data);
}

void Recorder::nmea(std::int64_t utime_us, std::string_view sentences) {
  write_text(utime_us, kNmeaChannel, sentences);
}

void Recorder::flush() {
  if (state_ == RecorderState::Recording && !log_.flush()) {
    state_ = RecorderState::Failed;
  }
}

bool Recorder::close() {
  const bool is_whole = log_.close();
  if (!is_whole) {
    state_ = RecorderState::Failed;
  } else if (state_ == RecorderState::Recording) {
    state_ = RecorderState::Closed;
  }
  return is_whole && state_ != RecorderState::Failed;
}

std::string Recorder::text() const {
  const std::string name = config_.path.string();
  switch (state_) {
    case RecorderState::Recording:
      return "recording to " + name;
    case RecorderState::Full:
      return "recording " + name + " ended: it has reached its largest size; raise record.size_max_mb";
    case RecorderState::Failed:
      return "recording " + name + " ended: " + std::strerror(log_.error()) +
             "; what was recorded up to then is kept; make room on the disk or record elsewhere";
    case RecorderState::Closed:
      break;
  }
  return "recording " + name + " is complete";
}

namespace {

std::int64_t microseconds(std::chrono::nanoseconds time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time).count();
}

}  // namespace

RecordingSession::RecordingSession(Recorder recorder, std::filesystem::path path)
    : path_(std::move(path)), recorder_(std::move(recorder)) {
}

void RecordingSession::save(std::int64_t utime_us) {
  const std::scoped_lock lock(mutex_);
  utime_us_ = utime_us;
  ring_.drain([&](const TapeChunk& chunk) { recorder_.tape(utime_us, chunk); });
}

void RecordingSession::order(std::int64_t utime_us, const MapOrder& order) {
  const std::scoped_lock lock(mutex_);
  recorder_.order(utime_us, order);
}

std::string RecordingSession::finish(std::int64_t utime_us) {
  save(utime_us);
  const bool is_whole = tape_.finish();
  save(utime_us);
  const std::scoped_lock lock(mutex_);
  const bool is_closed = recorder_.close();
  return recorder_.text() + (is_whole && is_closed && tape_.lost() == 0 ? "" : "; it is not whole") + ", " +
         std::to_string(recorder_.bytes()) + " bytes";
}

std::string RecordingSession::text() const {
  const std::scoped_lock lock(mutex_);
  return recorder_.text() + ", " + std::to_string(recorder_.bytes()) + " bytes";
}

bool RecordingSession::is_recording() const {
  const std::scoped_lock lock(mutex_);
  return recorder_.state() == RecorderState::Recording;
}

void RecordingSession::published(std::string_view channel, std::span<const std::uint8_t> bytes) noexcept {
  const std::scoped_lock lock(mutex_);
  recorder_.message(utime_us_, channel, bytes);
}

void RecordingSession::send(std::span<const char> epoch, const OutputTime& now) noexcept {
  const std::scoped_lock lock(mutex_);
  recorder_.nmea(microseconds(now.utc), {epoch.data(), epoch.size()});
}

}  // namespace slamsensor::firmware
