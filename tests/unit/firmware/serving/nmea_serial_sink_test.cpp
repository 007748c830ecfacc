#include "firmware/serving/nmea_serial_sink.hpp"

#include "tests/contract/pseudo_terminal.hpp"
#include "tests/support/no_alloc_scope.hpp"
#include "tests/support/scripted_link.hpp"

#include <gmock/gmock.h>

#include <string>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

const std::string kEpoch(384, 'x');  // 100 ms at 38400 baud

std::uint64_t counter(const EpochSink& sink, std::string_view name) {
  for (const hal::Counter& counter : sink.counters()) {
    if (counter.name == name) {
      return counter.value;
    }
  }
  ADD_FAILURE() << "no counter " << name;
  return 0;
}

class ScriptedLine : public testing::Test {
 protected:
  ScriptedLine() {
    link_.set_up(true);
    static_cast<void>(link_.set_baud(38'400));
  }

  void send(hal::Stamp now) {
    link_.set_now(now);
    sink_.step(now);
    sink_.send(kEpoch, {now, 0ns});
  }

  tests::ScriptedLink link_;
  NmeaSerialSink sink_{link_, 200ms};
};

TEST_F(ScriptedLine, AnEpochLeavesInOneWrite) {
  send(1s);
  const auto writes = link_.take_writes();
  ASSERT_EQ(writes.size(), 1U);
  EXPECT_EQ(writes[0].text, kEpoch);
  EXPECT_EQ(counter(sink_, "nmea_serial_epochs"), 1U);
  EXPECT_EQ(counter(sink_, "nmea_serial_bytes"), kEpoch.size());
}

// Two epochs in 100 ms, which the line sends in 200: every second one is lost once it lags by its patience.
TEST_F(ScriptedLine, ALineThatIsTooSlowLosesWholeEpochsAndStaysFresh) {
  for (int i = 0; i < 100; ++i) {
    send(1s + i * 50ms);
  }
  const auto writes = link_.take_writes();
  for (const auto& write : writes) {
    EXPECT_EQ(write.text, kEpoch);
  }
  EXPECT_EQ(writes.size() + counter(sink_, "nmea_serial_dropped_busy"), 100U);
  // In 4.95 s the line has sent 49 and a half; what waits is at most the patience and an epoch.
  EXPECT_GE(writes.size(), 50U);
  EXPECT_LE(writes.size(), 53U);
}

TEST_F(ScriptedLine, ALinkThatIsFullLosesTheEpochWhole) {
  link_.set_full(true);
  send(1s);
  link_.set_full(false);
  send(2s);
  EXPECT_EQ(link_.take_writes().size(), 1U);
  EXPECT_EQ(counter(sink_, "nmea_serial_dropped_busy"), 1U);
}

TEST_F(ScriptedLine, EpochsWithoutALineAreCounted) {
  send(500ms);
  link_.set_up(false);
  send(1s);
  send(2s);
  EXPECT_EQ(counter(sink_, "nmea_serial_dropped_down"), 2U);
  link_.set_up(true);
  send(3s);
  EXPECT_EQ(counter(sink_, "nmea_serial_epochs"), 2U);
  EXPECT_EQ(counter(sink_, "nmea_serial_opened"), 2U);
}

TEST_F(ScriptedLine, ALineThatComesBackIsAnEmptyOne) {
  for (int i = 0; i < 4; ++i) {
    send(1s);
  }
  EXPECT_EQ(counter(sink_, "nmea_serial_dropped_busy"), 1U);
  link_.set_up(false);
  link_.set_up(true);
  send(1s + 1ms);
  EXPECT_EQ(counter(sink_, "nmea_serial_dropped_busy"), 1U);
}

TEST_F(ScriptedLine, WhatIsWrittenToUsIsIgnoredAndCounted) {
  link_.deliver("$PASHQ,RID*28\r\n", 1s, 38'400);
  send(2s);
  EXPECT_EQ(counter(sink_, "nmea_serial_bytes_ignored"), 15U);
}

TEST(NmeaSerialPort, SendingAsksTheHeapForNothing) {
  if (!tests::NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: the sanitizers bring their own heap";
  }
  tests::PseudoTerminal terminal;
  const auto sink = NmeaSerialSink::open({terminal.path(), 38'400}, 1s).value();
  sink->step(1s);
  const tests::NoAllocScope scope;
  for (int i = 0; i < 100; ++i) {
    sink->step(1s + i * 50ms);
    sink->send(kEpoch, {1s + i * 50ms, 0ns});
  }
  EXPECT_EQ(scope.heap_calls(), 0U);
  EXPECT_GT(counter(*sink, "nmea_serial_epochs"), 5U);
}

TEST(NmeaSerialPort, APortThatIsPluggedInLaterIsUsedFromThenOn) {
  tests::PseudoTerminal terminal;
  terminal.unplug();
  const auto sink = NmeaSerialSink::open({terminal.path(), 38'400}, 1s).value();
  sink->step(1s);
  EXPECT_THAT(std::string(sink->problem()), HasSubstr(terminal.path()));
  sink->send(kEpoch, {1s, 0ns});
  EXPECT_EQ(counter(*sink, "nmea_serial_dropped_down"), 1U);

  terminal.plug_in();
  sink->step(4s);
  EXPECT_EQ(sink->problem(), "");
  sink->send(kEpoch, {4s, 0ns});
  const auto bytes = terminal.read();
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), kEpoch);

  terminal.unplug();
  terminal.plug_in();
  sink->step(5s);
  sink->step(10s);
  sink->send(kEpoch, {10s, 0ns});
  EXPECT_EQ(terminal.read().size(), kEpoch.size());
  EXPECT_EQ(counter(*sink, "nmea_serial_opened"), 2U);
}

// Nobody reads the far end: the kernel's buffer fills, and every epoch is there whole or not at all.
TEST(NmeaSerialPort, AReaderThatSleepsFindsWholeEpochs) {
  tests::PseudoTerminal terminal;
  const auto sink = NmeaSerialSink::open({terminal.path(), 460'800}, 1s).value();
  std::uint64_t handed = 0;
  for (int i = 0; i < 300; ++i) {
    const hal::Stamp now = 1s + i * 1s;
    sink->step(now);
    const std::string epoch = "$" + std::to_string(1000 + i) + std::string(300, 'y') + "\r\n";
    sink->send(epoch, {now, 0ns});
  }
  handed = counter(*sink, "nmea_serial_epochs");
  EXPECT_GT(counter(*sink, "nmea_serial_dropped_busy"), 0U);
  std::string all;
  for (int i = 0; i < 1000; ++i) {
    sink->step(400s + i * 10ms);
    const auto bytes = terminal.read();
    all.append(bytes.begin(), bytes.end());
  }
  EXPECT_EQ(all.size(), handed * 307);
  for (std::size_t begin = 0; begin < all.size(); begin += 307) {
    EXPECT_EQ(all[begin], '$');
    EXPECT_EQ(all.substr(begin + 305, 2), "\r\n");
  }
}

TEST(NmeaSerialPort, ASettingThatCannotBeIsRefusedInWords) {
  const auto sink = NmeaSerialSink::open({"", 38'400}, 1s);
  ASSERT_FALSE(sink);
  EXPECT_THAT(sink.error().message, HasSubstr("NMEA output"));
}

}  // namespace
}  // namespace slamsensor::firmware
