#include "firmware/lcm/lcm_publisher.hpp"
#include "tests/support/no_alloc_scope.hpp"
#include "tests/unit/firmware/lcm/sample_reports.hpp"

#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sched.h>
#include <string>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace slamsensor::tests {
namespace {

/// Runs `body` on a thread that has a network of its own, without any interface that is up. False when that
/// is not allowed here (it takes CAP_SYS_ADMIN).
bool in_own_network(const std::function<void()>& body) {
  bool allowed = false;
  std::thread([&] {
    allowed = ::unshare(CLONE_NEWNET) == 0;
    if (allowed) {
      body();
    }
  }).join();
  return allowed;
}

/// The loopback interface of the calling thread's network is up and multicast finds its way to it.
bool open_multicast_route() {
  const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);
  ifreq up{};
  std::string("lo").copy(up.ifr_name, IFNAMSIZ - 1);
  up.ifr_flags = IFF_UP | IFF_RUNNING | IFF_LOOPBACK | IFF_MULTICAST;
  bool done = ::ioctl(fd, SIOCSIFFLAGS, &up) == 0;
  rtentry route{};
  std::string device = "lo";
  const auto set = [](sockaddr& place, const char* address) {
    auto& in = reinterpret_cast<sockaddr_in&>(place);
    in.sin_family = AF_INET;
    in.sin_addr.s_addr = ::inet_addr(address);
  };
  set(route.rt_dst, "224.0.0.0");
  set(route.rt_genmask, "240.0.0.0");
  route.rt_flags = RTF_UP;
  route.rt_dev = device.data();
  done = done && ::ioctl(fd, SIOCADDRT, &route) == 0;
  ::close(fd);
  return done;
}

}  // namespace
}  // namespace slamsensor::tests

namespace slamsensor::firmware {
namespace {

using std::chrono::seconds;

LcmUrl default_url() {
  return resolve_lcm_url("", nullptr).value();
}

/// A plain socket in LCM's default group.
class Listener {
 public:
  Listener() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    const int one = 1;
    ::setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
    sockaddr_in group = default_url().group;
    joined_ = ::bind(fd_, reinterpret_cast<const sockaddr*>(&group), sizeof group) == 0;
    const ip_mreq request{group.sin_addr, {htonl(INADDR_ANY)}};
    joined_ = joined_ && ::setsockopt(fd_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) == 0;
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener() { ::close(fd_); }

  [[nodiscard]] bool joined() const { return joined_; }
  std::vector<std::uint8_t> next() {
    std::vector<std::uint8_t> bytes(2000);
    const ssize_t size = ::recv(fd_, bytes.data(), bytes.size(), 0);
    bytes.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return bytes;
  }

 private:
  int fd_;
  bool joined_ = false;
};

std::size_t entries(const char* folder) {
  const std::filesystem::directory_iterator all(folder);
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

/// UDP sockets of the thread's network that are bound to a port.
std::size_t bound_sockets() {
  std::ifstream table("/proc/thread-self/net/udp");
  std::string line;
  std::size_t lines = 0;
  while (std::getline(table, line)) {
    lines += line.find(":1DF3 ") != std::string::npos ? 1 : 0;  // 7667
  }
  return lines;
}

/// Tests that need a network of their own.
class LcmSinkOnline : public testing::Test {
 protected:
  static void online(const std::function<void()>& body) {
    if (!tests::in_own_network(body)) {
      GTEST_SKIP() << "a network of its own takes CAP_SYS_ADMIN; run this test as root to see it";
    }
  }
};

/// Groups that the thread's network takes datagrams of, beside that of all hosts.
std::size_t joined_groups() {
  std::ifstream table("/proc/thread-self/net/igmp");
  std::string line;
  std::size_t groups = 0;
  while (std::getline(table, line)) {
    groups += line.starts_with("\t\t\t\t") && line.find("010000E0") == std::string::npos ? 1 : 0;
  }
  return groups;
}

TEST_F(LcmSinkOnline, JoinsNoGroupForItOnlySends) {
  online([] {
    ASSERT_TRUE(tests::open_multicast_route());
    {
      const Listener listener;
      ASSERT_TRUE(listener.joined());
      EXPECT_EQ(joined_groups(), 1U) << "else this test sees nothing";
    }
    EXPECT_EQ(joined_groups(), 0U);
    LcmSink sink(default_url());
    sink.service(seconds(0));
    ASSERT_TRUE(sink.is_open());
    EXPECT_EQ(joined_groups(), 0U);
    Listener listener;
    const std::array<std::uint8_t, 3> bytes{1, 2, 3};
    EXPECT_TRUE(sink.publish(LcmChannel("A"), bytes));
    EXPECT_FALSE(listener.next().empty()) << "what it sends still arrives";
  });
}

TEST_F(LcmSinkOnline, WaitsForARouteAndSaysSo) {
  online([] {
    LcmSink sink(default_url());
    EXPECT_EQ(sink.problem(), "not opened yet");
    sink.service(seconds(0));
    EXPECT_FALSE(sink.is_open());
    EXPECT_NE(sink.problem().find("ip route add 224.0.0.0/4"), std::string_view::npos) << sink.problem();
    const std::array<std::uint8_t, 3> bytes{};
    EXPECT_FALSE(sink.publish(LcmChannel("A"), bytes));

    ASSERT_TRUE(tests::open_multicast_route());
    sink.service(std::chrono::milliseconds(999));
    EXPECT_FALSE(sink.is_open()) << "tried again before the wait was over";
    sink.service(seconds(1));
    EXPECT_TRUE(sink.is_open());
    EXPECT_EQ(sink.problem(), "");
    Listener listener;
    ASSERT_TRUE(listener.joined());
    EXPECT_TRUE(sink.publish(LcmChannel("A"), bytes));
    EXPECT_EQ(listener.next(), (std::vector<std::uint8_t>{'L', 'C', '0', '2', 0, 0, 0, 0, 'A', 0, 0, 0, 0}));
  });
}

TEST_F(LcmSinkOnline, LosesItsRouteAndRecovers) {
  online([] {
    ASSERT_TRUE(tests::open_multicast_route());
    LcmSink sink(default_url());
    sink.service(seconds(0));
    ASSERT_TRUE(sink.is_open());
    const std::array<std::uint8_t, 3> bytes{};
    ASSERT_TRUE(sink.publish(LcmChannel("A"), bytes));
    // A loopback interface that goes down takes its routes with it.
    const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);
    ifreq down{};
    std::string("lo").copy(down.ifr_name, IFNAMSIZ - 1);
    ASSERT_EQ(::ioctl(fd, SIOCSIFFLAGS, &down), 0);
    ::close(fd);
    EXPECT_FALSE(sink.publish(LcmChannel("A"), bytes));
    EXPECT_NE(sink.problem().find("cannot send"), std::string_view::npos) << sink.problem();
    ASSERT_TRUE(tests::open_multicast_route());
    EXPECT_TRUE(sink.publish(LcmChannel("A"), bytes));
    EXPECT_EQ(sink.problem(), "");
  });
}

// liblcm 1.3.1's receiver is not safe on an open network.
TEST_F(LcmSinkOnline, OnlyTransmits) {
  online([] {
    ASSERT_TRUE(tests::open_multicast_route());
    const std::size_t threads = entries("/proc/self/task");
    LcmSink sink(default_url());
    sink.service(seconds(0));
    ASSERT_TRUE(sink.is_open());
    const std::array<std::uint8_t, 100> bytes{};
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(sink.publish(LcmChannel("A"), bytes));
    }
    EXPECT_EQ(entries("/proc/self/task"), threads);
    EXPECT_EQ(bound_sockets(), 0U);
    Listener listener;
    ASSERT_TRUE(listener.joined());
    EXPECT_EQ(bound_sockets(), 1U) << "the check must see a receiver";
  });
}

TEST_F(LcmSinkOnline, AllocatesNothingWhileItIsOpen) {
  if (!tests::NoAllocScope::works()) {
    GTEST_SKIP() << "the sanitizers have a heap of their own";
  }
  online([] {
    ASSERT_TRUE(tests::open_multicast_route());
    LcmSink sink(default_url());
    sink.service(seconds(0));
    ASSERT_TRUE(sink.is_open());
    auto publisher = LcmPublisher::create({}, sink);
    ASSERT_TRUE(publisher);
    const FixReport report = tests::sample_report();
    const SensorStatus status = tests::sample_status();
    const tests::SampleMap map(1000);
    const std::vector<core::ScanLandmark> landmarks = tests::sample_landmarks(60);
    publisher->publish(report);  // glib makes its locks with the first message of a process
    const tests::NoAllocScope scope;
    publisher->publish(report);
    publisher->publish(status, seconds(1));
    publisher->publish(tests::view_of(landmarks));
    const std::optional<std::uint32_t> next = publisher->publish(map.view(), 0, 100);
    sink.service(seconds(5));
    EXPECT_EQ(scope.heap_calls(), 0U);
    EXPECT_FALSE(next);
    EXPECT_EQ(sink.counters()[0].value, 2U + 2U + 7U + 2U + 40U);
  });
}

TEST(LcmSink, RefusesWhatLcmWouldFragment) {
  LcmSink sink(resolve_lcm_url("memq://", nullptr).value());
  sink.service(seconds(0));
  ASSERT_TRUE(sink.is_open());
  const std::vector<std::uint8_t> bytes(65'497);
  EXPECT_TRUE(sink.publish(LcmChannel("A"), bytes));
  EXPECT_FALSE(sink.publish(LcmChannel("AB"), bytes));
  EXPECT_EQ(sink.problem(), "LCM: cannot send: Message too long; outputs go on without it");
  EXPECT_FALSE(sink.publish(LcmChannel(""), bytes));
  EXPECT_FALSE(sink.publish(LcmChannel("A"), {}));
}

TEST(LcmChannel, IsCutAtItsLongest) {
  EXPECT_EQ(LcmChannel("SLAMSENSOR_", "POSE").view(), "SLAMSENSOR_POSE");
  EXPECT_EQ(LcmChannel(std::string(60, 'x'), "POSE").view(), std::string(60, 'x') + "POS");
  EXPECT_EQ(LcmChannel(std::string(90, 'x')).view().size(), 63U);
}

}  // namespace
}  // namespace slamsensor::firmware
