#include "firmware/daemon/scan_queue.hpp"

#include <algorithm>

namespace slamsensor::firmware {
namespace {

// Beginnings, ends and abortions of scans that may lie in the queue beside scanlines.
constexpr std::size_t kBracketsMax = 16;

}  // namespace

// One reading more than twice a line: a line then always fits into an empty buffer, wherever it stands.
ScanQueue::ScanQueue(std::size_t scanlines, std::size_t readings_per_line_max)
    : readings_(2 * readings_per_line_max + 1), entries_(scanlines + kBracketsMax) {
}

bool ScanQueue::push(const HeadEvent& event, hal::Stamp now) noexcept {
  if (const auto* line = std::get_if<Scanline>(&event)) {
    const bool has_room = push_line(*line);
    scanlines_dropped_ += has_room ? 0 : 1;
    return has_room;
  }
  Entry entry;
  if (const auto* begun = std::get_if<ScanBegun>(&event)) {
    entry = *begun;
  } else if (const auto* ended = std::get_if<ScanEnded>(&event)) {
    entry = QueuedEnd{*ended, now};
  } else {
    entry = std::get<ScanAborted>(event);
  }
  const bool has_room = entries_.push(entry);
  messages_dropped_ += has_room ? 0 : 1;
  return has_room;
}

bool ScanQueue::push_line(const Scanline& line) noexcept {
  const auto first = room_for(line.readings.size());
  if (!first || entries_.write_available() <= kBracketsMax) {
    return false;
  }
  std::copy(line.readings.begin(), line.readings.end(),
            readings_.begin() + static_cast<std::ptrdiff_t>(*first));
  write_ = *first + line.readings.size();
  return entries_.push(Place{*first, line.readings.size(), line.line});
}

/// Free readings in a row: behind the last line, else at the front. `write_ == read_` means empty, so a line
/// never ends where the oldest one begins.
std::optional<std::size_t> ScanQueue::room_for(std::size_t count) const noexcept {
  const std::size_t read = read_.load(std::memory_order_acquire);
  if (write_ >= read) {
    if (readings_.size() - write_ >= count) {
      return write_;
    }
    return read > count ? std::optional<std::size_t>(0) : std::nullopt;
  }
  return read - write_ > count ? std::optional(write_) : std::nullopt;
}

std::optional<ScanItem> ScanQueue::take() noexcept {
  if (release_) {
    read_.store(*release_, std::memory_order_release);
    release_.reset();
  }
  Entry entry;
  if (!entries_.pop(entry)) {
    return std::nullopt;
  }
  if (const auto* place = std::get_if<Place>(&entry)) {
    release_ = place->first + place->count;
    return QueuedScanline{{readings_.data() + place->first, place->count}, place->line};
  }
  if (const auto* begun = std::get_if<ScanBegun>(&entry)) {
    return *begun;
  }
  if (const auto* ended = std::get_if<QueuedEnd>(&entry)) {
    return *ended;
  }
  return std::get<ScanAborted>(entry);
}

}  // namespace slamsensor::firmware
