#include "firmware/recording/event_log.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"
#include "tools/recording/recording_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <lcm/eventlog.h>
#include <sstream>

namespace slamsensor::tools {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct Event {
  std::int64_t number;
  std::int64_t utime_us;
  std::string channel;
  Bytes data;
  friend bool operator==(const Event&, const Event&) = default;
};

std::vector<Event> sample_events() {
  return {{0, 1'700'000'000'000'000, "POSE", Bytes(144, 0x2E)},
          {1, 1'700'000'000'000'001, "A", {}},
          {2, 1'700'000'000'000'500, std::string(63, 'x'), Bytes(70'000, 0xED)},
          {3, 1'700'000'000'001'000, "POSE", {1, 2, 3}}};
}

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string written(const std::vector<Event>& events) {
  const TempFolder folder;
  const auto path = folder.path() / "log";
  auto log = firmware::EventLogWriter::create(path, firmware::ExistingFile::Refuse);
  for (const Event& event : events) {
    EXPECT_TRUE(log->write(event.utime_us, event.channel, event.data));
  }
  EXPECT_TRUE(log->close());
  return content(path);
}

struct Read {
  std::vector<Event> events;
  std::uint64_t passed_over = 0;
  bool is_truncated = false;
};

Read read_all(const std::string& bytes) {
  std::istringstream stream(bytes);
  EventLogReader reader(stream);
  Read read;
  while (const auto event = reader.next()) {
    read.events.push_back({event->number, event->utime_us, std::string(event->channel),
                           Bytes(event->data.begin(), event->data.end())});
  }
  read.passed_over = reader.bytes_passed_over();
  read.is_truncated = reader.is_truncated();
  return read;
}

TEST(EventLogReader, ReadsWhatTheWriterWrote) {
  const Read read = read_all(written(sample_events()));
  EXPECT_EQ(read.events, sample_events());
  EXPECT_EQ(read.passed_over, 0U);
  EXPECT_FALSE(read.is_truncated);
}

TEST(EventLogReader, ATruncatedTailIsTheEnd) {
  const std::string whole = written(sample_events());
  for (const std::size_t lacking : {1U, 3U, 10U, 30U}) {
    const Read read = read_all(whole.substr(0, whole.size() - lacking));
    EXPECT_EQ(read.events.size(), 3U) << lacking;
    EXPECT_TRUE(read.is_truncated) << lacking;
    EXPECT_EQ(read.passed_over, 0U) << lacking;
  }
  EXPECT_TRUE(read_all("").events.empty());
}

TEST(EventLogReader, CountsOnlyTheBytesBehindTheLastEvent) {
  const std::string whole = written(sample_events());
  for (const std::string& more :
       {std::string(1, '\0'), std::string("some text"), std::string(5'000, '\xED')}) {
    const Read read = read_all(whole + more);
    EXPECT_EQ(read.events, sample_events());
    EXPECT_EQ(read.passed_over, more.size());
    EXPECT_FALSE(read.is_truncated);
    const Read twice = read_all(whole + more + whole);
    EXPECT_EQ(twice.events.size(), 2 * sample_events().size());
    EXPECT_EQ(twice.passed_over, more.size());
  }
}

TEST(EventLogReader, HuntsForTheNextEvent) {
  const std::string whole = written(sample_events());
  const Read begun_late = read_all(whole.substr(1));
  EXPECT_EQ(begun_late.events.size(), 3U);
  EXPECT_EQ(begun_late.passed_over, 28U + 4U + 144U - 1U);
  const Read between = read_all("some text" + whole);
  EXPECT_EQ(between.events, sample_events());
  EXPECT_EQ(between.passed_over, 9U);
}

TEST(EventLogReader, AnyTurnedByteCostsAtMostTwoEvents) {
  const std::string whole = written(sample_events());
  const auto all = sample_events();
  for (std::size_t i = 0; i < whole.size(); i += i < 300 || i > 70'300 ? 1 : 997) {
    for (const char mask : {'\x01', '\x40', '\x7F'}) {
      std::string bad = whole;
      bad[i] = static_cast<char>(bad[i] ^ mask);
      const Read read = read_all(bad);
      std::size_t good = 0;
      for (const Event& event : read.events) {
        good += std::find(all.begin(), all.end(), event) != all.end() ? 1 : 0;
      }
      EXPECT_GE(good, all.size() - 2) << "byte " << i << " ^ " << int{mask};
    }
  }
}

TEST(EventLogReader, ALyingLengthTakesNoMemoryAndNoFollower) {
  const std::string whole = written(sample_events());
  std::string bad = whole;
  bad[24] = 0x0F;  // 251 MB of data
  const Read read = read_all(bad);
  EXPECT_EQ(read.events.size(), 3U);
  EXPECT_FALSE(read.is_truncated);
  bad[24] = 0x7F;  // more than any event has
  EXPECT_EQ(read_all(bad).events.size(), 3U);
  bad = whole;
  bad[20] = static_cast<char>(0xFF);  // a channel of negative length
  EXPECT_EQ(read_all(bad).events.size(), 3U);
  bad = whole;
  bad[23] = 0;  // a channel without a name
  EXPECT_EQ(read_all(bad).events.size(), 3U);
}

TEST(EventLogReader, ASyncWordInTheDataIsData) {
  auto events = sample_events();
  events[0].data = {0xED, 0xA1, 0xDA, 0x01, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  0,
                    0,    0,    0,    0,    0, 0, 0, 0, 1, 0, 0, 0, 0, 'x'};
  EXPECT_EQ(read_all(written(events)).events, events);
}

// liblcm's own reader and writer of event logs, as lcm-logger and lcm-logplayer have them.
TEST(EventLogReader, LiblcmReadsOursAndWeReadLiblcms) {
  const TempFolder folder;
  const auto ours = folder.write("ours", written(sample_events()));
  const std::string theirs = (folder.path() / "theirs").string();
  lcm_eventlog_t* const in = lcm_eventlog_create(ours.c_str(), "r");
  lcm_eventlog_t* const out = lcm_eventlog_create(theirs.c_str(), "w");
  ASSERT_NE(in, nullptr);
  ASSERT_NE(out, nullptr);
  std::vector<Event> read;
  while (lcm_eventlog_event_t* const event = lcm_eventlog_read_next_event(in)) {
    const auto* const data = static_cast<const std::uint8_t*>(event->data);
    read.push_back({event->eventnum, event->timestamp,
                    std::string(event->channel, static_cast<std::size_t>(event->channellen)),
                    Bytes(data, data + event->datalen)});
    EXPECT_EQ(lcm_eventlog_write_event(out, event), 0);
    lcm_eventlog_free_event(event);
  }
  lcm_eventlog_destroy(in);
  lcm_eventlog_destroy(out);
  EXPECT_EQ(read, sample_events());
  EXPECT_EQ(read_all(content(theirs)).events, sample_events());
  EXPECT_EQ(content(theirs), content(ours));
}

}  // namespace
}  // namespace slamsensor::tools
