#include "tests/unit/tools/emulator/rangefinder/bench.hpp"
#include "tools/emulator/rangefinder/emulated_tf03.hpp"

namespace slamsensor::tools {
namespace {

using Tf03Bench = Bench<EmulatedTf03, Tf03Settings>;

Tf03Settings ready(BenewakeModel model = BenewakeModel::Tf03) {
  Tf03Settings settings = tf03_settings(model);
  settings.begin = DeviceBegin::Ready;
  return settings;
}

Tf03Settings quiet() {
  Tf03Settings settings = ready();
  settings.saved.output = Tf03Switch::Off;
  return settings;
}

/// Reflectance at which the strength is a little above `strength` at 12.34 m.
double reflectance_for(double strength) {
  return (strength + 0.3) * 12.34 * 12.34 / 1.44e6;
}

TEST(Tf03Transcript, CommandsAreAnsweredAsInTheManual) {
  Tf03Bench bench(quiet());
  play(bench, {{"version", "5A 04 01 5F", "5A 07 01 02 02 01 67"},
               {"rate 10000 Hz", "5A 06 03 10 27 9A", "5A 06 03 10 27 9A"},
               {"rate 1000 Hz", "5A 06 03 E8 03 4E", "5A 06 03 E8 03 4E"},
               {"rate 100 Hz", "5A 06 03 64 00 C7", "5A 06 03 64 00 C7"},
               {"standard format", "5A 05 05 01 65", "5A 05 05 01 65"},
               {"115200 baud", "5A 08 06 00 C2 01 00 2B", "5A 08 06 00 C2 01 00 2B"},
               {"921600 baud", "5A 08 06 00 10 0E 00 86", "5A 08 06 00 10 0E 00 86"},
               {"1000000 baud", "5A 08 06 40 42 0F 00 F9", "5A 08 06 40 42 0F 00 F9"},
               {"output off", "5A 05 07 00 66", "5A 05 07 00 66"},
               {"over range 18000", "5A 06 4F 50 46 45", "5A 05 4F 00 AE"}});
  EXPECT_EQ(hex(bench.say("5A 05 07 01 67", 1ms)), "5A 05 07 01 67");  // output on
  EXPECT_EQ(bench.device.refused(), 0U);
  EXPECT_EQ(bench.device.baud(), 115200U);
}

TEST(Tf03Transcript, FramesAreThoseOfTheManual) {
  Tf03Bench bench(ready());
  bench.scene.target.reflectance = reflectance_for(1200);
  EXPECT_EQ(hex(bench.run(10ms)), "59 59 D2 04 B0 04 00 00 3C");
  bench.scene.target.kind = TargetKind::Nothing;
  EXPECT_EQ(hex(bench.run(10ms)), "59 59 50 46 0C 00 00 00 54");
}

TEST(Tf03, OddRatesBecomeAHundred) {
  Tf03Bench bench(quiet());
  EXPECT_EQ(hex(bench.say("5A 06 03 7B 00 DE")), "5A 06 03 64 00 C7");  // 123 Hz
  EXPECT_EQ(nearest_tf03_rate(123.0), 100U);
  EXPECT_EQ(nearest_tf03_rate(960.0), 1000U);
  EXPECT_EQ(nearest_tf03_rate(7000.0), 7000U);
  EXPECT_EQ(nearest_tf03_rate(20'000.0), 10'000U);
}

TEST(Tf03, EveryRateIsKeptOnALineThatCarriesIt) {
  for (const std::uint32_t rate_hz : {1U, 9U, 10U, 70U, 100U, 900U, 1000U, 2000U, 10'000U}) {
    for (const std::uint32_t baud : {115'200U, 1'000'000U}) {
      Tf03Settings settings = ready();
      settings.saved.rate_hz = rate_hz;
      settings.saved.baud = baud;
      Tf03Bench bench(settings);
      bench.run(1s);
      EXPECT_EQ(bench.scene.shots.size(), rate_hz);
      EXPECT_EQ(bench.device.records_dropped() > 0, rate_hz * 90 > baud) << rate_hz << " Hz, " << baud;
      EXPECT_EQ(bench.device.records_sent() + bench.device.records_dropped(), rate_hz);
      EXPECT_EQ(bench.scene.reports.size(), bench.device.records_sent());
      for (const auto& sent : bench.sink.sent) {
        ASSERT_EQ(sent.bytes.size(), 9U);
      }
    }
  }
}

TEST(Tf03, StrengthIsNotReportedAboveOneKilohertz) {
  Tf03Settings settings = ready();
  settings.saved.rate_hz = 2000;
  settings.saved.baud = 1'000'000;
  Tf03Bench bench(settings);
  EXPECT_EQ(hex(bench.run(600us)), "59 59 D2 04 00 00 00 00 88");
}

TEST(Tf03, StrengthDecidesWhatIsReported) {
  Tf03Bench bench(ready());
  bench.scene.target.reflectance = reflectance_for(40);
  EXPECT_EQ(hex(bench.run(10ms)).substr(6, 11), "D2 04 28 00");
  bench.scene.target.reflectance = reflectance_for(39);
  EXPECT_EQ(hex(bench.run(10ms)).substr(6, 11), "50 46 27 00");  // over range
  bench.scene.target.reflectance = 1.0;
  EXPECT_EQ(hex(bench.run(10ms)).substr(6, 11), "D2 04 AC 0D");  // 3500 at most
}

TEST(Tf03, OverRangeValueIsSettable) {
  Tf03Bench bench(ready());
  bench.scene.target.reflectance = 0.9;
  EXPECT_EQ(hex(bench.say("5A 06 4F E8 03 9A", 5ms)), "5A 05 4F 00 AE");  // 1000 cm
  EXPECT_EQ(hex(bench.run(5ms)).substr(6, 5), "E8 03");                   // 12.34 m is beyond it
  EXPECT_TRUE(bench.say("5A 06 4F FF FF AD", 5ms).empty());
}

TEST(Tf03, UnsavedChangesAreLost) {
  Tf03Bench bench(quiet());
  bench.say("5A 06 03 E8 03 4E");
  bench.say("5A 05 07 01 67");
  bench.inject(FaultKind::PowerCycle, 100ms);
  bench.sink.take();
  EXPECT_TRUE(bench.run(2s).empty());
}

TEST(Tf03, SurvivesGarbageBeforeACommand) {
  Tf03Bench bench(quiet());
  EXPECT_EQ(hex(bench.say("00 5A FF 5A 5A 04 01 5F")), "5A 07 01 02 02 01 67");
  EXPECT_EQ(bench.device.refused(), 2U);
}

TEST(Tf03, FaultsDoWhatTheySay) {
  Tf03Bench bench(ready());
  EXPECT_TRUE(bench.inject(FaultKind::NoReturns, 15ms));
  EXPECT_EQ(hex(bench.run(10ms)).substr(6, 11), "50 46 0C 00");
  EXPECT_EQ(hex(bench.run(10ms)).substr(6, 5), "D2 04");
  EXPECT_TRUE(bench.inject(FaultKind::WeakSignal, 15ms));
  EXPECT_EQ(hex(bench.run(10ms)).substr(6, 11), "50 46 1E 00");
  bench.run(10ms);
  EXPECT_TRUE(bench.inject(FaultKind::Saturation, 15ms));
  EXPECT_EQ(hex(bench.run(10ms)).substr(6, 11), "D2 04 A0 0F");
  bench.run(10ms);
  EXPECT_TRUE(bench.inject(FaultKind::BadChecksum));
  const Bytes good = bench.run(0ms);
  const Bytes bad = bench.run(10ms);
  const Bytes next = bench.run(10ms);
  ASSERT_EQ(bad.size(), 9U);
  EXPECT_EQ(bad.back() ^ 0x5A, next.back());
  EXPECT_TRUE(bench.inject(FaultKind::Silence, 25ms));
  EXPECT_TRUE(bench.run(20ms).empty());
  EXPECT_FALSE(bench.run(10ms).empty());
  EXPECT_TRUE(bench.inject(FaultKind::TextMessage));
  EXPECT_EQ(text(bench.run(5ms)), "TF03 running\r\n");
  EXPECT_TRUE(bench.inject(FaultKind::StreamStops));
  EXPECT_TRUE(bench.run(1s).empty());
  bench.say("5A 05 07 01 67");
  EXPECT_FALSE(bench.run(10ms).empty());
}

TEST(Tf03, BaudResetIsAtOnce) {
  Tf03Settings settings = ready();
  settings.saved.baud = 921'600;
  Tf03Bench bench(settings);
  EXPECT_TRUE(bench.inject(FaultKind::BaudReset));
  EXPECT_EQ(bench.device.baud(), 115'200U);
  EXPECT_FALSE(bench.inject(FaultKind::DeviceError));
  EXPECT_FALSE(bench.inject(FaultKind::LostFrame));
}

struct RelativeCase {
  BenewakeModel model;
  std::string target;     ///< bytes 2, 3, 6, 7 of 12.34 m
  std::string nothing;    ///< bytes 2, 3
  std::string saturated;  ///< bytes 2, 3
};

class Relatives : public testing::TestWithParam<RelativeCase> {};

TEST_P(Relatives, HaveTheirOwnCodesAndBytes) {
  const RelativeCase& expected = GetParam();
  Tf03Bench bench(ready(expected.model));
  bench.scene.target.reflectance = 0.9;
  const Bytes frame = bench.run(10ms);
  ASSERT_EQ(frame.size(), 9U);
  EXPECT_EQ(hex(Bytes{frame[2], frame[3], frame[6], frame[7]}), expected.target);
  bench.scene.target.kind = TargetKind::Nothing;
  EXPECT_EQ(hex(bench.run(10ms)).substr(6, 5), expected.nothing);
  bench.scene.target.kind = TargetKind::Target;
  bench.inject(FaultKind::Saturation, 15ms);
  EXPECT_EQ(hex(bench.run(10ms)).substr(6, 5), expected.saturated);
}

INSTANTIATE_TEST_SUITE_P(
    All, Relatives,
    testing::Values(RelativeCase{BenewakeModel::TfMini, "D2 04 07 00", "FF FF", "FF FF"},
                    RelativeCase{BenewakeModel::TfMiniPlus, "D2 04 C8 08", "00 00", "00 00"},
                    RelativeCase{BenewakeModel::TfMiniS, "D2 04 C8 08", "FF FF", "FE FF"},
                    RelativeCase{BenewakeModel::Tf02, "D2 04 08 06", "98 08", "98 08"}));

TEST(Tf03, TfMiniSReportsTooMuchSun) {
  Tf03Bench bench(ready(BenewakeModel::TfMiniS));
  EXPECT_TRUE(bench.inject(FaultKind::DeviceError, 15ms));
  EXPECT_EQ(hex(bench.run(10ms)).substr(6, 5), "FC FF");
}

}  // namespace
}  // namespace slamsensor::tools
