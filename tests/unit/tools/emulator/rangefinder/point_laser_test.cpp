#include "tests/unit/tools/emulator/rangefinder/bench.hpp"
#include "tools/emulator/rangefinder/emulated_point_laser.hpp"

#include <utility>

namespace slamsensor::tools {
namespace {

using PointBench = Bench<EmulatedPointLaser, PointSettings>;

PointSettings ready(PointSettings settings) {
  settings.begin = DeviceBegin::Ready;
  return settings;
}

/// Stops the readings and forgets what came.
void quieten(PointBench& bench) {
  bench.say("1B", Stamp{});
  bench.run(10ms);
}

std::string ask(PointBench& bench, const std::string& command) {
  return text(bench.say(bytes_of(command + "\r")));
}

TEST(Lds70a, TracksAtOneKilohertzAtItsFactoryBaud) {
  PointBench bench(ready(lds70a_settings()));
  const std::string lines = text(bench.run(1s));
  EXPECT_EQ(lines.size(), 11'000U);
  EXPECT_EQ(lines.substr(0, 11), "D0012.340\r\n");
  EXPECT_EQ(bench.scene.shots.size(), 1000U);
  EXPECT_EQ(bench.scene.shots[9], 10ms);
  EXPECT_EQ(bench.scene.reports[9].on_wire, 10ms);
  EXPECT_EQ(bench.device.records_dropped(), 0U);
}

TEST(Lds70a, RecordsHaveTheWidthsOfTheManual) {
  PointBench bench(ready(lds70a_settings()));
  bench.scene.target.reflectance = 985.2 * 12.34 * 12.34 / 4e5;
  const std::array<std::pair<std::string, std::string>, 2> text_records = {
      {{"SD 0 0", "D0012.340\r\n"}, {"SD 0 1", "D0012.340 0985\r\n"}}};
  for (std::size_t i = 0; i < text_records.size(); ++i) {
    quieten(bench);
    EXPECT_EQ(ask(bench, text_records[i].first), text_records[i].first + "\r\n");
    EXPECT_EQ(text(bench.say(bytes_of("DT\r"), 2ms)).substr(0, text_records[i].second.size()),
              text_records[i].second);
    EXPECT_EQ(text_records[i].second.size(), (std::array<std::size_t, 2>{11, 16}[i]));
  }
}

TEST(Lds70a, EveryTextRateFitsItsLine) {
  for (const std::uint32_t baud : {9600U, 19'200U, 115'200U, 230'400U, 460'800U, 921'600U, 2'000'000U}) {
    for (const PointExtras extras : {PointExtras::None, PointExtras::Quality}) {
      PointSettings settings = ready(lds70a_settings());
      settings.baud = baud;
      settings.rate_hz = 40'000.0;
      settings.format.extras = extras;
      PointBench bench(settings);
      bench.run(1s);
      const double carried = baud / (10.0 * static_cast<double>(point_record_bytes(settings.format)));
      EXPECT_NEAR(static_cast<double>(bench.scene.shots.size()), carried, 1.0);
      EXPECT_EQ(bench.device.records_dropped(), 0U) << baud;
    }
  }
}

TEST(Lds70a, UnknownCommandsAreAnsweredWithAQuestionMark) {
  PointBench bench(ready(lds70a_settings()));
  quieten(bench);
  for (const char* unknown : {"XX", "SD", "SD 7 0", "SD 0 9"}) {
    EXPECT_EQ(ask(bench, unknown), "?\r\n") << unknown;
  }
}

TEST(Lds70a, EscapeOrCommandStopsIt) {
  for (const std::string stop : {"\x1B", "SD 0 0\r"}) {
    PointBench bench(ready(lds70a_settings()));
    bench.run(5ms);
    bench.say(bytes_of(stop), Stamp{});
    bench.run(3ms);  // what was on its way
    EXPECT_TRUE(bench.run(10ms).empty());
  }
}

TEST(Lds70a, BinaryReportsErrorsAsZero) {
  PointSettings settings = ready(lds70a_settings());
  settings.format.coding = PointCoding::SevenBit;
  PointBench bench(settings);
  EXPECT_EQ(hex(bench.run(1ms)), "E0 34");  // 12340 mm
  bench.scene.target.kind = TargetKind::LostShot;
  EXPECT_EQ(hex(bench.run(1ms)), "80 00");
  bench.scene.target.kind = TargetKind::Target;
  bench.scene.target.range_m = 16.384;  // 14 bits of millimetres end before
  EXPECT_EQ(hex(bench.run(1ms)), "80 00");
  settings.format.units_per_m = 50.0;
  PointBench coarse(settings);
  coarse.scene.target.range_m = 16.384;
  EXPECT_EQ(hex(coarse.run(1ms)), "86 33");  // 819 units of 2 cm
}

TEST(Lds70a, FaultsDoWhatTheySay) {
  PointBench bench(ready(lds70a_settings()));
  const auto one = [&bench] { return text(bench.run(1ms)); };
  EXPECT_TRUE(bench.inject(FaultKind::NoReturns, 1500us));
  EXPECT_EQ(one(), "DE02\r\n");
  EXPECT_EQ(one(), "D0012.340\r\n");
  EXPECT_TRUE(bench.inject(FaultKind::WeakSignal, 1500us));
  EXPECT_EQ(one(), "DE02\r\n");
  bench.run(1ms);
  EXPECT_TRUE(bench.inject(FaultKind::Saturation, 1500us));
  EXPECT_EQ(one(), "DE02\r\n");
  bench.run(1ms);
  EXPECT_TRUE(bench.inject(FaultKind::DeviceError, 1500us));
  EXPECT_EQ(one(), "DE04\r\n");
  bench.run(1ms);
  EXPECT_TRUE(bench.inject(FaultKind::TextMessage));
  EXPECT_EQ(one(), "LDS70A 1.02 EMU-000001\r\nD0012.340\r\n");
  EXPECT_TRUE(bench.inject(FaultKind::Silence, 5500us));
  EXPECT_TRUE(bench.run(5ms).empty());
  EXPECT_FALSE(bench.run(1ms).empty());
  EXPECT_TRUE(bench.inject(FaultKind::StreamStops));
  EXPECT_TRUE(bench.run(1s).empty());
  EXPECT_TRUE(bench.inject(FaultKind::PowerCycle, 100ms));
  EXPECT_TRUE(bench.run(400ms).empty());
  EXPECT_FALSE(bench.run(1ms).empty());  // autostart
  EXPECT_FALSE(bench.inject(FaultKind::BadChecksum));
}

TEST(Lds70a, WeakAndBlindedAreReportedByQuality) {
  PointSettings settings = ready(lds70a_settings());
  settings.format.extras = PointExtras::Quality;
  settings.rate_hz = 500.0;
  PointBench bench(settings);
  bench.inject(FaultKind::WeakSignal, 2500us);
  EXPECT_EQ(text(bench.run(2ms)), "D0012.340 0005\r\n");
  bench.run(2ms);
  bench.inject(FaultKind::Saturation, 2500us);
  EXPECT_EQ(text(bench.run(2ms)), "D0012.340 2000\r\n");
}

TEST(Lds70a, BaudResetIsKept) {
  PointSettings settings = ready(lds70a_settings());
  settings.baud = 921'600;
  PointBench bench(settings);
  EXPECT_TRUE(bench.inject(FaultKind::BaudReset));
  EXPECT_EQ(bench.device.baud(), 115'200U);
  EXPECT_TRUE(bench.inject(FaultKind::PowerCycle));
  bench.run(1s);
  EXPECT_EQ(bench.device.baud(), 115'200U);
}

TEST(LaserAceIm, StreamsDecimalLinesAndHearsNothing) {
  PointBench bench(ready(laserace_im_settings()));
  EXPECT_EQ(text(bench.run(1ms)), "012.3\r\n");
  bench.say("1B");
  bench.say(bytes_of("ID\r"));
  EXPECT_FALSE(bench.inject(FaultKind::StreamStops));
  EXPECT_EQ(bench.run(1s).size(), 7000U);
  bench.scene.target.kind = TargetKind::Nothing;
  EXPECT_EQ(text(bench.run(1ms)), "000.0\r\n");
  bench.scene.target = {TargetKind::Target, 299.95, 0.3};
  EXPECT_EQ(text(bench.run(1ms)), "299.9\r\n");
}

TEST(LaserAceIm, LineThatIsTooSlowDropsWholeRecords) {
  PointSettings settings = ready(laserace_im_settings());
  settings.baud = 9600;
  PointBench bench(settings);
  bench.run(1s);
  EXPECT_NEAR(static_cast<double>(bench.device.records_sent()), 9600.0 / 70.0, 10.0);
  EXPECT_EQ(bench.device.records_sent() + bench.device.records_dropped(), 1000U);
  EXPECT_EQ(bench.scene.reports.size(), bench.device.records_sent());
}

}  // namespace
}  // namespace slamsensor::tools
