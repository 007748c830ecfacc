#include "tools/emulator/can_port.hpp"

namespace slamsensor::tools {
namespace {

constexpr int kFramesMax = 1000;  // of the interface in one exchange

}  // namespace

CanPort::CanPort(MemoryCanBus& bus, hal::CanLink& link) : bus_(bus), link_(link), host_(bus.add_host()) {
}

void CanPort::exchange(Stamp now, Stamp real_now, Lateness& late) {
  link_.service(real_now);
  while (const auto arrival = bus_.host_take(host_)) {
    late.count(now - arrival->at);
    lost_frames_ += link_.send(arrival->frame) == hal::LinkStatus::Ok ? 0U : 1U;
  }
  for (int i = 0; i < kFramesMax; ++i) {
    const hal::CanRead read = link_.receive();
    if (read.status != hal::LinkStatus::Ok) {
      return;
    }
    lost_frames_ += bus_.host_send(host_, read.frame, now) ? 0U : 1U;
  }
}

}  // namespace slamsensor::tools
