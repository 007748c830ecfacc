#include "firmware/supervision/log.hpp"

#include "firmware/supervision/file_descriptor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <thread>
#include <vector>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

hal::Stamp test_now{};
hal::Stamp fake_now() noexcept {
  return test_now;
}
hal::Stamp fake_ahead() noexcept {
  return 1'769'860'800s;  // 2026-01-31 12:00:00 UTC at 0 of the clock
}

struct LogTest : testing::Test {
  LogTest() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC), 0);
    reader = FileDescriptor(ends[0]);
    writer = FileDescriptor(ends[1]);
    test_now = {};
    config.fd = writer.get();
    config.now = fake_now;
    config.utc_ahead = fake_ahead;
    config.style = LogStyle::Journal;
  }

  std::string written() const {
    std::string text;
    std::array<char, 65536> bytes;
    for (ssize_t size = 0; (size = ::read(reader.get(), bytes.data(), bytes.size())) > 0;) {
      text.append(bytes.data(), static_cast<std::size_t>(size));
    }
    return text;
  }

  FileDescriptor reader;
  FileDescriptor writer;
  LogConfig config;
};

TEST_F(LogTest, JournalLinesBeginWithTheirPriority) {
  Log log(config);
  log.set_level(LogLevel::Debug);
  log.error("a");
  log.warning("b");
  log.notice("c");
  log.info("d\ne");
  log.debug("f\tg");
  EXPECT_EQ(written(), "<3>a\n<4>b\n<5>c\n<6>d\n<6>e\n<7>f?g\n");
}

TEST_F(LogTest, PlainLinesBeginWithTheTime) {
  config.style = LogStyle::Plain;
  Log log(config);
  test_now = 61'042'999'999ns;
  log.warning("rangefinder lost");
  EXPECT_EQ(written(), "2026-01-31T12:01:01.042Z warning: rangefinder lost\n");
}

TEST_F(LogTest, WhatIsNotShownIsNotCounted) {
  config.level = LogLevel::Warning;
  Log log(config);
  for (int i = 0; i < 10; ++i) {
    log.info("x");
  }
  log.flush();
  EXPECT_EQ(written(), "");
}

TEST_F(LogTest, AFloodBecomesANumber) {
  config.repeats_per_minute = 2;
  Log log(config);
  for (int i = 0; i < 1000; ++i) {
    log.warning("no reply after " + std::to_string(i) + " ms");
  }
  log.warning("something else");
  EXPECT_EQ(written(), "<4>no reply after 0 ms\n<4>no reply after 1 ms\n<4>something else\n");
  test_now = 60s - 1ns;
  log.tick();
  EXPECT_EQ(written(), "");
  test_now = 60s;
  log.tick();
  EXPECT_EQ(written(), "<4>repeated 998 times more: no reply after 999 ms\n");
  log.warning("no reply after 5 ms");
  EXPECT_EQ(written(), "<4>no reply after 5 ms\n");
}

TEST_F(LogTest, TheNextMinuteBeginsWithTheSumOfTheLast) {
  config.repeats_per_minute = 1;
  Log log(config);
  log.error("x");
  log.error("x");
  test_now = 61s;
  log.error("x");
  EXPECT_EQ(written(), "<3>x\n<3>repeated 1 times more: x\n<3>x\n");
}

TEST_F(LogTest, ManyDifferentMessagesPushOutTheOldestWithItsSum) {
  config.repeats_per_minute = 1;
  Log log(config);
  log.info("first");
  log.info("first");
  static_cast<void>(written());
  for (char c = 'A'; c <= 'z'; ++c) {  // 58 messages
    test_now += 1ms;
    log.info(std::string(1, c));
  }
  for (const char* more : {"aa", "ab", "ac", "ad", "ae", "af", "ag"}) {
    test_now += 1ms;
    log.info(more);
  }
  EXPECT_THAT(written(), HasSubstr("<6>repeated 1 times more: first\n"));
}

TEST_F(LogTest, FlushWritesAll) {
  config.repeats_per_minute = 1;
  Log log(config);
  log.error("x");
  log.error("x");
  log.flush();
  EXPECT_EQ(written(), "<3>x\n<3>repeated 1 times more: x\n");
}

TEST_F(LogTest, ThreadsDoNotMixTheirLines) {
  config.repeats_per_minute = 1000;
  Log log(config);
  std::vector<std::thread> threads;
  for (char c = 'a'; c < 'e'; ++c) {
    threads.emplace_back([&log, c] {
      for (int i = 0; i < 100; ++i) {
        log.info(std::string(50, c));
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  std::string text = written();
  std::size_t lines = 0;
  for (; !text.empty(); text.erase(0, 54), ++lines) {
    ASSERT_GE(text.size(), 54U);
    ASSERT_EQ(text.substr(0, 54), "<6>" + std::string(50, text[3]) + '\n');
  }
  EXPECT_EQ(lines, 400U);
}

TEST_F(LogTest, AFullOrClosedPipeLosesTheLineAndNothingElse) {
  Log log(config);
  for (int i = 0; i < 5000; ++i) {
    log.info(std::string(static_cast<std::size_t>(1 + i % 1000), 'x'));
  }
  log.info("done");
}

TEST_F(LogTest, TheJournalIsKnownByItsStream) {
  struct stat status {};
  ASSERT_EQ(::fstat(writer.get(), &status), 0);
  const std::string own = std::to_string(status.st_dev) + ':' + std::to_string(status.st_ino);
  ::setenv("JOURNAL_STREAM", own.c_str(), 1);
  EXPECT_EQ(log_style(writer.get()), LogStyle::Journal);
  ::setenv("JOURNAL_STREAM", (own + "1").c_str(), 1);
  EXPECT_EQ(log_style(writer.get()), LogStyle::Plain);
  ::unsetenv("JOURNAL_STREAM");
  EXPECT_EQ(log_style(writer.get()), LogStyle::Plain);
}

// A log whose reader has stopped reading, for each kind of reader: a pipe and journald's socket.
class UnreadLog : public LogTest, public testing::WithParamInterface<bool> {
 protected:
  UnreadLog() {
    std::array<int, 2> ends{};
    const bool is_socket = GetParam();
    EXPECT_EQ(is_socket ? ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data())
                        : ::pipe2(ends.data(), O_CLOEXEC),
              0);  // writing would wait
    reader = FileDescriptor(ends[0]);
    writer = FileDescriptor(ends[1]);
    ::fcntl(reader.get(), F_SETFL, O_NONBLOCK);
    config.fd = writer.get();
    config.repeats_per_minute = 1'000'000;
  }
};

TEST_P(UnreadLog, LosesLinesInsteadOfWaitingAndSaysHowMany) {
  Log log(config);
  const std::string line(1000, 'x');
  for (int i = 0; i < 2000; ++i) {
    log.info(line);
  }
  const std::uint64_t lost = log.lost();
  EXPECT_GT(lost, 0U);
  const std::string before = written();
  EXPECT_GE(std::count(before.begin(), before.end(), '\n') + static_cast<std::ptrdiff_t>(lost), 2000);
  log.info("again");
  log.info("and again");
  const std::string after = written();
  EXPECT_THAT(after, HasSubstr("<4>" + std::to_string(lost) + " lines of this log were lost"));
  EXPECT_THAT(after, testing::EndsWith("<6>again\n<6>and again\n"));
  EXPECT_EQ(log.lost(), lost);
}

INSTANTIATE_TEST_SUITE_P(PipeAndSocket, UnreadLog, testing::Bool());

TEST_F(LogTest, ALineIsUtf8WhateverItIsMadeOf) {
  Log log(config);
  log.info("a\xFFz \xC3\xA9 \xE2\x82 \xC0\xAF \xED\xA0\x80 \xF0\x9F\x8C\xB2 \xF5");
  EXPECT_EQ(written(), "<6>a?z \xC3\xA9 ?? ?? ??? \xF0\x9F\x8C\xB2 ?\n");
}

}  // namespace
}  // namespace slamsensor::firmware
