#include "firmware/serving/nmea_tcp_server.hpp"
#include "tests/unit/firmware/serving/tcp_reader.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <fcntl.h>
#include <memory>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using tests::TcpReader;

const std::string kEpoch = "$" + std::string(400, 'x') + "\r\n";

TEST(NmeaTcpPort, AnAddressInUseIsTriedAgainAndSaidInWords) {
  auto first = NmeaTcpServer::create({.enabled = true, .address = "127.0.0.1", .port = 0}).value();
  first->step(1s);
  const auto second = NmeaTcpServer::create({true, "127.0.0.1", first->port(), 8}).value();
  second->step(1s);
  EXPECT_THAT(std::string(second->problem()), HasSubstr("NMEA TCP port 127.0.0.1:"));
  EXPECT_THAT(std::string(second->problem()), HasSubstr("configure another"));
  EXPECT_EQ(second->port(), 0);
  std::array<pollfd, 4> entries{};
  EXPECT_EQ(second->poll_on(entries), 0U);
  first.reset();
  second->step(1s);  // not due yet
  EXPECT_EQ(second->port(), 0);
  second->step(2s);
  EXPECT_NE(second->port(), 0);
  EXPECT_EQ(second->problem(), "");
}

TEST(NmeaTcpPort, AnAddressThatTheMachineDoesNotHaveYetIsNoError) {
  for (const char* const address : {"192.0.2.1", "fe80::1%nonesuch0"}) {
    const auto server = NmeaTcpServer::create({true, address, 10'110, 8}).value();
    server->step(1s);
    EXPECT_EQ(server->port(), 0);
    EXPECT_THAT(std::string(server->problem()), HasSubstr("does not have the address")) << server->problem();
  }
}

TEST(NmeaTcpPort, ListensOnIpv6AndOnEveryAddress) {
  for (const char* const address : {"::1", "::"}) {
    const auto server = NmeaTcpServer::create({true, address, 0, 8}).value();
    server->step(1s);
    if (server->port() == 0) {
      GTEST_SKIP() << "SKIPPED: no IPv6 here: " << server->problem();
    }
    TcpReader reader(server->port(), TcpReader::Family::V6);
    std::unique_ptr<TcpReader> v4;
    if (std::string(address) == "::") {
      v4 = std::make_unique<TcpReader>(server->port());
    }
    server->step(2s);
    server->send(kEpoch, {2s, 0ns});
    EXPECT_EQ(reader.read(), kEpoch);
    if (v4) {
      EXPECT_EQ(v4->read(), kEpoch);
    }
  }
}

TEST(NmeaTcpPort, WhatIsNoAddressIsRefusedInWords) {
  for (const char* const address : {"", "localhost", "1.2.3", "1.2.3.4.5", "::g", "fe80::1%", "*"}) {
    const auto server = NmeaTcpServer::create({true, address, 10'110, 8});
    ASSERT_FALSE(server) << address;
    EXPECT_THAT(server.error().message, HasSubstr(std::string("\"") + address + "\""));
  }
  EXPECT_FALSE(NmeaTcpServer::create({true, "127.0.0.1", 65'536, 8}));
  EXPECT_FALSE(NmeaTcpServer::create({true, "127.0.0.1", 10'110, 0}));
}

/// As many descriptors as there are numbers below `limit`.
class NoDescriptorsLeft {
 public:
  NoDescriptorsLeft() {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit few{std::min<rlim_t>(before_.rlim_cur, 256), before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
    for (int fd = ::open("/dev/null", O_RDONLY); fd >= 0; fd = ::open("/dev/null", O_RDONLY)) {
      fds_.push_back(fd);
    }
  }
  NoDescriptorsLeft(const NoDescriptorsLeft&) = delete;
  NoDescriptorsLeft& operator=(const NoDescriptorsLeft&) = delete;
  ~NoDescriptorsLeft() {
    for (const int fd : fds_) {
      ::close(fd);
    }
    ::setrlimit(RLIMIT_NOFILE, &before_);
  }

 private:
  rlimit before_{};
  std::vector<int> fds_;
};

TEST(NmeaTcpPort, WithoutDescriptorsItRestsAndDoesNotSpin) {
  const auto server = NmeaTcpServer::create({true, "127.0.0.1", 0, 8}).value();
  server->step(1s);
  TcpReader reader(server->port());
  std::array<pollfd, 4> entries{};
  {
    const NoDescriptorsLeft none;
    server->step(2s);
    EXPECT_EQ(server->clients(), 0U);
    EXPECT_EQ(server->poll_on(entries), 0U);
  }
  server->step(4s);
  EXPECT_EQ(server->clients(), 1U);
}

}  // namespace
}  // namespace slamsensor::firmware
