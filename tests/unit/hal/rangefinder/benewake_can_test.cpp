#include "hal/rangefinder/benewake_driver.hpp"
#include "tests/unit/hal/rangefinder/tf03_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <string>
#include <vector>

namespace slamsensor::hal {
namespace {

using std::chrono::milliseconds;
using tests::hex_text;
using tests::kVersion;
using tests::Tf03;

/// A bus on which a test plays the device.
class ScriptedBus final : public CanLink {
 public:
  void service(Stamp) noexcept override {}
  [[nodiscard]] std::uint32_t epoch() const noexcept override { return 1; }
  [[nodiscard]] bool is_up() const noexcept override { return up; }
  [[nodiscard]] CanRead receive() noexcept override {
    if (incoming.empty()) {
      return {};
    }
    const CanRead read = incoming.front();
    incoming.pop_front();
    return read;
  }
  [[nodiscard]] LinkStatus send(const CanFrame& frame) noexcept override {
    sent.push_back(frame);
    return LinkStatus::Ok;
  }

  std::deque<CanRead> incoming;
  std::vector<CanFrame> sent;
  bool up = true;
};

CanFrame can_frame(std::uint32_t id, const std::string& bytes) {
  CanFrame frame{.id = id, .size = static_cast<std::uint8_t>(bytes.size())};
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  return frame;
}

struct CanBench {
  ScriptedBus bus;
  std::unique_ptr<Rangefinder> driver;
  Tf03 device;
  std::string data = hex_text("D2 04 B0 04 00 00 00 00");
  Stamp now = milliseconds(1000);
  std::vector<RangeSample> samples;
  bool pads = false;

  void run(int count) {
    for (int i = 0; i < count; ++i) {
      now += milliseconds(1);
      driver->step(now);
      for (const CanFrame& frame : bus.sent) {
        const std::string request(frame.bytes().begin(), frame.bytes().end());
        std::string reply = device.answer(request);
        reply.resize(pads && !reply.empty() ? 8 : reply.size(), '\0');
        bus.incoming.push_back({LinkStatus::Ok, can_frame(0x003, reply), now});
      }
      bus.sent.clear();
      if (!device.tick(i).empty()) {
        bus.incoming.push_back({LinkStatus::Ok, can_frame(0x003, data), now});
        bus.incoming.push_back({LinkStatus::Ok, can_frame(0x123, data), now});  // another node
      }
      std::array<RangeSample, 16> some{};
      const std::size_t taken = driver->take(some);
      samples.insert(samples.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(taken));
    }
  }
};

TEST(BenewakeCan, SetsUpAndReads) {
  for (const bool pads : {false, true}) {
    for (const std::size_t size : {4u, 6u, 8u}) {
      CanBench bench;
      bench.pads = pads;
      bench.data = bench.data.substr(0, size);
      bench.driver = *make_benewake_can({}, bench.bus);
      bench.run(2000);
      ASSERT_EQ(bench.driver->state(), DeviceState::Ready) << bench.driver->problem();
      EXPECT_EQ(bench.device.period_ms, 1);
      ASSERT_GT(bench.samples.size(), 1500u);
      EXPECT_DOUBLE_EQ(bench.samples[0].range_m, 12.34);
      EXPECT_DOUBLE_EQ(bench.samples[0].strength, 1200.0);
    }
  }
}

TEST(BenewakeCan, CommandsGoToTheHostIdAndCanBeLeftOut) {
  CanBench bench;
  bench.driver = *make_benewake_can({}, bench.bus);
  bench.driver->step(bench.now);
  ASSERT_EQ(bench.bus.sent.size(), 1u);
  EXPECT_EQ(bench.bus.sent[0].id, 0x3003u);
  EXPECT_TRUE(bench.bus.sent[0].extended);
  EXPECT_EQ(std::string(bench.bus.sent[0].bytes().begin(), bench.bus.sent[0].bytes().end()), kVersion);

  BenewakeCanConfig config;
  config.commands = BenewakeCanConfig::Commands::None;
  config.device.rate_hz = 100.0;
  CanBench silent;
  silent.driver = *make_benewake_can(config, silent.bus);
  silent.run(2000);
  EXPECT_EQ(silent.driver->state(), DeviceState::Ready);
  EXPECT_GT(silent.samples.size(), 150u);
}

TEST(BenewakeCan, ShortFramesAreCountedAndNotRead) {
  CanBench bench;
  bench.driver = *make_benewake_can({}, bench.bus);
  bench.run(1000);
  bench.samples.clear();
  bench.data = hex_text("D2 04 B0");
  bench.run(100);
  bench.samples.clear();
  bench.run(100);
  EXPECT_TRUE(bench.samples.empty());
}

TEST(BenewakeCan, WrongIdsAreNamed) {
  ScriptedBus bus;
  BenewakeCanConfig config;
  config.device_id = 0x3003;
  EXPECT_FALSE(make_benewake_can(config, bus));
  config = {};
  config.bitrate = 0;
  EXPECT_FALSE(make_benewake_can(config, bus));
}

}  // namespace
}  // namespace slamsensor::hal
