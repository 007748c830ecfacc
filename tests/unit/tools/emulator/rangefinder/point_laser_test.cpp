#include "tests/unit/tools/emulator/rangefinder/bench.hpp"
#include "tools/emulator/rangefinder/emulated_point_laser.hpp"
#include "tools/emulator/rangefinder/point_rate.hpp"

#include <utility>

namespace slamsensor::tools {
namespace {

using PointBench = Bench<EmulatedPointLaser, PointSettings>;

PointSettings ready(PointSettings settings) {
  settings.begin = DeviceBegin::Ready;
  return settings;
}

/// An LDS70A that waits for commands.
PointSettings waiting() {
  PointSettings settings = ready(lds70a_settings());
  settings.autostart = "ID";
  return settings;
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
  PointBench bench(waiting());
  bench.run(1ms);
  bench.scene.target.reflectance = 985.2 * 12.34 * 12.34 / 4e5;
  const std::vector<std::pair<std::string, std::string>> text_records = {
      {"SD 0 0", "D0012.340\r\n"},
      {"SD 0 1", "D0012.340 0985\r\n"},
      {"SD 0 2", "D0012.340 +23.5\r\n"},
      {"SD 0 3", "D0012.340 0985 +23.5\r\n"}};
  for (std::size_t i = 0; i < text_records.size(); ++i) {
    EXPECT_EQ(ask(bench, text_records[i].first), text_records[i].first + "\r\n");
    EXPECT_EQ(ask(bench, "DM"), text_records[i].second);
    EXPECT_EQ(text_records[i].second.size(), (std::array<std::size_t, 4>{11, 16, 17, 22}[i]));
  }
  const std::vector<std::pair<std::string, std::string>> binary_records = {
      {"SD 2 0", "E0 34"}, {"SD 2 1", "E0 34 3D"}, {"SD 2 2", "E0 34 17"}, {"SD 2 3", "E0 34 3D 17"}};
  for (const auto& [command, record] : binary_records) {
    ask(bench, command);
    EXPECT_EQ(hex(bench.say(bytes_of("DM\r"))), record);  // 12340 mm
  }
}

TEST(Lds70a, MostReadingsPerSecondDependOnTheLine) {
  EXPECT_EQ(lds70a_rate_max_hz(9600, PointCoding::Decimal, 11), 80.0);
  EXPECT_EQ(lds70a_rate_max_hz(115'200, PointCoding::Decimal, 22), 480.0);
  EXPECT_EQ(lds70a_rate_max_hz(115'200, PointCoding::SevenBit, 2), 5750.0);
  EXPECT_EQ(lds70a_rate_max_hz(921'600, PointCoding::SevenBit, 2), 40'000.0);
  PointBench bench(waiting());
  EXPECT_EQ(ask(bench, "MF 40000").substr(0, 2), "LD");  // behind the autostart's answer
  ask(bench, "BR 460800");
  EXPECT_EQ(bench.device.baud(), 460'800U);
  ask(bench, "SD 2 0");
  bench.say(bytes_of("DT\r"), Stamp{});
  const std::size_t before = bench.scene.shots.size();
  EXPECT_EQ(bench.run(1s).size(), 2U * 23'040U);  // the table's 23200 is more than the line carries
  EXPECT_EQ(bench.scene.shots.size() - before, 23'040U);
  bench.say(bytes_of("SA 100\r"));
  bench.say(bytes_of("DT\r"), Stamp{});
  EXPECT_EQ(bench.run(1s).size(), 2U * 400U);  // MF / SA
}

TEST(Lds70a, EveryTextRateFitsItsLine) {
  for (const std::uint32_t baud : {9600U, 19'200U, 115'200U, 230'400U, 460'800U, 921'600U, 2'000'000U}) {
    for (const PointExtras extras :
         {PointExtras::None, PointExtras::Quality, PointExtras::Temperature, PointExtras::Both}) {
      PointSettings settings = ready(lds70a_settings());
      settings.baud = baud;
      settings.rate_hz = 40'000.0;
      settings.format.extras = extras;
      PointBench bench(settings);
      bench.run(1s);
      const double expected =
          lds70a_rate_max_hz(baud, PointCoding::Decimal, point_record_bytes(settings.format));
      EXPECT_EQ(bench.scene.shots.size(), static_cast<std::size_t>(expected));
      EXPECT_EQ(bench.device.records_dropped(), 0U) << baud;
    }
  }
}

TEST(Lds70a, CommandsAreAnswered) {
  PointBench bench(waiting());
  EXPECT_EQ(text(bench.run(1ms)), "LDS70A 1.02 EMU-000001\r\n");
  EXPECT_EQ(ask(bench, "ID"), "LDS70A 1.02 EMU-000001\r\n");
  EXPECT_EQ(ask(bench, "id?").substr(0, 12), "ID ID? DM DT");
  EXPECT_EQ(ask(bench, "TP"), "TP 23.5\r\n");
  EXPECT_EQ(ask(bench, "MW"), "MW -290.000 290.000 0\r\n");
  EXPECT_EQ(ask(bench, "MW 1 10 0"), "MW 1.000 10.000 0\r\n");
  EXPECT_EQ(ask(bench, "DM"), "DE02\r\n");  // outside
  EXPECT_EQ(ask(bench, "MW -290 290 0"), "MW -290.000 290.000 0\r\n");
  EXPECT_EQ(ask(bench, "OF-2.34"), "OF -2.340\r\n");
  EXPECT_EQ(ask(bench, "DM"), "D0010.000\r\n");
  EXPECT_EQ(ask(bench, "Q1 1 2 0.05 1"), "Q1 1 2 0.05 1\r\n");
  EXPECT_EQ(ask(bench, "UB 100"), "UB 100.000\r\n");
  EXPECT_EQ(ask(bench, "TE 1"), "TE 1\r\n");
  EXPECT_EQ(ask(bench, "DM"), "D0010.000\r");
  EXPECT_EQ(ask(bench, "AS DT"), "AS DT\r\n");
  EXPECT_EQ(ask(bench, "XX"), "?\r\n");
  EXPECT_EQ(ask(bench, "SD 7 0"), "?\r\n");
  EXPECT_NE(ask(bench, "HW").find("Measure result: 0"), std::string::npos);
  const std::string list = ask(bench, "PR");
  EXPECT_EQ(list.substr(0, 52), "measure frequency[MF]............1000(max 40000)Hz\r\n");
  EXPECT_NE(list.find("distance offset[OF]..............0.000\r\n"), std::string::npos);
}

TEST(Lds70a, EscapeOrCommandStopsIt) {
  for (const PointStop stop : {PointStop::Escape, PointStop::Command, PointStop::Either}) {
    PointSettings settings = ready(lds70a_settings());
    settings.stop = stop;
    PointBench bench(settings);
    bench.run(5ms);
    bench.say("1B", Stamp{});
    EXPECT_EQ(bench.run(10ms).empty(), stop != PointStop::Command);
    PointBench other(settings);
    other.run(5ms);
    other.say(bytes_of("ID\r"), Stamp{});
    EXPECT_EQ(other.run(10ms).empty(), stop != PointStop::Escape);
  }
}

TEST(Lds70a, ErrorModeZeroRepeatsTheLastDistance) {
  PointBench bench(waiting());
  bench.run(1ms);
  ask(bench, "DM");
  bench.scene.target.kind = TargetKind::Nothing;
  EXPECT_EQ(ask(bench, "DM"), "DE02\r\n");
  ask(bench, "SE 0");
  EXPECT_EQ(ask(bench, "DM"), "D0012.340\r\n");
  EXPECT_NE(ask(bench, "HW").find("Measure result: 6"), std::string::npos);
}

TEST(Lds70a, BinaryTellsErrorsAsZero) {
  PointBench bench(waiting());
  bench.run(1ms);
  ask(bench, "SD 2 0");
  bench.scene.target.kind = TargetKind::LostShot;
  EXPECT_EQ(hex(bench.say(bytes_of("DM\r"))), "80 00");
  bench.scene.target.kind = TargetKind::Target;
  bench.scene.target.range_m = 16.384;  // 14 bits of millimetres end before
  EXPECT_EQ(hex(bench.say(bytes_of("DM\r"))), "80 00");
  ask(bench, "UB 50");
  EXPECT_EQ(hex(bench.say(bytes_of("DM\r"))), "86 33");  // 819 units of 2 cm
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

TEST(Lds70a, WeakAndBlindedAreToldByQuality) {
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
  PointSettings settings = waiting();
  settings.baud = 921'600;
  PointBench bench(settings);
  bench.run(1ms);
  EXPECT_TRUE(bench.inject(FaultKind::BaudReset));
  EXPECT_EQ(bench.device.baud(), 115'200U);
  EXPECT_EQ(ask(bench, "BR"), "BR 115200\r\n");
}

TEST(Ldm41e, LinesAreThoseOfTheManual) {
  PointSettings settings = ready(ldm41e_settings());
  settings.autostart = "ID";
  PointBench bench(settings);
  bench.run(50ms);
  bench.scene.target = {TargetKind::Target, 4.996, 985.3 * 4.996 * 4.996 / 2e4};
  ask(bench, "SD d");
  EXPECT_EQ(ask(bench, "DM"), "004.996\r\n");
  ask(bench, "SD h");
  EXPECT_EQ(ask(bench, "DM"), " 001384\r\n");
  ask(bench, "SD s");
  EXPECT_EQ(ask(bench, "DM"), "004.996 000985\r\n");
  bench.scene.target.kind = TargetKind::Nothing;
  EXPECT_EQ(ask(bench, "DM"), "E15\r\n");
  EXPECT_EQ(ask(bench, "SD x"), "?\r\n");
  EXPECT_EQ(ask(bench, "MF 100"), "?\r\n");
  EXPECT_EQ(bench.device.baud(), 9600U);
}

TEST(Ldm41e, SeparatorOfTheSignalIsASetting) {
  PointSettings settings = ready(ldm41e_settings());
  settings.format.extras = PointExtras::Quality;
  settings.format.quality_separator = '_';
  PointBench bench(settings);
  bench.scene.target = {TargetKind::Target, 4.996, 985.3 * 4.996 * 4.996 / 2e4};
  EXPECT_EQ(text(bench.run(100ms)), "004.996_000985\r\n");
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

TEST(LaserAceIm, FormIsFree) {
  PointSettings settings = ready(laserace_im_settings());
  settings.format.coding = PointCoding::LittleEndian;
  settings.format.units_per_m = 10.0;
  settings.format.no_return_number = 0xFFFF;
  PointBench bench(settings);
  EXPECT_EQ(hex(bench.run(1ms)), "7B 00");
  bench.scene.target.kind = TargetKind::Nothing;
  EXPECT_EQ(hex(bench.run(1ms)), "FF FF");
  settings.format.coding = PointCoding::BigEndian;
  PointBench big(settings);
  EXPECT_EQ(hex(big.run(1ms)), "00 7B");
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
