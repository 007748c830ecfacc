#include "firmware/recording/recorder.hpp"

#include <cstring>

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
             "; make room on the disk or record elsewhere";
    case RecorderState::Closed:
      break;
  }
  return "recording " + name + " is complete";
}

}  // namespace slamsensor::firmware
