#include "firmware/supervision/service.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;

/// A service manager: the receiving end of NOTIFY_SOCKET.
struct ServiceNotifierTest : testing::Test {
  ServiceNotifierTest() {
    const std::string own = "slamsensor-notify." + std::to_string(::getpid());
    path = std::filesystem::path(testing::TempDir()) / own;
    abstract = '@' + own;
    ::unsetenv("WATCHDOG_USEC");
    ::unsetenv("WATCHDOG_PID");
  }
  ~ServiceNotifierTest() override {
    std::filesystem::remove(path);
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) {
      ::unsetenv(name);
    }
  }

  void listen(const std::string& name) {
    manager = FileDescriptor(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const UnixAddress address = unix_address(name).value();
    ASSERT_EQ(::bind(manager.get(), address.get(), address.size), 0);
    ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }

  std::vector<std::string> heard() {
    std::vector<std::string> messages;
    std::array<char, 4096> bytes;
    for (ssize_t size = 0; (size = ::recv(manager.get(), bytes.data(), bytes.size(), 0)) >= 0;) {
      messages.emplace_back(bytes.data(), static_cast<std::size_t>(size));
    }
    return messages;
  }

  std::string path;
  std::string abstract;
  FileDescriptor manager;
};

using Messages = std::vector<std::string>;

TEST_F(ServiceNotifierTest, ReachesAManagerAtAPath) {
  listen(path);
  ServiceNotifier notifier = ServiceNotifier::from_environment();
  EXPECT_TRUE(notifier.is_managed());
  notifier.ready();
  notifier.reloading(1234567890ns);
  notifier.extend_timeout(2s);
  notifier.stopping();
  notifier.feed_watchdog();
  EXPECT_EQ(heard(), (Messages{"READY=1", "RELOADING=1\nMONOTONIC_USEC=1234567",
                               "EXTEND_TIMEOUT_USEC=2000000", "STOPPING=1", "WATCHDOG=1"}));
}

TEST_F(ServiceNotifierTest, ReachesAManagerInTheAbstractSpace) {
  listen(abstract);
  ServiceNotifier notifier = ServiceNotifier::from_environment();
  notifier.ready();
  EXPECT_EQ(heard(), Messages{"READY=1"});
}

TEST_F(ServiceNotifierTest, AStatusIsOneLineAndReportedWhenItChanges) {
  listen(path);
  ServiceNotifier notifier = ServiceNotifier::from_environment();
  notifier.status("fixed\nREADY=1");
  notifier.status("fixed\nREADY=1");
  notifier.status("lost");
  EXPECT_EQ(heard(), (Messages{"STATUS=fixed?READY=1", "STATUS=lost"}));
}

TEST_F(ServiceNotifierTest, WithoutAManagerNothingHappens) {
  ::unsetenv("NOTIFY_SOCKET");
  for (const char* name : {"", "relative", "vsock:2:1"}) {
    ServiceNotifier notifier = ServiceNotifier::from_environment();
    notifier.ready();
    EXPECT_FALSE(notifier.is_managed());
    EXPECT_EQ(notifier.unsent(), 0U);
    ::setenv("NOTIFY_SOCKET", name, 1);
  }
}

TEST_F(ServiceNotifierTest, AManagerThatIsGoneOrFullHoldsNothingUp) {
  listen(path);
  ServiceNotifier notifier = ServiceNotifier::from_environment();
  for (int i = 0; i < 10'000; ++i) {
    notifier.feed_watchdog();
  }
  EXPECT_GT(notifier.unsent(), 0U);
  manager.reset();
  const std::uint64_t before = notifier.unsent();
  notifier.status("lost");
  EXPECT_EQ(notifier.unsent(), before + 1);
  std::filesystem::remove(path);
  listen(path);
  notifier.status("lost");  // was not told before
  EXPECT_EQ(heard(), Messages{"STATUS=lost"});
}

TEST_F(ServiceNotifierTest, TheWatchdogIsForThisProcessAlone) {
  const auto period = [](const char* usec, const std::string& pid) {
    ::setenv("WATCHDOG_USEC", usec, 1);
    pid.empty() ? ::unsetenv("WATCHDOG_PID") : ::setenv("WATCHDOG_PID", pid.c_str(), 1);
    return ServiceNotifier::from_environment().watchdog_period();
  };
  const std::string own = std::to_string(::getpid());
  EXPECT_EQ(period("10000000", own), 10s);
  EXPECT_EQ(period("500000", ""), 500ms);
  EXPECT_EQ(period("10000000", "1"), std::nullopt);
  EXPECT_EQ(period("10000000", "me"), std::nullopt);
  for (const char* wrong : {"0", "-5", "", "10s", "99999999999999999999"}) {
    EXPECT_EQ(period(wrong, own), std::nullopt) << wrong;
  }
}

TEST_F(ServiceNotifierTest, TheWatchdogStarvesWhileAThreadIsStalled) {
  listen(path);
  ::setenv("WATCHDOG_USEC", "3000000", 1);
  ServiceNotifier notifier = ServiceNotifier::from_environment();
  Heartbeats heartbeats;
  const std::size_t scan = heartbeats.add({"scan", 500ms}).value();
  const std::size_t slam = heartbeats.add({"slam", 2s}).value();
  Watchdog watchdog(heartbeats, notifier);
  for (hal::Stamp now = 100s; now < 103s; now += 100ms) {  // both beat: fed once a second
    heartbeats.beat(scan);
    heartbeats.beat(slam);
    EXPECT_FALSE(watchdog.step(now));
  }
  EXPECT_EQ(heard(), (Messages{"WATCHDOG=1", "WATCHDOG=1", "WATCHDOG=1"}));
  std::optional<Heartbeats::Stalled> stalled;
  for (hal::Stamp now = 103s; now < 110s; now += 100ms) {  // slam is silent
    heartbeats.beat(scan);
    stalled = watchdog.step(now);
  }
  EXPECT_EQ(heard().size(), 2U);  // within the two seconds it may be silent
  ASSERT_TRUE(stalled);
  EXPECT_EQ(stalled->name, "slam");
  EXPECT_EQ(stalled->silence, 7s);
  heartbeats.beat(slam);
  EXPECT_FALSE(watchdog.step(110s));
  EXPECT_EQ(heard(), Messages{"WATCHDOG=1"});
}

}  // namespace
}  // namespace slamsensor::firmware
