#include "firmware/daemon/handover.hpp"

#include <algorithm>
#include <variant>

namespace slamsensor::firmware {
namespace {

// Beginnings, ends and abortions of scans that may lie in the queue beside scanlines.
constexpr std::size_t kBracketsMax = 16;

}  // namespace

// One reading more than twice a line: a line then always fits into an empty buffer, wherever it stands.
ScanQueue::ScanQueue(std::size_t scanlines, std::size_t readings_per_line_max)
    : readings_(2 * readings_per_line_max + 1), entries_(scanlines + kBracketsMax) {
}

bool ScanQueue::push(const HeadEvent& event) noexcept {
  const auto* const line = std::get_if<Scanline>(&event);
  const bool has_room = line != nullptr ? push_line(*line) : entries_.push(event);
  if (!has_room) {
    ++(line != nullptr ? scanlines_dropped_ : messages_dropped_);
  }
  return has_room;
}

bool ScanQueue::push_line(Scanline line) noexcept {
  const auto first = room_for(line.readings.size());
  if (!first || entries_.write_available() <= kBracketsMax) {
    return false;
  }
  core::Reading* const room = readings_.data() + *first;
  std::copy(line.readings.begin(), line.readings.end(), room);
  line.readings = {room, line.readings.size()};
  line.stamps = {};
  write_ = *first + line.readings.size();
  return entries_.push(line);
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

std::optional<HeadEvent> ScanQueue::take() noexcept {
  if (release_) {
    read_.store(*release_, std::memory_order_release);
    release_.reset();
  }
  HeadEvent event;
  if (!entries_.pop(event)) {
    return std::nullopt;
  }
  if (const auto* const line = std::get_if<Scanline>(&event)) {
    release_ = static_cast<std::size_t>(line->readings.data() - readings_.data()) + line->readings.size();
  }
  return event;
}

}  // namespace slamsensor::firmware
