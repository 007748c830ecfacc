#include "tools/recording/event_log_reader.hpp"

#include "firmware/recording/big_endian.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

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
  offset_ += is_followed ? head.size() : bytes.size();
  last_number_ = head.number;
  truncated_at_.reset();
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

}  // namespace slamsensor::tools
