#pragma once

#include "hal/transport/byte_link.hpp"
#include "hal/transport/can_link.hpp"
#include "tools/emulator/emulated_head.hpp"
#include "tools/emulator/memory_can_link.hpp"
#include "tools/emulator/memory_link.hpp"

#include <memory>

namespace slamsensor::tools {

/// An EmulatedHead with links for the drivers of its devices, all in simulated time:
///
///     auto run = InProcessHead::create(scenario);              // refused: error().message
///     hal::Ptu ptu(*(*run)->ptu_bytes(), config);              // a driver on its link
///     while ((*run)->now() < end) {
///       (*run)->advance((*run)->now() + std::chrono::milliseconds(1));
///       ptu.step((*run)->now());
///       if (scan_has_ended) (*run)->head().next_stand();
///     }
class InProcessHead {
 public:
  [[nodiscard]] static tl::expected<std::unique_ptr<InProcessHead>, WorldError> create(
      const Scenario& scenario);
  [[nodiscard]] static tl::expected<std::unique_ptr<InProcessHead>, WorldError> create(
      const Scenario& scenario, const DeviceMaker& make);

  [[nodiscard]] EmulatedHead& head() noexcept { return *head_; }
  [[nodiscard]] Stamp now() const noexcept { return head_->clock().now; }

  /// Everything up to `now` has happened; what has arrived by then can be read from the links.
  void advance(Stamp now) { head_->advance(now); }

  /// The link to a device: bytes or CAN frames, the other one null.
  [[nodiscard]] hal::ByteLink* ptu_bytes() noexcept { return ptu_bytes_.get(); }
  [[nodiscard]] hal::CanLink* ptu_can() noexcept { return ptu_can_.get(); }
  [[nodiscard]] hal::ByteLink* rangefinder_bytes() noexcept { return rangefinder_bytes_.get(); }
  [[nodiscard]] hal::CanLink* rangefinder_can() noexcept { return rangefinder_can_.get(); }

 private:
  InProcessHead(std::unique_ptr<EmulatedHead> head, const Scenario& scenario);

  std::unique_ptr<EmulatedHead> head_;
  std::unique_ptr<MemoryLink> ptu_bytes_;
  std::unique_ptr<MemoryLink> rangefinder_bytes_;
  std::unique_ptr<MemoryCanLink> ptu_can_;
  std::unique_ptr<MemoryCanLink> rangefinder_can_;
};

}  // namespace slamsensor::tools
