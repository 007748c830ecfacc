// The memory CAN link of the emulator held to the contract that the real socket is held to.
#include "tests/contract/can_link_contract.hpp"
#include "tools/emulator/memory_can_bus.hpp"

#include <utility>

namespace slamsensor::tests {
namespace {

using tools::MemoryCanBus;
using tools::MemoryCanLink;

/// Another node: keeps what it hears.
class Peer final : public tools::EmulatedCanDevice {
 public:
  void advance(hal::Stamp) override {}
  [[nodiscard]] hal::Stamp next_event() const override { return hal::kNever; }
  bool inject(const tools::Fault&) override { return false; }
  void receive(const hal::CanFrame& frame, hal::Stamp) override { heard.push_back(frame); }

  std::vector<hal::CanFrame> heard;
};

class MemoryCanRig final : public CanLinkRig {
 public:
  MemoryCanRig() { bus_.attach(sink_, peer_); }

  [[nodiscard]] hal::Stamp now() const override { return clock_.now; }
  [[nodiscard]] hal::Stamp stamping_clock() const override { return clock_.now; }
  void pass(hal::Stamp time) override {
    bus_.advance(clock_.now + time);
    clock_.now += time;
  }

  [[nodiscard]] hal::CanLink& link() override { return link_; }
  void peer_send(const hal::CanFrame& frame) override { sink_.send(frame, clock_.now); }
  [[nodiscard]] std::vector<hal::CanFrame> peer_receive() override { return std::exchange(peer_.heard, {}); }
  [[nodiscard]] bool promises_no_heap() const override { return false; }

  void cut() override {
    static_cast<void>(bus_.inject({tools::FaultKind::InterfaceDown, clock_.now, std::chrono::hours(24)}));
  }
  void restore() override { bus_.come_up(); }

 private:
  tools::SimClock clock_;
  MemoryCanBus bus_;
  tools::FrameSink& sink_ = bus_.add_device_node();
  Peer peer_;
  MemoryCanLink link_{bus_, clock_};
};

MadeRig<CanLinkRig> make_memory_rig() {
  return std::make_unique<MemoryCanRig>();
}

INSTANTIATE_TEST_SUITE_P(Memory, CanLinkContract, testing::Values(CanLinkRigMaker{"Bus", make_memory_rig}),
                         RigName());

}  // namespace
}  // namespace slamsensor::tests
