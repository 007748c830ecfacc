#include "firmware/serving/nmea_tcp_server.hpp"

#include "tests/support/no_alloc_scope.hpp"
#include "tests/unit/firmware/serving/tcp_reader.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;
using tests::TcpReader;

const std::string kEpoch = "$" + std::string(400, 'x') + "\r\n";

class NmeaTcp : public testing::Test {
 protected:
  NmeaTcp() { step(); }

  /// Time goes on by `by`, then the server is stepped.
  void step(hal::Stamp by = 10ms) {
    now_ += by;
    server_->step(now_);
  }
  void send(const std::string& epoch = kEpoch) { server_->send(epoch, {now_, 0ns}); }
  /// Steps until the server has `count` clients: what the kernel does between two ends of a connection takes
  /// its own time.
  void await_clients(std::size_t count) {
    for (int i = 0; i < 2000 && server_->clients() != count; ++i) {
      ::poll(nullptr, 0, 1);
      step(0ms);
    }
    ASSERT_EQ(server_->clients(), count);
  }
  std::uint64_t counter(std::string_view name) const {
    for (const hal::Counter& counter : server_->counters()) {
      if (counter.name == name) {
        return counter.value;
      }
    }
    ADD_FAILURE() << "no counter " << name;
    return 0;
  }

  hal::Stamp now_ = 1s;
  std::unique_ptr<NmeaTcpServer> server_ =
      NmeaTcpServer::create({.enabled = true, .address = "127.0.0.1", .port = 0, .clients_max = 3}).value();
};

TEST_F(NmeaTcp, EveryClientReceivesEveryEpoch) {
  TcpReader one(server_->port());
  TcpReader two(server_->port());
  await_clients(2);
  send();
  EXPECT_EQ(one.read(), kEpoch);
  EXPECT_EQ(two.read(), kEpoch);
  EXPECT_EQ(counter("nmea_tcp_epochs"), 2U);
  EXPECT_EQ(counter("nmea_tcp_bytes"), 2 * kEpoch.size());
  EXPECT_EQ(server_->problem(), "");
}

TEST_F(NmeaTcp, ClientsBeyondTheMostAreClosedAndCounted) {
  std::vector<std::unique_ptr<TcpReader>> readers;
  for (int i = 0; i < 3; ++i) {
    readers.push_back(std::make_unique<TcpReader>(server_->port()));
  }
  await_clients(3);
  TcpReader late(server_->port());
  for (int i = 0; i < 2000 && counter("nmea_tcp_clients_refused") == 0; ++i) {
    ::poll(nullptr, 0, 1);
    step();
  }
  EXPECT_EQ(late.read(), "");
  EXPECT_TRUE(late.is_closed());
  EXPECT_EQ(counter("nmea_tcp_clients_refused"), 1U);
  send();
  EXPECT_EQ(readers[2]->read(), kEpoch);
}

TEST_F(NmeaTcp, RefusedClientsMakeALineAtOnceAndThenOneAMinute) {
  std::vector<std::unique_ptr<TcpReader>> readers;
  const auto connect = [&](std::uint64_t refused) {
    readers.push_back(std::make_unique<TcpReader>(server_->port()));
    for (int i = 0; i < 2000 && counter("nmea_tcp_clients_refused") < refused; ++i) {
      ::poll(nullptr, 0, 1);
      step(0ms);
    }
  };
  for (std::size_t i = 0; i < 3; ++i) {
    connect(0);
    await_clients(i + 1);
  }
  EXPECT_EQ(server_->take_refusals(now_), "");
  connect(1);
  EXPECT_EQ(server_->take_refusals(now_),
            "NMEA over TCP: 1 client was refused, 3 of at most 3 are connected; end one of them, or connect "
            "gpsd, which serves any number of programs");
  EXPECT_EQ(server_->problem(), "");
  connect(2);
  connect(3);
  EXPECT_EQ(server_->take_refusals(now_ + 1min - 1ns), "");
  EXPECT_TRUE(server_->take_refusals(now_ + 1min).starts_with("NMEA over TCP: 2 clients were refused, "));
  EXPECT_EQ(server_->take_refusals(now_ + 1h), "");
}

TEST_F(NmeaTcp, AClientThatLeavesMakesRoom) {
  auto one = std::make_unique<TcpReader>(server_->port());
  await_clients(1);
  one->reset();
  await_clients(0);
  EXPECT_EQ(counter("nmea_tcp_clients_left"), 1U);
  TcpReader two(server_->port());
  await_clients(1);
  send();
  EXPECT_EQ(two.read(), kEpoch);
}

TEST_F(NmeaTcp, AClientThatClosesIsFoundOutByTheNextEpochs) {
  TcpReader one(server_->port());
  await_clients(1);
  one.close();
  for (int i = 0; i < 2000 && server_->clients() > 0; ++i) {
    ::poll(nullptr, 0, 1);
    send();
    step();
  }
  EXPECT_EQ(server_->clients(), 0U);
  EXPECT_EQ(counter("nmea_tcp_clients_left"), 1U);
}

TEST_F(NmeaTcp, AReaderThatClosesItsSendingSideReadsOn) {
  TcpReader one(server_->port());
  await_clients(1);
  one.hush();
  for (int i = 0; i < 50; ++i) {
    ::poll(nullptr, 0, 1);
    step();
  }
  send();
  EXPECT_EQ(one.read(), kEpoch);
  EXPECT_EQ(server_->clients(), 1U);
}

TEST_F(NmeaTcp, OneThatHasHushedMakesRoomForAnotherWhenAllPlacesAreTaken) {
  TcpReader one(server_->port());
  TcpReader two(server_->port());
  TcpReader three(server_->port());
  await_clients(3);
  two.hush();
  ::poll(nullptr, 0, 20);
  step();
  TcpReader four(server_->port());
  for (int i = 0; i < 2000 && counter("nmea_tcp_clients_displaced") == 0; ++i) {
    ::poll(nullptr, 0, 1);
    step();
  }
  send();
  EXPECT_EQ(four.read(), kEpoch);
  EXPECT_EQ(one.read(), kEpoch);
  EXPECT_EQ(counter("nmea_tcp_clients_refused"), 0U);
}

TEST_F(NmeaTcp, WhatClientsSayIsIgnored) {
  TcpReader one(server_->port());
  await_clients(1);
  one.write("$PASHQ,RID*28\r\n" + std::string(20'000, 'z'));
  for (int i = 0; i < 2000 && counter("nmea_tcp_bytes_ignored") < 20'015; ++i) {
    ::poll(nullptr, 0, 1);
    step();
  }
  EXPECT_EQ(counter("nmea_tcp_bytes_ignored"), 20'015U);
  send();
  EXPECT_EQ(one.read(), kEpoch);
}

// A reader that sleeps: it loses epochs, the others lose none; what it finds when it wakes up is whole.
TEST_F(NmeaTcp, ASlowClientLosesWholeEpochsAndNobodyElseDoes) {
  TcpReader sleeper(server_->port(), TcpReader::Family::V4, 4096);
  TcpReader other(server_->port());
  await_clients(2);
  std::string awake;
  for (int i = 0; i < 400; ++i) {
    std::string epoch = "$" + std::to_string(1000 + i) + kEpoch.substr(5);
    step(20ms);
    send(epoch);
    awake += other.read();
  }
  EXPECT_EQ(awake.size(), 400 * kEpoch.size());
  EXPECT_GT(counter("nmea_tcp_epochs_dropped"), 100U);
  std::string all;
  for (std::string part = sleeper.read(); !part.empty(); part = sleeper.read(100)) {
    all += part;
    step(0ms);
  }
  ASSERT_EQ(all.size() % kEpoch.size(), 0U);
  EXPECT_EQ(all.size() / kEpoch.size(), 400 - counter("nmea_tcp_epochs_dropped"));
  for (std::size_t begin = 0; begin < all.size(); begin += kEpoch.size()) {
    EXPECT_EQ(all[begin], '$');
  }
}

TEST_F(NmeaTcp, AClientThatTakesNothingForLongIsClosed) {
  TcpReader sleeper(server_->port(), TcpReader::Family::V4, 4096);
  await_clients(1);
  while (counter("nmea_tcp_epochs_dropped") == 0) {
    step();
    send();
  }
  step(NmeaTcpServer::kStuckMax - 1s);
  EXPECT_EQ(server_->clients(), 1U);
  step(2s);
  EXPECT_EQ(server_->clients(), 0U);
  EXPECT_EQ(counter("nmea_tcp_clients_stuck"), 1U);
}

TEST_F(NmeaTcp, PollWakesForAClientAndForWhatItSays) {
  std::array<pollfd, 8> entries{};
  ASSERT_EQ(server_->poll_on(entries), 1U);
  EXPECT_EQ(::poll(entries.data(), 1, 0), 0);
  TcpReader one(server_->port());
  EXPECT_EQ(::poll(entries.data(), 1, 2000), 1);
  step();
  ASSERT_EQ(server_->poll_on(entries), 2U);
  EXPECT_EQ(::poll(entries.data(), 2, 0), 0);
  one.write("x");
  EXPECT_EQ(::poll(entries.data(), 2, 2000), 1);
  step();
  EXPECT_EQ(::poll(entries.data(), 2, 0), 0);
  EXPECT_EQ(server_->poll_on(std::span(entries).first(1)), 1U);
}

TEST_F(NmeaTcp, SendingAsksTheHeapForNothing) {
  if (!tests::NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: the sanitizers bring their own heap";
  }
  const tests::NoAllocScope scope;
  const std::uint64_t before = scope.heap_calls();
  TcpReader one(server_->port());
  await_clients(1);
  const std::uint64_t own = scope.heap_calls() - before;
  for (int i = 0; i < 100; ++i) {
    step();
    send();
  }
  EXPECT_EQ(own, 0U);
  EXPECT_EQ(scope.heap_calls(), 0U);
}

}  // namespace
}  // namespace slamsensor::firmware
