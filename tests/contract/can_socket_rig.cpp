// CanSocket held to the contract on the interface that SLAMSENSOR_TEST_CAN names. It is taken down and up:
// root.
#include "hal/transport/can_socket.hpp"
#include "tests/contract/can_link_contract.hpp"
#include "tests/contract/raw_can.hpp"
#include "tests/contract/real_rig.hpp"

#include <algorithm>

namespace slamsensor::tests {
namespace {

class CanSocketRig final : public RealRig<CanLinkRig> {
 public:
  explicit CanSocketRig(const std::string& interface) : interface_(interface), peer_(interface) {
    hal::CanConfig config;
    config.interface = interface;
    auto socket = hal::CanSocket::create(config);
    if (!socket) {
      throw std::runtime_error(socket.error().message);
    }
    socket_ = std::move(*socket);
  }

  hal::CanLink& link() override { return *socket_; }

  void peer_send(const hal::CanFrame& frame) override {
    can_frame raw{};
    raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
    raw.len = frame.size;
    std::copy_n(frame.data.begin(), frame.size, raw.data);
    peer_.send(raw);
  }

  std::vector<hal::CanFrame> peer_receive() override {
    std::vector<hal::CanFrame> frames;
    while (const std::optional<can_frame> raw = peer_.receive()) {
      hal::CanFrame& frame = frames.emplace_back();
      frame.id = raw->can_id & CAN_EFF_MASK;
      frame.extended = (raw->can_id & CAN_EFF_FLAG) != 0;
      frame.size = raw->len;
      std::copy_n(raw->data, std::min<std::size_t>(raw->len, 8), frame.data.begin());
    }
    return frames;
  }

  void cut() override { ip_link("set " + interface_ + " down"); }
  void restore() override { ip_link("set " + interface_ + " up"); }

 private:
  std::string interface_;
  RawCan peer_;
  std::unique_ptr<hal::CanSocket> socket_;
};

MadeRig<CanLinkRig> make_can_socket_rig() {
  const char* const interface = std::getenv("SLAMSENSOR_TEST_CAN");
  if (interface == nullptr) {
    return tl::unexpected<std::string>("no CAN interface: run tests/system/run");
  }
  return std::make_unique<CanSocketRig>(interface);
}

INSTANTIATE_TEST_SUITE_P(Real, CanLinkContract,
                         testing::Values(CanLinkRigMaker{"CanSocket", make_can_socket_rig}), RigName());

}  // namespace
}  // namespace slamsensor::tests
