#include "tests/rt/taped_links.hpp"

#include <algorithm>

namespace slamsensor::tests {
namespace {

/// The next of `list`, or `otherwise` beyond its end.
template <typename T>
T next(const std::vector<T>& list, std::size_t& place, std::size_t& beyond, const T& otherwise) noexcept {
  if (place == list.size()) {
    ++beyond;
    return otherwise;
  }
  return list[place++];
}

}  // namespace

void RecordingByteLink::service(hal::Stamp now) noexcept {
  link_.service(now);
  tape_.states.push_back({link_.is_up(), link_.epoch(), link_.baud()});
}

hal::ByteRead RecordingByteLink::read(std::span<std::uint8_t> into) noexcept {
  const hal::ByteRead read = link_.read(into);
  const std::size_t count = read.status == hal::LinkStatus::Ok ? read.count : 0;
  tape_.reads.push_back({read.status, count, read.stamp});
  tape_.bytes.insert(tape_.bytes.end(), into.begin(), into.begin() + static_cast<std::ptrdiff_t>(count));
  return read;
}

hal::LinkStatus RecordingByteLink::write(std::span<const std::uint8_t> bytes) noexcept {
  return tape_.writes.emplace_back(link_.write(bytes));
}

hal::LinkStatus RecordingByteLink::set_baud(std::uint32_t baud) noexcept {
  return tape_.bauds.emplace_back(link_.set_baud(baud));
}

void RecordingCanLink::service(hal::Stamp now) noexcept {
  link_.service(now);
  tape_.states.push_back({link_.is_up(), link_.epoch(), 0});
}

hal::CanRead RecordingCanLink::receive() noexcept {
  return tape_.frames.emplace_back(link_.receive());
}

hal::LinkStatus RecordingCanLink::send(const hal::CanFrame& frame) noexcept {
  return tape_.writes.emplace_back(link_.send(frame));
}

void ReplayedByteLink::service(hal::Stamp) noexcept {
  state_ = next(tape_.states, place_.states, beyond_, {});
}

hal::ByteRead ReplayedByteLink::read(std::span<std::uint8_t> into) noexcept {
  const LinkTape::Read read =
      next(tape_.reads, place_.reads, beyond_, LinkTape::Read{hal::LinkStatus::Down, 0, {}});
  const std::size_t count = std::min(read.count, into.size());
  std::copy_n(tape_.bytes.begin() + static_cast<std::ptrdiff_t>(place_.bytes), count, into.begin());
  place_.bytes += read.count;
  return {read.status, count, read.stamp};
}

hal::LinkStatus ReplayedByteLink::write(std::span<const std::uint8_t>) noexcept {
  return next(tape_.writes, place_.writes, beyond_, hal::LinkStatus::Down);
}

hal::LinkStatus ReplayedByteLink::set_baud(std::uint32_t baud) noexcept {
  const hal::LinkStatus status = next(tape_.bauds, place_.bauds, beyond_, hal::LinkStatus::Down);
  if (status == hal::LinkStatus::Ok) {
    state_.baud = baud;
  }
  return status;
}

void ReplayedCanLink::service(hal::Stamp) noexcept {
  state_ = next(tape_.states, place_.states, beyond_, {});
}

hal::CanRead ReplayedCanLink::receive() noexcept {
  return next(tape_.frames, place_.frames, beyond_, hal::CanRead{hal::LinkStatus::Down, {}, {}});
}

hal::LinkStatus ReplayedCanLink::send(const hal::CanFrame&) noexcept {
  return next(tape_.writes, place_.writes, beyond_, hal::LinkStatus::Down);
}

}  // namespace slamsensor::tests
