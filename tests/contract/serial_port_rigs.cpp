// SerialPort held to the contract on a pseudo-terminal and, where there are two serial lines wired to each
// other (SLAMSENSOR_TEST_SERIAL_ONE and _OTHER name them), on a UART.
#include "hal/transport/serial_port.hpp"
#include "tests/contract/byte_link_contract.hpp"
#include "tests/contract/pseudo_terminal.hpp"
#include "tests/contract/real_rig.hpp"

#include <cstdlib>
#include <filesystem>
#include <sys/ioctl.h>

namespace slamsensor::tests {
namespace {

std::unique_ptr<hal::SerialPort> make_port(const std::string& path, std::uint32_t baud) {
  hal::SerialConfig config;
  config.path = path;
  config.line.baud = baud;
  auto port = hal::SerialPort::create(config);
  if (!port) {
    throw std::runtime_error(port.error().message);
  }
  return std::move(*port);
}

class PseudoTerminalRig final : public RealRig<ByteLinkRig> {
 public:
  hal::ByteLink& link() override { return *port_; }
  void peer_write(std::span<const std::uint8_t> bytes) override { terminal_.write(bytes); }
  Bytes peer_read() override { return terminal_.read(); }
  void cut() override { terminal_.unplug(); }
  void restore() override { terminal_.plug_in(); }

 private:
  PseudoTerminal terminal_;
  std::unique_ptr<hal::SerialPort> port_ = make_port(terminal_.path(), 9600);
};

/// The device at the far end is a SerialPort too, by now known to be good. To unplug the line is to hang up
/// the terminal and take away its stable name.
class UartRig final : public RealRig<ByteLinkRig> {
 public:
  static constexpr std::uint32_t kBaud = 115'200;

  UartRig(const std::string& one, const std::string& other) : one_(one), peer_(make_port(other, kBaud)) {
    folder_.unplug();  // only its folder and name are wanted
    restore();
    peer_->service(now());
    if (!peer_->is_up()) {
      throw std::runtime_error(std::string(peer_->problem()));
    }
    peer_->discard_input();
  }
  ~UartRig() override { std::filesystem::remove(folder_.path()); }

  hal::ByteLink& link() override { return *port_; }

  void pass(hal::Stamp time) override {
    RealRig::pass(time);
    peer_->service(now());
  }
  void peer_write(std::span<const std::uint8_t> bytes) override {
    for (int i = 0; i < 1000 && peer_->write(bytes) != hal::LinkStatus::Ok; ++i) {
      pass(std::chrono::milliseconds(1));
    }
  }
  Bytes peer_read() override {
    Bytes bytes(4096);
    bytes.resize(peer_->read(bytes).count);
    return bytes;
  }
  void set_peer_baud(std::uint32_t baud) override {
    while (peer_->set_baud(baud) == hal::LinkStatus::Ok && !hal::has_sent_all(peer_->fd())) {
      pass(std::chrono::milliseconds(1));
    }
  }
  bool takes_baud(std::uint32_t baud) const override { return baud > 0 && baud <= kBaud; }

  void cut() override {
    std::filesystem::remove(folder_.path());
    const int fd = ::open(one_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0 || ::ioctl(fd, TIOCVHANGUP) != 0) {
      ADD_FAILURE() << "cannot hang up " << one_;
    }
    ::close(fd);
  }
  void restore() override { std::filesystem::create_symlink(one_, folder_.path()); }

 private:
  std::string one_;
  PseudoTerminal folder_;
  std::unique_ptr<hal::SerialPort> peer_;
  std::unique_ptr<hal::SerialPort> port_ = make_port(folder_.path(), kBaud);
};

MadeRig<ByteLinkRig> make_pseudo_terminal_rig() {
  return std::make_unique<PseudoTerminalRig>();
}

MadeRig<ByteLinkRig> make_uart_rig() {
  const char* const one = std::getenv("SLAMSENSOR_TEST_SERIAL_ONE");
  const char* const other = std::getenv("SLAMSENSOR_TEST_SERIAL_OTHER");
  if (one == nullptr || other == nullptr) {
    return tl::unexpected<std::string>("no two serial lines wired to each other: run tests/system/run");
  }
  return std::make_unique<UartRig>(one, other);
}

INSTANTIATE_TEST_SUITE_P(Real, ByteLinkContract,
                         testing::Values(ByteLinkRigMaker{"PseudoTerminal", make_pseudo_terminal_rig},
                                         ByteLinkRigMaker{"Uart", make_uart_rig}),
                         RigName());

}  // namespace
}  // namespace slamsensor::tests
