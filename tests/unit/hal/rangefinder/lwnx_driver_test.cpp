#include "tests/unit/hal/rangefinder/lwnx_bench.hpp"

#include <gtest/gtest.h>

namespace slamsensor::hal {
namespace {

using std::chrono::milliseconds;
using namespace tests;  // NOLINT(google-build-using-namespace)

TEST(LwnxDriver, StartsALw20ThatSwallowsItsFirstRequests) {
  RangeBench bench;
  LightWare device;
  connect(bench, device, config_at(388.0));
  ASSERT_TRUE(bench.run_until_ready(3000)) << bench.driver->problem();
  EXPECT_EQ(bench.writes[0].text, "www\r\n");
  EXPECT_EQ(bench.writes[1].text, hex_text("AA 40 00 00 70 9F"));
  EXPECT_EQ(bench.writes[2].at - bench.writes[1].at, milliseconds(200));
  EXPECT_TRUE(bench.was_written(hex_text("AA 41 01 1E 00 00 00 00 4A FC")));  // quiet first
  EXPECT_TRUE(bench.was_written(hex_text("AA 41 01 1B 11 00 00 00 0E B2")));
  EXPECT_TRUE(bench.was_written(hex_text("AA 81 00 5D 08 AD 3E")));
  EXPECT_TRUE(bench.was_written(hex_text("AA 81 00 32 01 90 B4")));
  EXPECT_EQ(bench.writes.back().text, hex_text("AA 41 01 1E 05 00 00 00 0F 40"));
  EXPECT_EQ(device.settings[95], word32(1));
  EXPECT_EQ(bench.driver->info().product.view(), "LW20");
  EXPECT_DOUBLE_EQ(bench.driver->info().rate_hz, 388.0);
  EXPECT_TRUE(bench.driver->problem().empty());
  bench.run(1000);
  ASSERT_GT(bench.samples.size(), 250u);
  for (const RangeSample& sample : bench.samples) {
    EXPECT_EQ(sample.echo, Echo::Return);
    EXPECT_DOUBLE_EQ(sample.range_m, 12.34);
    EXPECT_DOUBLE_EQ(sample.strength, 57.0);
  }
}

TEST(LwnxDriver, FindsTheLineRate) {
  RangeBench bench;
  bench.device_baud = 460800;
  LightWare device;
  connect(bench, device, config_at(388.0));
  ASSERT_TRUE(bench.run_until_ready(8000)) << bench.driver->problem();
  EXPECT_EQ(bench.link.baud(), 460800u);
  EXPECT_EQ(bench.counter("line_rates_tried"), 2u);
}

// USB and networks: the device hears at every rate, so silence leaves the driver at any of them.
TEST(LwnxDriver, WhereTheLineRateMeansNothingASilentDeviceIsFoundAgain) {
  for (const BaudPolicy policy : {BaudPolicy::Keep, BaudPolicy::Change}) {
    for (const int silent_s : {1, 3, 5, 9, 14, 20}) {
      RangeBench bench;
      bench.has_line_rate = false;
      LightWare device;
      device.is_dead = true;
      LwnxConfig config = config_at(388.0);  // too much for 9600, 19200 and 38400 baud
      config.baud_policy = policy;
      connect(bench, device, config);
      bench.run(1000 * silent_s);
      EXPECT_NE(bench.driver->state(), DeviceState::Ready);
      device.is_dead = false;
      EXPECT_TRUE(bench.run_until_ready(6000)) << silent_s << " s silent: " << bench.driver->problem();
    }
  }
}

TEST(LwnxDriver, ADeviceAtALineRateThatIsTooLowIsReportedUntilItIsAtAnother) {
  RangeBench bench;
  bench.device_baud = 19'200;
  LightWare device;
  connect(bench, device, config_at(388.0));
  for (int ms = 0; ms < 60'000; ++ms) {
    bench.run(1);
    if (bench.driver->state() == DeviceState::Faulted) {
      break;
    }
  }
  ASSERT_EQ(bench.driver->state(), DeviceState::Faulted);
  const std::string problem(bench.driver->problem());
  EXPECT_NE(problem.find("line rate is too low"), std::string::npos) << problem;
  for (int ms = 0; ms < 30'000; ++ms) {
    bench.run(1);
    ASSERT_EQ(bench.driver->problem(), problem) << "it is looked for at the other rates meanwhile";
  }
  bench.device_baud = 115'200;
  EXPECT_TRUE(bench.run_until_ready(30'000)) << bench.driver->problem();
}

TEST(LwnxDriver, AfterASilenceTheLineRateThatWorkedIsTriedBetweenTheOthers) {
  RangeBench bench;
  LightWare device;
  connect(bench, device, config_at(388.0));
  ASSERT_TRUE(bench.run_until_ready(3000));
  // However long it was away: never more than the tries at one other rate.
  for (const int silence_ms : {1500, 2200, 2900, 3600, 4300, 9000}) {
    SCOPED_TRACE(silence_ms);
    device.is_dead = true;
    bench.run(silence_ms);
    device.is_dead = false;
    device.streams = false;
    EXPECT_TRUE(bench.run_until_ready(1500)) << bench.driver->problem();
    bench.run(6000);
  }
  // And all the others are still found.
  bench.device_baud = 460800;
  device.streams = false;
  bench.run(1000);
  EXPECT_TRUE(bench.run_until_ready(20'000)) << bench.driver->problem();
  EXPECT_EQ(bench.link.baud(), 460800u);
}

TEST(LwnxDriver, ChangesTheLineRateForGoodWhenAsked) {
  RangeBench bench;
  LightWare device;
  LwnxConfig config = config_at(388.0);
  config.baud = 921600;
  config.baud_policy = BaudPolicy::Change;
  connect(bench, device, config);
  bench.on_request = [&](const std::string& request) {
    const std::string reply = device.answer(request);
    if (request.size() == 8 && request[3] == 14) {
      bench.device_baud = 921600;
      device.streams = false;
      device.silent_requests = 2;
    }
    return reply;
  };
  ASSERT_TRUE(bench.run_until_ready(8000)) << bench.driver->problem();
  EXPECT_EQ(bench.link.baud(), 921600u);
  EXPECT_EQ(device.settings[90], std::string(1, '\x07'));
  EXPECT_TRUE(bench.was_written(hex_text("AA C1 00 0C 34 12 80 70")));
}

TEST(LwnxDriver, TextNoiseAndBrokenPacketsBetweenReadingsDoNoHarm) {
  RangeBench bench;
  LightWare device;
  connect(bench, device, config_at(388.0));
  ASSERT_TRUE(bench.run_until_ready(3000));
  int turn = 0;
  device.reading = [&](int) {
    std::string good = packet(44, word16(1234) + word16(57));
    switch (turn++ % 40) {
      case 5:
        return std::string("ldf,0:12.3\r\n") + good;
      case 15:
        good[5] = static_cast<char>(good[5] ^ 0x10);
        return good;
      case 25:
        return good.substr(0, 4);
      case 35:
        return hex_text("AA C0 3F") + good;
      default:
        return good;
    }
  };
  bench.run(3000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
  EXPECT_GT(bench.samples.size(), 900u);
  EXPECT_GT(bench.counter("checksum_errors"), 0u);
  EXPECT_GT(bench.counter("bytes_skipped"), 0u);
  for (const RangeSample& sample : bench.samples) {
    EXPECT_DOUBLE_EQ(sample.range_m, 12.34);
  }
  for (std::size_t i = 1; i < bench.samples.size(); ++i) {
    EXPECT_GT(bench.samples[i].stamp, bench.samples[i - 1].stamp);
  }
}

TEST(LwnxDriver, SilenceRestartsTheStreamThenTheDevice) {
  RangeBench bench;
  LightWare device;
  connect(bench, device, config_at(388.0));
  ASSERT_TRUE(bench.run_until_ready(3000));
  device.streams = false;  // forgot its stream, still answers
  bench.writes.clear();
  bench.run(1000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
  EXPECT_EQ(bench.counter("stream_silences"), 1u);
  ASSERT_EQ(bench.writes.size(), 1u);
  device.is_dead = true;
  bench.run(4000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Starting);
  EXPECT_FALSE(bench.driver->problem().empty());
  device.is_dead = false;
  device.streams = false;
  device.silent_requests = 2;
  EXPECT_TRUE(bench.run_until_ready(30000)) << bench.driver->problem();
}

TEST(LwnxDriver, LinkLossIsAbsentAndOver) {
  RangeBench bench;
  LightWare device;
  connect(bench, device, config_at(388.0));
  ASSERT_TRUE(bench.run_until_ready(3000));
  bench.link.set_up(false);
  bench.run(10);
  EXPECT_EQ(bench.driver->state(), DeviceState::Absent);
  EXPECT_FALSE(bench.driver->problem().empty());
  EXPECT_EQ(bench.counter("link_losses"), 1u);
  bench.link.set_up(true);
  EXPECT_TRUE(bench.run_until_ready(3000));
}

TEST(LwnxDriver, UnknownAndUnfitProductsAreFaultedWithAReason) {
  for (const char* name : {"XY99", "SF40"}) {
    RangeBench bench;
    LightWare device;
    device.name = name;
    connect(bench, device, config_at(388.0));
    EXPECT_FALSE(bench.run_until_ready(3000));
    EXPECT_EQ(bench.driver->state(), DeviceState::Faulted) << name;
    EXPECT_FALSE(bench.driver->problem().empty());
    device.name = "LW20";  // exchanged
    EXPECT_TRUE(bench.run_until_ready(12000)) << bench.driver->problem();
  }
}

TEST(LwnxDriver, ReplyThatIsNotWhatWasWrittenIsRefused) {
  RangeBench bench;
  LightWare device;
  device.lies = true;
  connect(bench, device, config_at(388.0));
  EXPECT_FALSE(bench.run_until_ready(5000));
  EXPECT_GT(bench.counter("requests_refused"), 3u);
  EXPECT_EQ(bench.driver->problem(), "the device does not confirm its settings");
}

TEST(LwnxConfig, WrongSettingsAreNamed) {
  tests::ScriptedLink link;
  LwnxConfig config;
  config.baud = 12345;
  EXPECT_NE(make_lwnx_rangefinder(config, link).error().message.find("12345"), std::string::npos);
  config = {};
  config.rate_hz = 0.0;
  EXPECT_FALSE(make_lwnx_rangefinder(config, link));
  config = {};
  config.range.range_max_m = -1.0;
  EXPECT_FALSE(make_lwnx_rangefinder(config, link));
}

TEST(LwnxTiming, ADeviceOffItsRateIsInDoubtUntilItIsNot) {
  RangeBench bench;
  LightWare device;
  device.rate_hz = 388.0;
  connect(bench, device, config_at(388.0));
  ASSERT_TRUE(bench.run_until_ready(8000)) << bench.driver->problem();
  bench.run(3000);
  EXPECT_TRUE(bench.driver->timing_doubt().empty());
  device.rate_hz = 345.0;
  bench.run(3000);
  EXPECT_EQ(bench.driver->state(), DeviceState::Ready);
  EXPECT_EQ(bench.driver->timing_doubt().substr(0, 18), "readings come at 3");
  EXPECT_NE(bench.driver->timing_doubt().find("instead of 388 Hz"), std::string_view::npos);
  EXPECT_EQ(bench.counter("timing_doubts"), 1U);
  bench.samples.clear();
  bench.run(5000);
  EXPECT_TRUE(bench.samples.empty());
  device.rate_hz = 388.0;
  bench.run(4000);
  EXPECT_TRUE(bench.driver->timing_doubt().empty());
  EXPECT_GT(bench.samples.size(), 300U);
  EXPECT_EQ(bench.counter("timing_doubts"), 1U);
}

}  // namespace
}  // namespace slamsensor::hal
