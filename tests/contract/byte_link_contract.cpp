#include "tests/contract/byte_link_contract.hpp"

#include "tests/support/no_alloc_scope.hpp"

#include <gmock/gmock.h>

#include <array>
#include <numeric>
#include <random>

namespace slamsensor::tests {
namespace {

using hal::ByteRead;
using hal::LinkStatus;
using testing::ElementsAreArray;

constexpr unsigned int kSeed = 20'011;

Bytes random_bytes(std::size_t count) {
  std::mt19937 engine(kSeed);
  Bytes bytes(count);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(engine() & 0xFFU);
  }
  return bytes;
}

/// Every value, and then what terminals like to change: CR and LF, XON and XOFF, interrupt, end of file,
/// erase, and the marks of parity errors.
Bytes every_value() {
  Bytes bytes(256);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  const Bytes touchy = {'\r', '\n', '\r', '\r', '\n', '\n', 0x11, 0x13, 0x13, 0x11, 0x03, 0x1A, 0x1C,
                        0x04, 0x7F, 0x15, 0x16, 0x17, 0x12, 0xFF, 0x00, 0xFF, 0xFF, 0x00, 0x00, 'a'};
  bytes.insert(bytes.end(), touchy.begin(), touchy.end());
  return bytes;
}

TEST_P(ByteLinkContract, IsDownUntilItIsServiced) {
  EXPECT_FALSE(link().is_up());
  EXPECT_EQ(link().epoch(), 0U);
  std::array<std::uint8_t, 4> into{};
  EXPECT_EQ(link().read(into).status, LinkStatus::Down);
  EXPECT_EQ(link().write(into), LinkStatus::Down);
  link().discard_input();
  come_up();
  EXPECT_EQ(link().epoch(), 1U);
}

TEST_P(ByteLinkContract, NothingArrivedIsBusy) {
  come_up();
  std::array<std::uint8_t, 4> into{};
  const ByteRead read = link().read(into);
  EXPECT_EQ(read.status, LinkStatus::Busy);
  EXPECT_EQ(read.count, 0U);
  EXPECT_TRUE(link().is_up());
}

TEST_P(ByteLinkContract, NothingToReadIntoTakesNothing) {
  come_up();
  rig_->peer_write(Bytes{1});
  for (int i = 0; i < 100; ++i) {
    step();
    EXPECT_EQ(link().read({}).status, LinkStatus::Busy);
  }
  EXPECT_THAT(read_bytes(1), ElementsAreArray({1}));
}

TEST_P(ByteLinkContract, EveryByteValueArrivesAsItIs) {
  come_up();
  const Bytes all = every_value();
  rig_->peer_write(all);
  EXPECT_EQ(read_bytes(all.size()), all);
}

TEST_P(ByteLinkContract, EveryByteValueLeavesAsItIs) {
  come_up();
  const Bytes all = every_value();
  write_bytes(all);
  EXPECT_EQ(peer_read_bytes(all.size()), all);
  for (int i = 0; i < 100; ++i) {  // nothing is echoed
    step();
    std::array<std::uint8_t, 4> into{};
    ASSERT_EQ(link().read(into).status, LinkStatus::Busy);
  }
}

TEST_P(ByteLinkContract, ReadsInPiecesKeepTheOrder) {
  come_up();
  const Bytes sent = random_bytes(1000);
  rig_->peer_write(sent);
  Bytes got;
  std::array<std::uint8_t, 97> into{};
  for (std::size_t size = 1; got.size() < sent.size(); size = size % into.size() + 1) {
    const std::size_t want = std::min(size, sent.size() - got.size());
    const std::size_t before = got.size();
    ASSERT_TRUE(step_until([&] {
      const ByteRead read = link().read(std::span(into).first(want));
      EXPECT_LE(read.count, want);
      EXPECT_EQ(read.status == LinkStatus::Ok, read.count > 0);
      got.insert(got.end(), into.begin(), into.begin() + static_cast<std::ptrdiff_t>(read.count));
      return got.size() > before;
    })) << "seed "
        << kSeed << ", after " << before << " bytes";
  }
  EXPECT_EQ(got, sent);
}

TEST_P(ByteLinkContract, WritesKeepTheOrder) {
  come_up();
  Bytes sent;
  for (std::uint8_t i = 0; i < 50; ++i) {
    const Bytes piece(std::size_t{i} % 7 + 1, i);
    write_bytes(piece);
    sent.insert(sent.end(), piece.begin(), piece.end());
  }
  EXPECT_EQ(peer_read_bytes(sent.size()), sent);
}

TEST_P(ByteLinkContract, WritesAllOrNothingWhenTheQueueIsFull) {
  come_up();
  constexpr std::size_t kPiece = 1000;
  constexpr std::size_t kMost = 1'000'000;
  const Bytes source = random_bytes(kMost);
  std::size_t sent = 0;
  LinkStatus status = LinkStatus::Ok;
  while (status == LinkStatus::Ok && sent + kPiece <= kMost) {
    status = link().write(std::span(source).subspan(sent, kPiece));
    sent += status == LinkStatus::Ok ? kPiece : 0;
  }
  EXPECT_EQ(status, LinkStatus::Busy) << "no queue holds a megabyte";
  EXPECT_TRUE(link().is_up());
  const Bytes got = peer_read_bytes(sent);
  EXPECT_TRUE(got == Bytes(source.begin(), source.begin() + static_cast<std::ptrdiff_t>(sent)))
      << "seed " << kSeed << ": " << got.size() << " of " << sent << " bytes, or others";
  write_bytes(Bytes{1, 2, 3});
  EXPECT_THAT(peer_read_bytes(3), ElementsAreArray({1, 2, 3}));
}

TEST_P(ByteLinkContract, DiscardsWhatWasNotRead) {
  come_up();
  rig_->peer_write(Bytes(100, 7));
  ASSERT_EQ(read_bytes(1).size(), 1U);
  for (int i = 0; i < 1000; ++i) {
    step();
  }
  link().discard_input();
  rig_->peer_write(Bytes{42, 43});
  EXPECT_THAT(read_bytes(2), ElementsAreArray({42, 43}));
}

TEST_P(ByteLinkContract, StampsLieBetweenSendingAndReading) {
  come_up();
  const hal::Stamp before = rig_->stamping_clock();
  rig_->peer_write(Bytes{1});
  std::array<std::uint8_t, 4> into{};
  ByteRead read;
  ASSERT_TRUE(step_until([&] {
    read = link().read(into);
    return read.status == LinkStatus::Ok;
  }));
  EXPECT_GE(read.stamp, before);
  EXPECT_LE(read.stamp, rig_->stamping_clock());
}

TEST_P(ByteLinkContract, ComesBackAfterALoss) {
  come_up();
  for (std::uint32_t i = 1; i <= 10; ++i) {
    cut_and_notice();
    std::array<std::uint8_t, 4> into{};
    EXPECT_EQ(link().read(into).status, LinkStatus::Down);
    EXPECT_EQ(link().write(into), LinkStatus::Down);
    EXPECT_EQ(link().epoch(), i);
    rig_->restore();
    come_up();
    EXPECT_EQ(link().epoch(), i + 1);
    rig_->peer_write(Bytes{1, 2});
    EXPECT_THAT(read_bytes(2), ElementsAreArray({1, 2}));
    write_bytes(Bytes{3, 4});
    EXPECT_THAT(peer_read_bytes(2), ElementsAreArray({3, 4}));
  }
}

TEST_P(ByteLinkContract, StaysDownWhileTheDeviceIsAwayAndIsBackWithinTheLongestWait) {
  come_up();
  cut_and_notice();
  for (int i = 0; i < 1000; ++i) {
    step(std::chrono::milliseconds(10));
    ASSERT_FALSE(link().is_up());
  }
  EXPECT_EQ(link().epoch(), 1U);
  rig_->restore();
  const hal::Stamp restored = rig_->now();
  come_up();
  EXPECT_LE(rig_->now() - restored, std::chrono::milliseconds(2001));
  EXPECT_EQ(link().epoch(), 2U);
}

TEST_P(ByteLinkContract, ChangesTheLineRate) {
  come_up();
  const std::uint32_t first = link().baud();
  for (const std::uint32_t baud : {19'200U, 115'200U, 256'000U, 1'000'000U, first}) {
    if (!rig_->takes_baud(baud)) {
      const std::uint32_t before = link().baud();
      EXPECT_EQ(link().set_baud(baud), LinkStatus::Down) << baud;
      EXPECT_EQ(link().baud(), before);
      continue;
    }
    EXPECT_EQ(link().set_baud(baud), LinkStatus::Ok) << baud;
    EXPECT_EQ(link().baud(), baud);
    rig_->set_peer_baud(baud);
    write_bytes(Bytes{0x55, 0xAA, 0x00});
    EXPECT_THAT(peer_read_bytes(3), ElementsAreArray({0x55, 0xAA, 0x00})) << baud;
    rig_->peer_write(Bytes{0x33, 0xFF});
    EXPECT_THAT(read_bytes(2), ElementsAreArray({0x33, 0xFF})) << baud;
  }
}

TEST_P(ByteLinkContract, RefusesImpossibleRates) {
  come_up();
  const std::uint32_t before = link().baud();
  for (const std::uint32_t baud : {0U, 1U, 4'000'000'000U}) {
    EXPECT_EQ(link().set_baud(baud), LinkStatus::Down) << baud;
    EXPECT_EQ(link().baud(), before);
  }
  EXPECT_TRUE(link().is_up());
}

TEST_P(ByteLinkContract, KeepsTheLineRateOverALoss) {
  come_up();
  EXPECT_EQ(link().set_baud(19'200), LinkStatus::Ok);
  cut_and_notice();
  EXPECT_EQ(link().baud(), 19'200U);
  EXPECT_EQ(link().set_baud(38'400), LinkStatus::Down);
  EXPECT_EQ(link().baud(), 38'400U);
  rig_->restore();
  come_up();
  EXPECT_EQ(link().baud(), 38'400U);
  rig_->set_peer_baud(38'400);
  rig_->peer_write(Bytes{9, 8, 7});
  EXPECT_THAT(read_bytes(3), ElementsAreArray({9, 8, 7}));
}

TEST_P(ByteLinkContract, NeverAsksTheHeap) {
  if (!NoAllocScope::works()) {
    GTEST_SKIP() << "SKIPPED: the sanitizer's heap cannot be watched";
  }
  come_up();
  rig_->peer_write(Bytes{1, 2, 3});
  rig_->pass(std::chrono::milliseconds(10));
  std::array<std::uint8_t, 64> buffer{};
  std::uint64_t calls = 0;
  const auto work = [&] {
    const NoAllocScope scope;
    link().service(rig_->now());
    static_cast<void>(link().read(buffer));
    static_cast<void>(link().write(std::span(buffer).first(8)));
    static_cast<void>(link().set_baud(19'200));
    link().discard_input();
    calls += scope.heap_calls();
  };
  for (int i = 0; i < 100; ++i) {
    rig_->pass(std::chrono::milliseconds(1));
    work();
  }
  rig_->cut();
  for (int i = 0; i < 500; ++i) {
    rig_->pass(std::chrono::milliseconds(10));
    work();
  }
  EXPECT_FALSE(link().is_up());
  rig_->restore();
  for (int i = 0; i < 500; ++i) {
    rig_->pass(std::chrono::milliseconds(10));
    work();
  }
  EXPECT_TRUE(link().is_up());
  if (rig_->promises_no_heap()) {
    EXPECT_EQ(calls, 0U);
  }
}

}  // namespace
}  // namespace slamsensor::tests
