#include "hal/transport/serial_port.hpp"

#include "tests/contract/pseudo_terminal.hpp"

#include <gmock/gmock.h>

#include <asm/termbits.h>
#include <functional>
#include <optional>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <vector>

namespace slamsensor::hal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::PseudoTerminal;

std::unique_ptr<SerialPort> make(const SerialConfig& config) {
  auto port = SerialPort::create(config);
  return port ? std::move(*port) : nullptr;
}

std::unique_ptr<SerialPort> make(const std::string& path) {
  SerialConfig config;
  config.path = path;
  return make(config);
}

std::string refusal(const SerialConfig& config) {
  const auto port = SerialPort::create(config);
  return port ? "" : port.error().message;
}

/// Why a port at `path` does not open.
std::string problem_at(const std::string& path) {
  const auto port = make(path);
  port->service(std::chrono::seconds(1));
  EXPECT_FALSE(port->is_up());
  EXPECT_EQ(port->fd(), -1);
  return std::string(port->problem());
}

std::uint64_t counted(const SerialPort& port, SerialEvent event) {
  return port.counters()[static_cast<std::size_t>(event)].value;
}

TEST(SerialPort, RefusesWhatCannotBeRight) {
  SerialConfig good;
  good.path = "/dev/ptu";
  EXPECT_EQ(refusal(good), "");
  SerialConfig config = good;
  config.path = "ttyS0";
  EXPECT_THAT(refusal(config), HasSubstr("serial port \"ttyS0\": the path must start with /"));
  config.path = "/" + std::string(kDeviceNameMax, 'x');
  EXPECT_THAT(refusal(config), HasSubstr("at most 160 characters"));
  config = good;
  config.line.baud = 0;
  EXPECT_THAT(refusal(config), HasSubstr("0 baud is not within"));
  config = good;
  config.line.format.data_bits = 5;
  EXPECT_THAT(refusal(config), HasSubstr("5 data bits: only 7 or 8"));
  config = good;
  config.line.format.stop_bits = 0;
  EXPECT_THAT(refusal(config), HasSubstr("0 stop bits: only 1 or 2"));
  config = good;
  config.rs485 = Rs485Config{.delay_before_send_ms = 1001};
  EXPECT_THAT(refusal(config), HasSubstr("RS-485 delay is above 1000 ms"));
  config = good;
  config.reopen.first = Stamp{};
  EXPECT_THAT(refusal(config), HasSubstr("waits before reopening"));
}

TEST(SerialPort, SaysWhyItIsNotOpenAndWhatToDo) {
  EXPECT_THAT(problem_at("/dev/no_such_port"),
              AllOf(HasSubstr("serial port /dev/no_such_port: open: No such file or directory"),
                    HasSubstr("plug it in")));
  EXPECT_THAT(problem_at("/dev/null"),
              AllOf(HasSubstr("/dev/null: not a terminal"), HasSubstr("name a terminal")));
  EXPECT_THAT(problem_at("/dev"), HasSubstr("/dev: open: Is a directory"));
}

TEST(SerialPort, TheWordsOfALongNameAreNotCut) {
  const std::string path = "/dev/" + std::string(kDeviceNameMax - 5, 'x');
  EXPECT_THAT(problem_at(path), testing::EndsWith("correct its name in the configuration"));
}

TEST(SerialPort, AllowsNobodyElse) {
  const PseudoTerminal terminal;
  const auto first = make(terminal.path());
  first->service(std::chrono::seconds(1));
  ASSERT_TRUE(first->is_up());
  EXPECT_THAT(first->problem(), IsEmpty());
  EXPECT_THAT(problem_at(terminal.path()), HasSubstr("another program has it: stop that program"));
  EXPECT_TRUE(first->is_up());
}

/// Whether the terminal is marked as one that nobody else may open; nothing when the kernel does not say.
std::optional<bool> is_marked(int fd) {
  int is_exclusive = 0;
  return ::ioctl(fd, TIOCGEXCL, &is_exclusive) == 0 ? std::optional(is_exclusive != 0) : std::nullopt;
}

/// A terminal that something else holds open while a port on it comes up and is closed again.
class HeldTerminal {
 public:
  HeldTerminal() : holder_(::open(terminal_.path().c_str(), O_RDWR | O_NOCTTY)) { EXPECT_GE(holder_, 0); }
  HeldTerminal(const HeldTerminal&) = delete;
  HeldTerminal& operator=(const HeldTerminal&) = delete;
  ~HeldTerminal() { ::close(holder_); }

  void use(const std::function<void()>& while_up) const {
    const auto port = make(terminal_.path());
    port->service(std::chrono::seconds(1));
    EXPECT_TRUE(port->is_up());
    while_up();
  }
  [[nodiscard]] int fd() const { return holder_; }

 private:
  PseudoTerminal terminal_;
  int holder_;
};

// A mark would outlive an owner that is killed, and lock out the next one.
TEST(SerialPort, LeavesNoMarkOnAPseudoTerminal) {
  const HeldTerminal terminal;
  terminal.use([&] { EXPECT_EQ(is_marked(terminal.fd()), false); });
  EXPECT_EQ(is_marked(terminal.fd()), false);
}

TEST(SerialPort, IsFreeAgainWhenItIsClosedEvenIfAnotherHoldsTheTerminalOpen) {
  const HeldTerminal terminal;
  terminal.use([&] { EXPECT_NE(::flock(terminal.fd(), LOCK_EX | LOCK_NB), 0); });
  EXPECT_EQ(::flock(terminal.fd(), LOCK_EX | LOCK_NB), 0);
}

/// What another program does to a terminal that it has open.
void meddle(const PseudoTerminal& terminal, const std::function<void(termios2&)>& change) {
  termios2 settings{};
  ASSERT_EQ(::ioctl(terminal.master(), TCGETS2, &settings), 0);
  change(settings);
  ASSERT_EQ(::ioctl(terminal.master(), TCSETS2, &settings), 0);
}

TEST(SerialPort, WhatAnotherProgramMakesOfItsSettingsIsUndone) {
  const std::vector<std::function<void(termios2&)>> changes = {
      [](termios2& settings) {
        settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD | (CBAUD << IBSHIFT));
        settings.c_cflag |= B38400;
      },
      [](termios2& settings) { settings.c_lflag |= ICANON | ECHO; },
      [](termios2& settings) { settings.c_iflag |= ICRNL | IXON; },
      [](termios2& settings) { settings.c_oflag |= OPOST; },
      [](termios2& settings) { settings.c_cc[VMIN] = 0; },
  };
  const PseudoTerminal terminal;
  const auto port = make(terminal.path());
  Stamp now = std::chrono::seconds(1);
  port->service(now);
  ASSERT_TRUE(port->is_up());
  ASSERT_EQ(port->set_baud(115'200), LinkStatus::Ok);
  std::uint64_t restored = 0;
  for (const auto& change : changes) {
    meddle(terminal, change);
    now += std::chrono::milliseconds(100);
    port->service(now);
    EXPECT_EQ(counted(*port, SerialEvent::SettingsRestored), ++restored);
    EXPECT_TRUE(has_settings(port->fd(), {115'200, {}}));
    now += std::chrono::milliseconds(100);
    port->service(now);
    EXPECT_EQ(counted(*port, SerialEvent::SettingsRestored), restored) << "they are right now";
  }
  EXPECT_EQ(port->epoch(), 1U);
}

// A stable name that leads to another adapter while the old one stays plugged in and is silent: the old one
// was asked for ever.
TEST(SerialPort, FollowsItsNameToAnotherDevice) {
  PseudoTerminal terminal;
  PseudoTerminal other;
  const auto port = make(terminal.path());
  Stamp now = std::chrono::seconds(1);
  port->service(now);
  ASSERT_TRUE(port->is_up());
  port->service(now += std::chrono::seconds(2));
  ASSERT_EQ(port->epoch(), 1U) << "the name is where it was";
  std::filesystem::remove(terminal.path());
  port->service(now += std::chrono::seconds(2));
  ASSERT_EQ(port->epoch(), 1U) << "a name that leads nowhere says nothing of the device";
  std::filesystem::create_symlink(std::filesystem::read_symlink(other.path()), terminal.path());
  port->service(now += std::chrono::seconds(2));
  EXPECT_EQ(counted(*port, SerialEvent::NameMoved), 1U);
  EXPECT_THAT(std::string(port->problem()), HasSubstr("its name leads to another device now"));
  port->service(now += std::chrono::seconds(1));
  ASSERT_TRUE(port->is_up());
  ASSERT_EQ(port->write(std::array<std::uint8_t, 1>{0x55}), LinkStatus::Ok);
  EXPECT_EQ(other.read().size(), 1U);
}

TEST(SerialPort, SetsTheTerminal) {
  const PseudoTerminal terminal;
  SerialConfig config;
  config.path = terminal.path();
  config.line.baud = 115'200;
  config.line.format.stop_bits = 2;
  const auto port = make(config);
  port->service(std::chrono::seconds(1));
  ASSERT_TRUE(port->is_up());
  termios2 settings{};
  ASSERT_EQ(::ioctl(port->fd(), TCGETS2, &settings), 0);
  EXPECT_EQ(settings.c_ospeed, 115'200U);
  EXPECT_EQ(settings.c_ispeed, 115'200U);
  EXPECT_EQ(settings.c_cflag & (CSIZE | CSTOPB | PARENB), tcflag_t{CS8 | CSTOPB});
  EXPECT_EQ(settings.c_cflag & (HUPCL | CLOCAL | CREAD), tcflag_t{CLOCAL | CREAD});
  EXPECT_EQ(settings.c_iflag & (IXON | IXOFF | ICRNL | INLCR | IGNCR | ISTRIP | PARMRK), 0U);
  EXPECT_EQ(settings.c_oflag & OPOST, 0U);
  EXPECT_EQ(settings.c_lflag & (ICANON | ECHO | ISIG | IEXTEN), 0U);
}

TEST(SerialPort, ARateIsReadBackByTheFarEnd) {
  const PseudoTerminal terminal;
  const auto port = make(terminal.path());
  port->service(std::chrono::seconds(1));
  for (const std::uint32_t baud : {1'000'000U, 256'000U, 12'345U}) {  // the last two are none of termios
    EXPECT_EQ(port->set_baud(baud), LinkStatus::Ok);
    EXPECT_EQ(port->baud(), baud);
    termios2 settings{};
    ASSERT_EQ(::ioctl(terminal.master(), TCGETS2, &settings), 0);
    EXPECT_EQ(settings.c_ospeed, baud);
  }
}

TEST(SerialPort, WhatAPseudoTerminalRefusesIsCountedAndNotFatal) {
  const PseudoTerminal terminal;
  SerialConfig config;
  config.path = terminal.path();
  config.rs485 = Rs485Config{};
  config.line.format = {7, SerialParity::Even, 1};
  const auto port = make(config);
  port->service(std::chrono::seconds(1));
  EXPECT_TRUE(port->is_up()) << port->problem();
  EXPECT_EQ(counted(*port, SerialEvent::LowLatencyRefused), 1U);
  EXPECT_EQ(counted(*port, SerialEvent::Rs485Refused), 1U);
}

TEST(SerialPort, DoesNotStartWithWhatCameBeforeIt) {
  PseudoTerminal terminal;
  const int holder = ::open(terminal.path().c_str(), O_RDWR | O_NOCTTY);
  terminal.write(std::vector<std::uint8_t>{'o', 'l', 'd', '\n'});
  const auto port = make(terminal.path());
  port->service(std::chrono::seconds(1));
  std::array<std::uint8_t, 8> into{};
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(port->read(into).status, LinkStatus::Busy);
  }
  ::close(holder);
}

TEST(SerialPort, AnOversizedWriteIsRefusedAndCounted) {
  const PseudoTerminal terminal;
  const auto port = make(terminal.path());
  port->service(std::chrono::seconds(1));
  EXPECT_EQ(port->write(std::vector<std::uint8_t>(SerialPort::kWriteMax + 1)), LinkStatus::Busy);
  EXPECT_EQ(counted(*port, SerialEvent::OversizedWrite), 1U);
  EXPECT_EQ(port->write({}), LinkStatus::Ok);
  EXPECT_TRUE(port->is_up());
}

TEST(SerialPort, NoticesAHangUpWithoutReading) {
  PseudoTerminal terminal;
  const auto port = make(terminal.path());
  port->service(std::chrono::seconds(1));
  terminal.write(std::vector<std::uint8_t>{1, 2, 3});
  terminal.unplug();
  port->service(std::chrono::seconds(1));
  EXPECT_FALSE(port->is_up());
  EXPECT_EQ(counted(*port, SerialEvent::HangUp), 1U);
  EXPECT_THAT(std::string(port->problem()), HasSubstr("hung up; check plug and cable"));
}

TEST(SerialPort, NoticesAHangUpWhenItReads) {
  PseudoTerminal terminal;
  const auto port = make(terminal.path());
  port->service(std::chrono::seconds(1));
  terminal.unplug();
  std::array<std::uint8_t, 8> into{};
  EXPECT_EQ(port->read(into).status, LinkStatus::Down);
  EXPECT_EQ(counted(*port, SerialEvent::HangUp), 1U);
}

TEST(SerialPort, NoticesAHangUpWhenItWrites) {
  PseudoTerminal terminal;
  const auto port = make(terminal.path());
  port->service(std::chrono::seconds(1));
  terminal.unplug();
  EXPECT_EQ(port->write(std::vector<std::uint8_t>{1}), LinkStatus::Down);
  EXPECT_EQ(counted(*port, SerialEvent::HangUp), 1U);
}

}  // namespace
}  // namespace slamsensor::hal
