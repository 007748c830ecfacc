#include "firmware/daemon/handover.hpp"

#include <gtest/gtest.h>

#include <random>
#include <thread>
#include <vector>

namespace slamsensor::firmware {
namespace {

constexpr std::uint32_t kSeed = 20261123;

std::vector<core::Reading> readings_of(std::size_t count, double first) {
  std::vector<core::Reading> readings(count);
  for (core::Reading& reading : readings) {
    reading.range_m = first;
    first += 1.0;
  }
  return readings;
}

Scanline line_of(std::span<const core::Reading> readings, std::uint32_t number) {
  Scanline line;
  line.readings = readings;
  line.line = number;
  return line;
}

TEST(ScanQueue, HandsOverInOrder) {
  ScanQueue queue(4, 100);
  const auto readings = readings_of(100, 5.0);
  EXPECT_TRUE(queue.push(ScanBegun{3}));
  EXPECT_TRUE(queue.push(line_of(readings, 9)));
  EXPECT_TRUE(queue.push(ScanAborted{3, ScanAbort::PanStalled}));
  EXPECT_TRUE(queue.push(ScanEnded{.scan = 4, .lines = 7}));

  EXPECT_EQ(std::get<ScanBegun>(*queue.take()).scan, 3U);
  const auto line = std::get<Scanline>(*queue.take());
  EXPECT_EQ(line.line, 9U);
  ASSERT_EQ(line.readings.size(), 100U);
  EXPECT_EQ(line.readings[99].range_m, 104.0);
  EXPECT_EQ(std::get<ScanAborted>(*queue.take()).reason, ScanAbort::PanStalled);
  EXPECT_EQ(std::get<ScanEnded>(*queue.take()).lines, 7U);
  EXPECT_FALSE(queue.take());
}

TEST(ScanQueue, ScanlinesWithoutRoomAreDroppedAndCountedButMarksGoThrough) {
  ScanQueue queue(2, 100);
  const auto readings = readings_of(100, 0.0);
  EXPECT_TRUE(queue.push(line_of(readings, 0)));
  EXPECT_TRUE(queue.push(line_of(readings, 1)));
  EXPECT_FALSE(queue.push(line_of(readings, 2)));
  EXPECT_TRUE(queue.push(ScanEnded{}));
  EXPECT_EQ(queue.scanlines_dropped(), 1U);
  EXPECT_EQ(queue.messages_dropped(), 0U);

  EXPECT_EQ(std::get<Scanline>(*queue.take()).line, 0U);
  EXPECT_EQ(std::get<Scanline>(*queue.take()).line, 1U);
  EXPECT_TRUE(std::holds_alternative<ScanEnded>(*queue.take()));
}

TEST(ScanQueue, CountsMarksThatFindNoRoom) {
  ScanQueue queue(2, 10);
  while (queue.push(ScanBegun{})) {
  }
  EXPECT_EQ(queue.messages_dropped(), 1U);
}

TEST(ScanQueue, ALineOfFullLengthAlwaysFitsIntoAnEmptyQueue) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  ScanQueue queue(4, 50);
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    const auto readings = readings_of(random() % 4 == 0 ? 50 : random() % 51, i);
    ASSERT_TRUE(queue.push(line_of(readings, i))) << i;
    const auto line = std::get<Scanline>(*queue.take());
    ASSERT_EQ(line.line, i);
    ASSERT_EQ(line.readings.size(), readings.size());
    ASSERT_FALSE(queue.take());
  }
}

TEST(ScanQueue, TwoThreadsLoseNothingUnseen) {
  SCOPED_TRACE(kSeed);
  ScanQueue queue(8, 64);
  constexpr std::uint32_t kLines = 200'000;
  std::uint64_t pushed = 0;
  std::thread writer([&] {
    std::mt19937 random(kSeed);
    for (std::uint32_t i = 0; i < kLines; ++i) {
      const auto readings = readings_of(1 + random() % 64, i);
      pushed += queue.push(line_of(readings, i)) ? 1U : 0U;
    }
    while (!queue.push(ScanEnded{})) {
      std::this_thread::yield();
    }
  });
  std::uint64_t taken = 0;
  std::uint32_t next = 0;
  bool in_order = true;
  for (bool ended = false; !ended;) {
    const auto message = queue.take();
    if (!message) {
      std::this_thread::yield();
    } else if (const auto* line = std::get_if<Scanline>(&*message)) {
      in_order = in_order && line->line >= next && !line->readings.empty();
      for (std::size_t i = 0; i < line->readings.size(); ++i) {
        in_order = in_order && line->readings[i].range_m == static_cast<double>(line->line + i);
      }
      next = line->line + 1;
      ++taken;
    } else {
      ended = true;
    }
  }
  writer.join();
  EXPECT_TRUE(in_order);
  EXPECT_EQ(taken, pushed);
  EXPECT_EQ(queue.scanlines_dropped(), kLines - pushed);
}

}  // namespace
}  // namespace slamsensor::firmware
