#include "tests/unit/tools/emulator/small_devices.hpp"
#include "tools/emulator/real_time_head.hpp"

#include <gtest/gtest.h>

#include <array>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <memory>
#include <poll.h>
#include <string>
#include <termios.h>
#include <unistd.h>
#include <utility>

namespace slamsensor::tools {
namespace {

std::filesystem::path fresh_folder() {
  static int number = 0;
  const auto folder = std::filesystem::temp_directory_path() /
                      ("pseudo_terminal_test_" + std::to_string(::getpid()) + "_" + std::to_string(number++));
  std::filesystem::create_directories(folder);
  return folder;
}

/// A host that opens a port as a stranger's program would.
class Host {
 public:
  explicit Host(const std::filesystem::path& name)
      : fd_(::open(name.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {}
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;
  ~Host() { close(); }

  void close() {
    if (fd_ >= 0) {
      ::close(std::exchange(fd_, -1));
    }
  }
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  void set_speed(speed_t speed) const {
    termios settings{};
    ASSERT_EQ(::tcgetattr(fd_, &settings), 0);
    ::cfmakeraw(&settings);
    ::cfsetspeed(&settings, speed);
    ASSERT_EQ(::tcsetattr(fd_, TCSANOW, &settings), 0);
  }
  void write(const std::string& text) const {
    ASSERT_EQ(::write(fd_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  [[nodiscard]] std::string read() const {
    std::array<char, 256> bytes{};
    const ssize_t count = ::read(fd_, bytes.data(), bytes.size());
    return {bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0};
  }
  /// Everything written to the other end gets here before long.
  [[nodiscard]] std::string wait_for(std::size_t count) const {
    std::string text;
    for (int i = 0; i < 200 && text.size() < count; ++i) {
      pollfd state{fd_, POLLIN, 0};
      ::poll(&state, 1, 10);
      text += read();
    }
    return text;
  }
  [[nodiscard]] bool is_hung_up() const {
    pollfd state{fd_, POLLIN, 0};
    return ::poll(&state, 1, 0) > 0 && (state.revents & POLLHUP) != 0;
  }

 private:
  int fd_;
};

class PseudoTerminalTest : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ = fresh_folder();
  std::filesystem::path name_ = folder_ / "ptu0";
};

TEST_F(PseudoTerminalTest, ReportsWhetherAHostIsThereAndItsRate) {
  const auto made = PseudoTerminal::create(name_);
  ASSERT_TRUE(made.has_value()) << made.error().message;
  PseudoTerminal& terminal = **made;
  EXPECT_FALSE(terminal.has_host());
  EXPECT_EQ(terminal.host_baud(), 9600U);
  Host host(name_);
  ASSERT_TRUE(host.is_open());
  EXPECT_TRUE(terminal.has_host());
  host.set_speed(B115200);
  EXPECT_EQ(terminal.host_baud(), 115'200U);
  host.set_speed(B460800);
  EXPECT_EQ(terminal.host_baud(), 460'800U);
  host.close();
  EXPECT_FALSE(terminal.has_host());
}

TEST_F(PseudoTerminalTest, ChangesNoByteEvenForAHostThatSetsNothing) {
  const auto made = PseudoTerminal::create(name_);
  ASSERT_TRUE(made.has_value());
  Host host(name_);
  std::string all;
  for (int i = 0; i < 256; ++i) {
    all.push_back(static_cast<char>(i));
  }
  EXPECT_EQ((*made)->write({reinterpret_cast<const std::uint8_t*>(all.data()), all.size()}), all.size());
  EXPECT_EQ(host.wait_for(256), all);
  host.write(all);
  std::array<std::uint8_t, 300> got{};
  std::size_t count = 0;
  for (int i = 0; i < 200 && count < 256; ++i) {
    pollfd state{(*made)->fd(), POLLIN, 0};
    ::poll(&state, 1, 10);
    count += (*made)->read(std::span(got).subspan(count));
  }
  EXPECT_EQ(std::string(got.begin(), got.begin() + 256), all);
}

TEST_F(PseudoTerminalTest, UnpluggingHangsUpAndTakesTheNameAway) {
  const auto made = PseudoTerminal::create(name_);
  ASSERT_TRUE(made.has_value());
  const Host host(name_);
  (*made)->unplug();
  EXPECT_TRUE(host.is_hung_up());
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(name_)));
  EXPECT_FALSE(Host(name_).is_open());
  ASSERT_TRUE((*made)->plug_in());
  EXPECT_TRUE(Host(name_).is_open());
}

TEST_F(PseudoTerminalTest, LeavesNoNameBehindAndTakesALeftOne) {
  { ASSERT_TRUE(PseudoTerminal::create(name_).has_value()); }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(name_)));
  std::filesystem::create_symlink("/dev/pts/987654", name_);
  EXPECT_TRUE(PseudoTerminal::create(name_).has_value());
}

TEST_F(PseudoTerminalTest, RefusesToReplaceAnythingElse) {
  std::ofstream(name_) << "precious";
  const auto made = PseudoTerminal::create(name_);
  ASSERT_FALSE(made.has_value());
  EXPECT_NE(made.error().message.find("choose another path"), std::string::npos);
  EXPECT_EQ(std::filesystem::file_size(name_), 8U);
  EXPECT_FALSE(PseudoTerminal::create(folder_ / "missing" / "ptu0").has_value());
}

/// A device behind a pseudo-terminal in a time that the test moves.
struct Rig {
  explicit Rig(const std::filesystem::path& name, BaudRule rule = BaudRule::AsOnALine)
      : pty(port, *PseudoTerminal::create(name), rule) {
    port.attach(device);
  }
  void go(Stamp now) {
    port.advance(now);
    pty.exchange(now, late);
  }

  EmulatedPort port{1};
  EchoDevice device{port, 9600, 3ms};
  Lateness late;
  PtyPort pty;
};

TEST_F(PseudoTerminalTest, APortGivesBytesWhenTheyAreDueAndNotBefore) {
  Rig rig(name_);
  const Host host(name_);
  host.write("pp ");
  rig.go(10ms);
  rig.go(10ms + 1ms + 3ms);
  EXPECT_EQ(host.read(), "");
  rig.go(15ms + 100us);  // first byte: 10 + 1.04 + 3 + 1.04 ms
  EXPECT_EQ(host.wait_for(1), "p");
  rig.go(30ms);
  EXPECT_EQ(host.wait_for(2), "p ");
  EXPECT_EQ(rig.late.total(), 3U);
  EXPECT_EQ(rig.pty.lost_bytes(), 0U);
}

TEST_F(PseudoTerminalTest, AHostAtAnotherRateIsNotUnderstoodUnlessAnyRateWillDo) {
  for (const BaudRule rule : {BaudRule::AsOnALine, BaudRule::AnyRate}) {
    Rig rig(name_, rule);
    const Host host(name_);
    host.set_speed(B115200);
    rig.go(1ms);
    host.write("V");
    rig.go(2ms);
    rig.go(1s);
    const bool understood = !rig.device.heard.empty() && rig.device.heard.front().byte == 'V';
    EXPECT_EQ(understood, rule == BaudRule::AnyRate);
  }
}

TEST_F(PseudoTerminalTest, ACableOutIsAHangUpAndThenANewTerminalOfTheSameName) {
  Rig rig(name_);
  const Host host(name_);
  rig.go(1ms);
  ASSERT_TRUE(rig.port.inject({FaultKind::CableOut, 1ms, 100ms}));
  rig.go(2ms);
  EXPECT_TRUE(host.is_hung_up());
  EXPECT_FALSE(Host(name_).is_open());
  rig.go(200ms);
  const Host again(name_);
  ASSERT_TRUE(again.is_open());
  again.write("x");
  rig.go(210ms);
  rig.go(300ms);
  EXPECT_EQ(again.wait_for(1), "x");
}

TEST_F(PseudoTerminalTest, WhatComesWhileNobodyListensIsLostAsOnALine) {
  Rig rig(name_);
  rig.port.send(std::array<std::uint8_t, 2>{'h', 'i'}, 0ms);
  rig.go(100ms);
  const Host host(name_);
  rig.go(200ms);
  rig.port.send(std::array<std::uint8_t, 1>{'!'}, 200ms);
  rig.go(300ms);
  EXPECT_EQ(host.wait_for(1), "!");
}

}  // namespace
}  // namespace slamsensor::tools
