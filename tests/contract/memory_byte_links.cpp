// The memory link of the emulator held to the contract that the real serial port is held to: without delay
// and through a USB adapter that hands over every 16 ms.
#include "tests/contract/byte_link_contract.hpp"
#include "tools/emulator/emulated_port.hpp"

namespace slamsensor::tests {
namespace {

using tools::EmulatedPort;
using tools::MemoryLink;
using tools::MemoryLinkConfig;

/// The far end: keeps what it hears.
class Peer final : public tools::EmulatedSerialDevice {
 public:
  void advance(hal::Stamp) override {}
  [[nodiscard]] hal::Stamp next_event() const override { return hal::kNever; }
  bool inject(const tools::Fault&) override { return false; }
  void receive(std::uint8_t byte, hal::Stamp) override { heard.push_back(byte); }
  [[nodiscard]] std::uint32_t baud() const override { return line_rate; }

  Bytes heard;
  std::uint32_t line_rate = kBaud;

  static constexpr std::uint32_t kBaud = 115'200;
};

class MemoryRig final : public ByteLinkRig {
 public:
  explicit MemoryRig(hal::Stamp batch) : link_(port_, clock_, config_of(batch)) { port_.attach(peer_); }

  [[nodiscard]] hal::Stamp now() const override { return clock_.now; }
  [[nodiscard]] hal::Stamp stamping_clock() const override { return clock_.now; }
  void pass(hal::Stamp time) override {
    port_.advance(clock_.now + time);
    clock_.now += time;
  }

  [[nodiscard]] hal::ByteLink& link() override { return link_; }
  void peer_write(std::span<const std::uint8_t> bytes) override { port_.send(bytes, clock_.now); }
  [[nodiscard]] Bytes peer_read() override { return std::exchange(peer_.heard, {}); }
  void set_peer_baud(std::uint32_t baud) override { peer_.line_rate = baud; }
  [[nodiscard]] bool promises_no_heap() const override { return false; }

  void cut() override {
    static_cast<void>(port_.inject({tools::FaultKind::CableOut, clock_.now, std::chrono::hours(24)}));
  }
  void restore() override {
    port_.plug_in();
    peer_.line_rate = Peer::kBaud;
  }

 private:
  static MemoryLinkConfig config_of(hal::Stamp batch) {
    MemoryLinkConfig config;
    config.baud = Peer::kBaud;
    config.batch = batch;
    return config;
  }

  tools::SimClock clock_;
  EmulatedPort port_{1};
  Peer peer_;
  MemoryLink link_;
};

MadeRig<ByteLinkRig> make_direct_rig() {
  return std::make_unique<MemoryRig>(hal::Stamp{});
}

MadeRig<ByteLinkRig> make_batching_rig() {
  return std::make_unique<MemoryRig>(std::chrono::milliseconds(16));
}

INSTANTIATE_TEST_SUITE_P(Memory, ByteLinkContract,
                         testing::Values(ByteLinkRigMaker{"Direct", make_direct_rig},
                                         ByteLinkRigMaker{"Batching", make_batching_rig}),
                         RigName());

}  // namespace
}  // namespace slamsensor::tests
