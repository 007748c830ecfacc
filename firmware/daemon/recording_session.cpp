#include "firmware/daemon/recording_session.hpp"

#include <utility>

namespace slamsensor::firmware {
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
