#pragma once

#include "hal/transport/can_link.hpp"
#include "tools/emulator/lateness.hpp"
#include "tools/emulator/memory_can_bus.hpp"

#include <cstddef>
#include <cstdint>

namespace slamsensor::tools {

/// Emulated devices on a CAN interface: their bus in memory, on which they arbitrate and hear each other, and
/// a link to the interface, joined. While the bus's interfaces are "down" nothing passes either way.
class CanPort {
 public:
  /// Both outlive this.
  CanPort(MemoryCanBus& bus, hal::CanLink& link);

  /// Puts what has come over the bus at `now` on the interface, and what came from there on the bus. The bus
  /// was advanced to `now`; `late` counts each frame. `real_now` is the same moment on CLOCK_MONOTONIC.
  void exchange(Stamp now, Stamp real_now, Lateness& late);

  /// Frames that the interface or the bus had no room for.
  [[nodiscard]] std::uint64_t lost_frames() const noexcept { return lost_frames_; }

 private:
  MemoryCanBus& bus_;
  hal::CanLink& link_;
  std::size_t host_;
  std::uint64_t lost_frames_ = 0;
};

}  // namespace slamsensor::tools
