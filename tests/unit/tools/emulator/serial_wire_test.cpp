#include "tools/emulator/emulated_port.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <numeric>
#include <vector>

namespace slamsensor::tools {
namespace {

using namespace std::chrono_literals;
using hal::Stamp;

std::vector<WireByte> all_of(SerialWire& wire, std::uint32_t baud, Stamp until = 1000s) {
  std::vector<WireByte> bytes;
  while (const auto byte = wire.next(until, baud)) {
    bytes.push_back(*byte);
  }
  return bytes;
}

std::vector<std::uint8_t> values_of(const std::vector<WireByte>& bytes) {
  std::vector<std::uint8_t> values;
  for (const WireByte& byte : bytes) {
    values.push_back(byte.value);
  }
  return values;
}

std::vector<std::uint8_t> counted(std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

TEST(SerialWire, AByteTakesTenBitTimes) {
  SerialWire wire(1);
  wire.send(std::array<std::uint8_t, 2>{'a', 'b'}, 5ms, 9600);
  EXPECT_EQ(wire.next_arrival(9600), 5ms + hal::line_time(1, 9600));
  EXPECT_EQ(wire.busy_until(), 5ms + hal::line_time(2, 9600));
  EXPECT_FALSE(wire.next(5ms + 1041us, 9600).has_value());
  const auto first = wire.next(5ms + 1042us, 9600);
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->value, 'a');
  EXPECT_EQ(first->at, 5ms + 1041666ns);
  EXPECT_EQ(all_of(wire, 9600).at(0).at, 5ms + 2083333ns);
  EXPECT_EQ(wire.next_arrival(9600), hal::kNever);
}

TEST(SerialWire, SendingsQueueBehindEachOther) {
  SerialWire wire(1);
  wire.send(counted(3), 1ms, 115200);
  wire.send(counted(2), 1ms, 115200);
  wire.send(counted(1), 1s, 115200);
  const auto bytes = all_of(wire, 115200);
  ASSERT_EQ(bytes.size(), 6U);
  EXPECT_EQ(bytes[4].at, 1ms + hal::line_time(5, 115200));
  EXPECT_EQ(bytes[5].at, 1s + hal::line_time(1, 115200));
}

TEST(SerialWire, RoundingNeverAddsUpOverMinutesOfFullLoad) {
  SerialWire wire(1);
  constexpr std::uint32_t kBaud = 115200;
  Stamp last{};
  for (int second = 0; second < 60; ++second) {
    wire.send(std::vector<std::uint8_t>(kBaud / 10), Stamp{}, kBaud);
    last = all_of(wire, kBaud).back().at;
  }
  EXPECT_EQ(last, 60s);
}

TEST(SerialWire, DroppedCorruptedAndDoubledBytes) {
  SerialWire wire(7);
  ASSERT_TRUE(wire.inject({FaultKind::DropByte, 0ns, 0ns}));
  wire.send(counted(4), 0ns, 9600);
  EXPECT_EQ(values_of(all_of(wire, 9600)), (std::vector<std::uint8_t>{1, 2, 3}));

  ASSERT_TRUE(wire.inject({FaultKind::DoubleByte, 1s, 0ns}));
  wire.send(counted(3), 1s, 9600);
  const auto doubled = all_of(wire, 9600);
  EXPECT_EQ(values_of(doubled), (std::vector<std::uint8_t>{0, 0, 1, 2}));
  for (std::size_t i = 1; i < doubled.size(); ++i) {
    EXPECT_GE(doubled[i].at - doubled[i - 1].at, hal::line_time(1, 9600) - 1ns) << i;
  }

  ASSERT_TRUE(wire.inject({FaultKind::CorruptByte, 2s, 0ns}));
  wire.send(counted(2), 2s, 9600);
  const auto corrupted = all_of(wire, 9600);
  ASSERT_EQ(corrupted.size(), 2U);
  EXPECT_EQ(std::popcount(static_cast<unsigned>(corrupted[0].value ^ 0U)), 1);
  EXPECT_EQ(corrupted[1].value, 1);
  EXPECT_FALSE(wire.inject({FaultKind::PowerCycle, 2s, 0ns}));
}

TEST(SerialWire, AStallHoldsBytesBackAndLosesNone) {
  SerialWire wire(1);
  wire.send(counted(10), 0ns, 9600);
  EXPECT_EQ(all_of(wire, 9600, 3ms).size(), 2U);
  ASSERT_TRUE(wire.inject({FaultKind::Stall, 3ms, 200ms}));
  wire.send(counted(1), 50ms, 9600);
  EXPECT_EQ(wire.next_arrival(9600), 203ms + hal::line_time(1, 9600));
  const auto late = all_of(wire, 9600);
  EXPECT_EQ(values_of(late), (std::vector<std::uint8_t>{2, 3, 4, 5, 6, 7, 8, 9, 0}));
  EXPECT_EQ(late.back().at, 203ms + hal::line_time(9, 9600));
}

TEST(SerialWire, NoiseComesWhileItLastsAndDamagesSomeBytes) {
  SerialWire wire(3);
  ASSERT_TRUE(wire.inject({FaultKind::Noise, 0ns, 1s}));
  const auto noise = all_of(wire, 9600);
  EXPECT_GT(noise.size(), 160U);  // 960 bytes fit; every fourth place on average is 240
  EXPECT_LT(noise.size(), 320U);
  EXPECT_LT(noise.back().at, 1s);
  ASSERT_TRUE(wire.inject({FaultKind::Noise, 2s, 1s}));
  wire.send(std::vector<std::uint8_t>(400, 0x55), 2s, 9600);
  wire.send(std::vector<std::uint8_t>(100, 0x55), 4s, 9600);
  const auto mixed = all_of(wire, 9600);
  const auto whole =
      std::count_if(mixed.begin(), mixed.end(), [](const WireByte& b) { return b.value == 0x55; });
  EXPECT_GT(whole, 350);
  EXPECT_LT(whole, 450);
  EXPECT_TRUE(std::is_sorted(mixed.begin(), mixed.end(),
                             [](const WireByte& a, const WireByte& b) { return a.at < b.at; }));
  EXPECT_TRUE(std::all_of(mixed.end() - 100, mixed.end(), [](const WireByte& b) { return b.value == 0x55; }));
}

TEST(SerialWire, EqualSeedsEqualNoise) {
  const auto run = [](std::uint64_t seed) {
    SerialWire wire(seed);
    wire.inject({FaultKind::Noise, 0ns, 100ms});
    return values_of(all_of(wire, 115200));
  };
  EXPECT_EQ(run(5), run(5));
  EXPECT_NE(run(5), run(6));
}

TEST(SerialWire, AReceiverAtAnotherRateGetsGarbageInTheRatioOfTheRates) {
  for (const std::uint32_t receiver : {4800U, 19200U, 38400U}) {
    SerialWire wire(1);
    const std::vector<std::uint8_t> text(400, 'V');
    wire.send(text, 1ms, 9600);
    const auto garbage = all_of(wire, receiver);
    const double ratio = static_cast<double>(garbage.size()) / static_cast<double>(text.size());
    const double rates = static_cast<double>(receiver) / 9600.0;
    EXPECT_GT(ratio, 0.4 * rates) << receiver;
    EXPECT_LT(ratio, 1.2 * rates) << receiver;
    EXPECT_NE(values_of(garbage), text) << receiver;
    EXPECT_EQ(wire.next_arrival(receiver), hal::kNever) << receiver;
  }
}

TEST(SerialWire, TheUartSeesWhatTheLevelsAre) {
  // 0x00 at 9600 is low for nine bits: at four times the rate three and a half characters of break.
  SerialWire wire(1);
  wire.send(std::array<std::uint8_t, 1>{0x00}, 0ns, 9600);
  const auto slow_zero = all_of(wire, 38400, 1s);
  ASSERT_EQ(slow_zero.size(), 1U);  // only one falling edge
  EXPECT_EQ(slow_zero[0].value, 0x00);
  // 0xFF is low for one bit: four bits of the receiver, start bit and three zeros.
  wire.send(std::array<std::uint8_t, 1>{0xFF}, 1s, 9600);
  const auto fast_ones = all_of(wire, 38400);
  ASSERT_EQ(fast_ones.size(), 1U);
  EXPECT_EQ(fast_ones[0].value, 0xF8);
}

TEST(SerialWire, RatesWithinThreePercentAgree) {
  EXPECT_TRUE(rates_agree(115200, 117000));
  EXPECT_TRUE(rates_agree(9600, 9600));
  EXPECT_FALSE(rates_agree(9600, 10000));
  EXPECT_FALSE(rates_agree(57600, 115200));
}

TEST(SerialWire, MismatchedBytesAreTakenStepByStepAsAllAtOnce) {
  const auto run = [](Stamp step) {
    SerialWire wire(1);
    std::vector<std::uint8_t> got;
    wire.send(counted(200), 0ns, 115200);
    for (Stamp now{}; now < 100ms; now += step) {
      for (const std::uint8_t value : values_of(all_of(wire, 38400, now))) {
        got.push_back(value);
      }
    }
    return got;
  };
  EXPECT_EQ(run(10us), run(1ms));
  EXPECT_FALSE(run(1ms).empty());
}

TEST(SerialWire, AStreamOfGlitchesIsJudgedOnce) {
  // 0xFF at 921600 is low for 1 us, half a start bit at 9600 takes 52 us: never a character, for however
  // long.
  SerialWire wire(1);
  const std::vector<std::uint8_t> ones(50'000, 0xFF);
  Stamp now{};
  for (int i = 0; i < 20; ++i) {
    wire.send(ones, now, 921600);
    now = wire.busy_until() + 1ms;
    EXPECT_FALSE(wire.next(now, 9600).has_value());
    EXPECT_EQ(wire.next_arrival(9600), hal::kNever);
  }
  wire.send(std::array<std::uint8_t, 1>{0x5A}, now, 9600);
  EXPECT_EQ(values_of(all_of(wire, 9600)), std::vector<std::uint8_t>{0x5A});
}

}  // namespace
}  // namespace slamsensor::tools
