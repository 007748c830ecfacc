#include "tools/emulator/memory_link.hpp"

#include <algorithm>
#include <array>

namespace slamsensor::tools {
namespace {

using hal::ByteRead;
using hal::LinkStatus;
using hal::Stamp;

constexpr std::uint32_t kBaudMin = 50;
constexpr std::uint32_t kBaudMax = 4'000'000;
constexpr std::size_t kTakenMax = 256;  // bytes moved at a time

}  // namespace

MemoryLink::MemoryLink(EmulatedPort& port, const SimClock& clock, const MemoryLinkConfig& config)
    : port_(port), clock_(clock), config_(config), timer_(config.reopen) {
}

bool MemoryLink::is_lost() noexcept {
  if (up_ && (!port_.is_plugged() || port_.plug_count() != plug_count_)) {
    up_ = false;
    timer_.lost(clock_.now);
  }
  return !up_;
}

void MemoryLink::service(Stamp now) noexcept {
  if (!is_lost() || !timer_.is_due(now)) {
    return;
  }
  if (!port_.is_plugged()) {
    timer_.failed(now);
    return;
  }
  up_ = true;
  ++epoch_;
  plug_count_ = port_.plug_count();
  timer_.opened(now);
  port_.host_discard();
  port_.set_host_baud(config_.baud);
}

Stamp MemoryLink::handed_over_until() const noexcept {
  return config_.batch > Stamp{} ? clock_.now - clock_.now % config_.batch : clock_.now;
}

ByteRead MemoryLink::read(std::span<std::uint8_t> into) noexcept {
  if (is_lost()) {
    return {LinkStatus::Down, 0, {}};
  }
  std::array<WireByte, kTakenMax> taken;
  std::size_t count = 0;
  while (count < into.size()) {
    const std::size_t room = std::min(into.size() - count, taken.size());
    const std::size_t got = port_.host_take({taken.data(), room}, handed_over_until());
    for (std::size_t i = 0; i < got; ++i) {
      into[count++] = taken[i].value;
    }
    if (got < room) {
      break;
    }
  }
  return {count > 0 ? LinkStatus::Ok : LinkStatus::Busy, count, clock_.now};
}

std::size_t MemoryLink::queued() const noexcept {
  constexpr Stamp::rep kNanosPerByte_baud = 10'000'000'000;  // ten bits
  const Stamp left = std::max(port_.host_busy_until() - clock_.now, Stamp{});
  const Stamp::rep bits = left.count() * static_cast<Stamp::rep>(config_.baud);
  return static_cast<std::size_t>((bits + kNanosPerByte_baud - 1) / kNanosPerByte_baud);
}

LinkStatus MemoryLink::write(std::span<const std::uint8_t> bytes) noexcept {
  if (is_lost()) {
    return LinkStatus::Down;
  }
  if (queued() + bytes.size() > config_.write_queue) {
    return LinkStatus::Busy;
  }
  port_.host_write(bytes, clock_.now);
  return LinkStatus::Ok;
}

LinkStatus MemoryLink::set_baud(std::uint32_t baud) noexcept {
  if (baud < kBaudMin || baud > kBaudMax) {
    return LinkStatus::Down;
  }
  config_.baud = baud;
  if (is_lost()) {
    return LinkStatus::Down;
  }
  port_.set_host_baud(baud);
  return LinkStatus::Ok;
}

void MemoryLink::discard_input() noexcept {
  if (!is_lost()) {
    port_.host_discard();
  }
}

}  // namespace slamsensor::tools
