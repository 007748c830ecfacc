#pragma once

#include "hal/transport/can_link.hpp"
#include "tests/contract/rig.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace slamsensor::tests {

/// A link that was not serviced yet and lets every frame pass, and another node of its bus.
class CanLinkRig : public Rig {
 public:
  [[nodiscard]] virtual hal::CanLink& link() = 0;

  /// The other node sends; there is room.
  virtual void peer_send(const hal::CanFrame& frame) = 0;

  /// What the other node has received since the last call.
  [[nodiscard]] virtual std::vector<hal::CanFrame> peer_receive() = 0;

  /// Takes the link's interface down, and up again.
  virtual void cut() = 0;
  virtual void restore() = 0;

  /// Whether the link keeps hal's promise to take no memory; a simulated one need not.
  [[nodiscard]] virtual bool promises_no_heap() const { return true; }
};

using CanLinkRigMaker = RigMaker<CanLinkRig>;

/// The contract of hal::CanLink. To hold an implementation to it, instantiate this suite with a maker of its
/// rig: INSTANTIATE_TEST_SUITE_P(Name, CanLinkContract, testing::Values(CanLinkRigMaker{...}), RigName()).
class CanLinkContract : public testing::TestWithParam<CanLinkRigMaker> {
 protected:
  void SetUp() override;

  [[nodiscard]] hal::CanLink& link() { return rig_->link(); }

  /// Time passes, and the link is serviced.
  void step(hal::Stamp time = std::chrono::milliseconds(1));

  /// Steps by a millisecond until `done`, at most 5,000 times; whether it was.
  [[nodiscard]] bool step_until(const std::function<bool()>& done);

  void come_up();

  /// Waits for `count` frames at either end; what came, which is less when they do not come.
  [[nodiscard]] std::vector<hal::CanFrame> receive(std::size_t count);
  [[nodiscard]] std::vector<hal::CanFrame> peer_receive(std::size_t count);

  /// Sends, waiting while the link is busy.
  void send(const hal::CanFrame& frame);

  /// Cuts the bus and waits, receiving as a driver does, until the link knows.
  void cut_and_notice();

  std::unique_ptr<CanLinkRig> rig_;
};

}  // namespace slamsensor::tests
