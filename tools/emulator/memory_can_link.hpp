#pragma once

#include "hal/transport/can_link.hpp"
#include "hal/transport/reopen.hpp"
#include "tools/emulator/memory_can_bus.hpp"
#include "tools/emulator/sim_clock.hpp"

#include <cstddef>
#include <cstdint>

namespace slamsensor::tools {

/// A host on a MemoryCanBus in simulated time, with the manners of a CAN socket: opened by service(), lost
/// with the interface or the bus, opened again with back-off. The bus was advanced to the clock's time before
/// each call. It hands out every frame.
class MemoryCanLink final : public hal::CanLink {
 public:
  /// Both outlive the link.
  MemoryCanLink(MemoryCanBus& bus, const SimClock& clock, const hal::ReopenConfig& reopen = {});

  void service(hal::Stamp now) noexcept override;
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return epoch_; }
  [[nodiscard]] bool is_up() const noexcept override { return up_; }
  [[nodiscard]] hal::CanRead receive() noexcept override;

  /// Down also for a frame that no CAN bus takes: an identifier or a size beyond its bits.
  [[nodiscard]] hal::LinkStatus send(const hal::CanFrame& frame) noexcept override;

 private:
  bool is_lost() noexcept;

  MemoryCanBus& bus_;
  const SimClock& clock_;
  std::size_t host_;
  hal::ReopenTimer timer_;
  std::uint32_t epoch_ = 0;
  std::uint32_t up_count_ = 0;  // of the bus when it was opened
  bool up_ = false;
};

}  // namespace slamsensor::tools
