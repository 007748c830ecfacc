#include "tools/emulator/memory_can_link.hpp"

namespace slamsensor::tools {
namespace {

using hal::CanRead;
using hal::LinkStatus;

bool is_sendable(const hal::CanFrame& frame) noexcept {
  const std::uint32_t id_max = frame.extended ? 0x1FFF'FFFF : 0x7FF;
  return frame.id <= id_max && frame.size <= frame.data.size();
}

}  // namespace

MemoryCanLink::MemoryCanLink(MemoryCanBus& bus, const SimClock& clock, const hal::ReopenConfig& reopen)
    : bus_(bus), clock_(clock), host_(bus.add_host()), timer_(reopen) {
}

bool MemoryCanLink::is_lost() noexcept {
  if (up_ && (!bus_.is_host_up() || bus_.up_count() != up_count_)) {
    up_ = false;
    timer_.lost(clock_.now);
  }
  return !up_;
}

void MemoryCanLink::service(hal::Stamp now) noexcept {
  if (!is_lost() || !timer_.is_due(now)) {
    return;
  }
  if (!bus_.is_host_up()) {
    timer_.failed(now);
    return;
  }
  up_ = true;
  ++epoch_;
  up_count_ = bus_.up_count();
  timer_.opened(now);
  bus_.host_discard(host_);
}

CanRead MemoryCanLink::receive() noexcept {
  if (is_lost()) {
    return {LinkStatus::Down, {}, {}};
  }
  const auto arrival = bus_.host_take(host_);
  return arrival ? CanRead{LinkStatus::Ok, arrival->frame, arrival->at} : CanRead{};
}

LinkStatus MemoryCanLink::send(const hal::CanFrame& frame) noexcept {
  if (is_lost() || !is_sendable(frame)) {
    return LinkStatus::Down;
  }
  return bus_.host_send(host_, frame, clock_.now) ? LinkStatus::Ok : LinkStatus::Busy;
}

}  // namespace slamsensor::tools
