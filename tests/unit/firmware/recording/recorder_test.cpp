#include "firmware/recording/recorder.hpp"

#include "firmware/config/list_config.hpp"
#include "firmware/config/load_config.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sys/resource.h>
#include <unistd.h>

namespace slamsensor::firmware {
namespace {

using Bytes = std::vector<std::uint8_t>;

class RecorderTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  [[nodiscard]] std::string content() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  const std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) /
                                      (std::string("recorder.") + std::to_string(::getpid()) + ".lcm");
};

TEST_F(RecorderTest, AnEventIsWhatLcmLoggerWrites) {
  auto log = EventLogWriter::create(path_, ExistingFile::Refuse);
  ASSERT_TRUE(log);
  EXPECT_TRUE(log->write(1'700'000'000'000'000, "POSE", Bytes(144, 0x2E)));
  EXPECT_TRUE(log->close());
  const Bytes head = {0xED, 0xA1, 0xDA, 0x01, 0, 0, 0, 0, 0, 0, 0, 0,    0x00, 0x06, 0x0A, 0x24,
                      0x18, 0x1E, 0x40, 0x00, 0, 0, 0, 4, 0, 0, 0, 0x90, 'P',  'O',  'S',  'E'};
  const std::string file = content();
  ASSERT_EQ(file.size(), head.size() + 144);
  EXPECT_TRUE(std::equal(head.begin(), head.end(), file.begin(),
                         [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); }));
  EXPECT_FALSE(log->write(0, "POSE", {}));
}

TEST_F(RecorderTest, RefusesWhatLcmCannotCarry) {
  auto log = EventLogWriter::create(path_, ExistingFile::Refuse);
  ASSERT_TRUE(log);
  EXPECT_FALSE(log->write(0, "", Bytes(1)));
  EXPECT_FALSE(log->write(0, std::string(64, 'x'), Bytes(1)));
  EXPECT_TRUE(log->write(0, std::string(63, 'x'), Bytes(1)));
  EXPECT_EQ(log->events(), 1U);
  EXPECT_EQ(log->bytes(), 28U + 63U + 1U);
}

TEST_F(RecorderTest, LeavesAnExistingFileAloneUnlessAsked) {
  std::ofstream(path_) << "precious";
  const auto refused = Recorder::create({.path = path_});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find(path_.string()), std::string::npos);
  EXPECT_NE(refused.error().message.find("choose another name"), std::string::npos);
  EXPECT_EQ(content(), "precious");
  EXPECT_TRUE(Recorder::create({.path = path_, .existing = ExistingFile::Replace}));
  EXPECT_EQ(content(), "");
}

TEST_F(RecorderTest, EndsWithWholeEventsAtItsLargestSize) {
  auto recorder = Recorder::create({.path = path_, .bytes_max = 1000});
  ASSERT_TRUE(recorder);
  for (int i = 0; i < 20; ++i) {
    recorder->message(i, "CHANNEL", Bytes(100));
  }
  EXPECT_EQ(recorder->state(), RecorderState::Full);
  EXPECT_EQ(recorder->events(), 7U);
  EXPECT_EQ(recorder->dropped(), 13U);
  EXPECT_EQ(content().size(), 7U * 135U);
  EXPECT_NE(recorder->text().find("record.size_max_mb"), std::string::npos);
  EXPECT_TRUE(recorder->close());
  EXPECT_EQ(recorder->state(), RecorderState::Full);
}

/// A disk that is full after so many bytes, for this process.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit before_{};
};

// The disk takes a part of what waits to be written: all of it was cut off again, in a short recording all
// that there was.
TEST_F(RecorderTest, OnAFullDiskTheWholeEventsUpToThereAreKept) {
  auto recorder = Recorder::create({.path = path_});
  ASSERT_TRUE(recorder);
  for (int i = 0; i < 20; ++i) {
    recorder->message(i, "CHANNEL", Bytes(100));
  }
  {
    const SmallDisk disk(1000);
    recorder->flush();
  }
  EXPECT_EQ(recorder->state(), RecorderState::Failed);
  EXPECT_EQ(recorder->bytes(), 7U * 135U);
  EXPECT_NE(recorder->text().find("up to then is kept"), std::string::npos) << recorder->text();
  EXPECT_FALSE(recorder->close());
  EXPECT_EQ(content().size(), 7U * 135U);
}

TEST(Recorder, AFullDiskEndsItAndIsReported) {
  auto recorder = Recorder::create({.path = "/dev/full", .existing = ExistingFile::Replace});
  ASSERT_TRUE(recorder) << recorder.error().message;
  recorder->message(0, "CHANNEL", Bytes(100));
  EXPECT_EQ(recorder->state(), RecorderState::Recording);
  recorder->flush();
  EXPECT_EQ(recorder->state(), RecorderState::Failed);
  EXPECT_NE(recorder->text().find("No space left on device"), std::string::npos);
  recorder->message(0, "CHANNEL", Bytes(100));
  EXPECT_EQ(recorder->dropped(), 1U);
  EXPECT_FALSE(recorder->close());
}

TEST(MapOrder, ReadsBackWhatItWrites) {
  for (const auto kind : {MapCommand::Reset, MapCommand::Freeze, MapCommand::Unfreeze, MapCommand::Restore}) {
    const auto order = parse_map_order(text_of({kind, 4'000'000'000}));
    ASSERT_TRUE(order);
    EXPECT_EQ(order->kind, kind);
    EXPECT_EQ(order->scan, 4'000'000'000);
  }
  EXPECT_EQ(text_of({MapCommand::Freeze, 12}), "freeze 12");
  for (const char* const text :
       {"", "reset", "reset ", "reset -1", "reset 1 ", "rest 1", "reset 4294967296"}) {
    EXPECT_FALSE(parse_map_order(text)) << text;
  }
}

TEST(ConfigToml, LoadsAsTheSameConfiguration) {
  LoadedConfig odd;
  const auto errors = apply_layer(odd,
                                  "detection.range_max_m = 123.456\n"
                                  "scan.pan_max_deg = 33.3\n"
                                  "[datum]\nlatitude_deg = 1.5\nlongitude_deg = -2.25\nheight_m = 3.0\n"
                                  "bearing_deg = 4.0\n",
                                  "test");
  ASSERT_TRUE(errors.empty()) << error_lines(errors);
  for (const Config& config : {Config{}, odd.config}) {
    const std::string toml = config_toml(config);
    LoadedConfig loaded;
    const auto mistakes = apply_config_toml(loaded, toml, "test");
    ASSERT_TRUE(mistakes.empty()) << error_lines(mistakes);
    EXPECT_EQ(config_toml(loaded.config), toml);
    EXPECT_EQ(loaded.config.datum.has_value(), config.datum.has_value());
    EXPECT_EQ(loaded.config.core.detection.range_max_m, config.core.detection.range_max_m);
    EXPECT_EQ(loaded.config.scan_head.scan.pan_max_rad, config.scan_head.scan.pan_max_rad);
    for (const Setting& setting : settings()) {
      if (const auto* const real = std::get_if<RealSetting>(&setting.kind)) {
        const double* const wanted = real->member.read(config);
        const double* const got = real->member.read(loaded.config);
        ASSERT_EQ(wanted == nullptr, got == nullptr) << setting.path;
        EXPECT_TRUE(wanted == nullptr || *wanted == *got) << setting.path;
      }
    }
  }
}

TEST(ConfigToml, BitsThatAreNotThoseOfTheNumberArePassedOver) {
  for (const char* const line :
       {"# bits: scan.pan_max_deg 4024000000000000\n", "# bits: scan.pan_max_deg 7ff8000000000000\n",
        "# bits: scan.pan_max_deg\n", "# bits: scan.pan_max_deg 4001f\n", "# bits: no.such 0\n",
        "# bits: scan.mode 0\n", "# bits: ", "# bits: scan.pan_max_deg 4001f3x"}) {
    LoadedConfig loaded;
    EXPECT_TRUE(apply_config_toml(loaded, line, "test").empty()) << line;
    EXPECT_EQ(config_toml(loaded.config), config_toml(Config{})) << line;
  }
}

}  // namespace
}  // namespace slamsensor::firmware
