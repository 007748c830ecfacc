#include "tests/unit/tools/emulator/rangefinder/lwnx_bench.hpp"

namespace slamsensor::tools {
namespace {

/// First words of the packets of ID 44 in `bytes`.
std::vector<int> first_words(const Bytes& bytes) {
  std::vector<int> words;
  for (const Bytes& payload : payloads(bytes)) {
    if (payload[0] == 44) {
      words.push_back(word(payload, 1));
    }
  }
  return words;
}

/// Readings of one shot each, of which the second and later are lost.
std::vector<int> words_with_counter(std::uint32_t counter) {
  LwnxSettings settings = ready(LwnxModel::Lw20);
  settings.product.find(95)->initial = counter;
  LwnxBench bench(settings);
  std::vector<int> words;
  for (int shot = 0; shot < 5; ++shot) {
    words.push_back(first_words(bench.say(read_request(44))).at(0));
    bench.scene.target.kind = TargetKind::LostShot;
  }
  return words;
}

TEST(LwnxLostSignal, RepeatsTheLastDistanceAsOftenAsTheCounterSays) {
  using V = std::vector<int>;
  EXPECT_EQ(words_with_counter(0), (V{1234, -1, -1, -1, -1}));
  EXPECT_EQ(words_with_counter(1), (V{1234, -1, -1, -1, -1}));
  EXPECT_EQ(words_with_counter(3), (V{1234, 1234, 1234, -1, -1}));
}

TEST(LwnxLostSignal, GrfTakesNoCounterOfZero) {
  LwnxBench bench(ready(LwnxModel::Grf500));
  EXPECT_EQ(payloads(bench.say(write_request(78, 0, 4))), std::vector<Bytes>{from_hex("4E 01 00 00 00")});
  EXPECT_EQ(payloads(bench.say(write_request(78, 4, 4))), std::vector<Bytes>{from_hex("4E 04 00 00 00")});
}

TEST(LwnxLostSignal, EveryProductHasItsNoReturnCode) {
  for (const LwnxModel model : {LwnxModel::Lw20, LwnxModel::Sf20, LwnxModel::Lw24, LwnxModel::Sf000,
                                LwnxModel::Sf11, LwnxModel::Sf30d, LwnxModel::Sf45b, LwnxModel::Grf500}) {
    LwnxSettings settings = ready(model);
    LwnxBench bench(settings);
    bench.scene.target.kind = TargetKind::Nothing;
    const bool is_grf = model == LwnxModel::Grf500;
    EXPECT_EQ(first_words(bench.say(read_request(44))), std::vector<int>{is_grf ? -10 : -1});
    settings.product.no_return = -100;
    LwnxBench other(settings);
    other.scene.target.kind = TargetKind::Nothing;
    EXPECT_EQ(first_words(other.say(read_request(44))), std::vector<int>{-100});
  }
}

TEST(LwnxLostSignal, DistanceBeyondTheWordIsNone) {
  LwnxBench bench(ready(LwnxModel::Lw20));
  bench.scene.target.range_m = 327.67;
  EXPECT_EQ(first_words(bench.say(read_request(44))), std::vector<int>{32767});
  LwnxBench farther(ready(LwnxModel::Lw20));
  farther.scene.target.range_m = 327.68;
  EXPECT_EQ(first_words(farther.say(read_request(44))), std::vector<int>{-1});
}

class LwnxFault : public testing::Test {
 protected:
  LwnxFault() : bench(settings()) { bench.say(write_request(30, 5, 4), Stamp{}); }

  static LwnxSettings settings() {
    LwnxSettings made = sf000_at_1_khz();  // raw and strength
    made.product.find(76)->initial = 0;
    return made;
  }

  LwnxBench bench;
};

TEST_F(LwnxFault, PowerCycleIsSilentAndForgets) {
  bench.run(10ms);
  EXPECT_TRUE(bench.inject(FaultKind::PowerCycle, 100ms));
  EXPECT_EQ(bench.device.next_event(), bench.now + 400ms);
  EXPECT_TRUE(bench.run(100ms).empty());
  EXPECT_TRUE(bench.say(read_request(0), 290ms).empty());
  bench.run(20ms);
  EXPECT_FALSE(bench.say(read_request(0)).empty());
  EXPECT_TRUE(bench.run(1s).empty());  // the stream is off
}

TEST_F(LwnxFault, SilenceHearsAndWorks) {
  EXPECT_TRUE(bench.inject(FaultKind::Silence, 50ms));
  bench.run(10ms);
  EXPECT_TRUE(bench.say(write_request(66, 1, 1), 30ms).empty());
  EXPECT_EQ(bench.scene.reports.size(), 0U);
  EXPECT_GT(bench.scene.shots.size(), 5U);
  bench.run(10ms);
  EXPECT_EQ(payloads(bench.run(1s)).size(), 50U);  // the rate was heard
}

TEST_F(LwnxFault, BaudResetIsAtOnceAndLasts) {
  LwnxSettings set = settings();
  set.baud = 921'600;
  LwnxBench fast(set);
  EXPECT_EQ(fast.device.baud(), 921'600U);
  EXPECT_TRUE(fast.inject(FaultKind::BaudReset));
  EXPECT_EQ(fast.device.baud(), 115'200U);
  fast.inject(FaultKind::PowerCycle, 10ms);
  fast.run(1s);
  EXPECT_EQ(fast.device.baud(), 115'200U);
}

TEST_F(LwnxFault, NoReturnsGiveTheCode) {
  bench.run(2ms);
  EXPECT_TRUE(bench.inject(FaultKind::NoReturns, 3ms));
  EXPECT_EQ(first_words(bench.run(5ms)), (std::vector<int>{-1, -1, 1234, 1234, 1234}));
}

TEST_F(LwnxFault, WeakSignalReportsLittleStrength) {
  EXPECT_TRUE(bench.inject(FaultKind::WeakSignal, 1s));
  const auto packet = payloads(bench.run(2ms)).at(1);
  EXPECT_EQ(word(packet, 1), 1234);
  EXPECT_EQ(word(packet, 3), 1);
  bench.say(write_request(27, 1, 4), Stamp{});  // no strength any more: it must be a miss
  bench.sink.take();
  EXPECT_EQ(first_words(bench.run(1ms)), std::vector<int>{-1});
}

TEST_F(LwnxFault, SaturationReportsTooMuchStrength) {
  EXPECT_TRUE(bench.inject(FaultKind::Saturation, 1s));
  EXPECT_EQ(word(payloads(bench.run(2ms)).at(1), 3), 120);
}

TEST_F(LwnxFault, BadChecksumIsInOneRecordAlone) {
  bench.run(2ms);
  EXPECT_TRUE(bench.inject(FaultKind::BadChecksum));
  const Bytes bytes = bench.run(2ms);
  ASSERT_EQ(bytes.size(), 20U);
  const std::span<const std::uint8_t> all(bytes);
  EXPECT_NE(crc16_xmodem(all.first(8)), little_endian(all.subspan(8, 2)));
  EXPECT_EQ(crc16_xmodem(all.subspan(10, 8)), little_endian(all.subspan(18, 2)));
}

TEST_F(LwnxFault, StreamStopsUntilItIsAskedFor) {
  EXPECT_TRUE(bench.inject(FaultKind::StreamStops));
  bench.run(10ms);
  EXPECT_TRUE(bench.run(1s).empty());
  EXPECT_EQ(payloads(bench.say(read_request(30))), std::vector<Bytes>{from_hex("1E 00 00 00 00")});
  bench.say(write_request(30, 5, 4));
  EXPECT_FALSE(bench.run(10ms).empty());
}

TEST_F(LwnxFault, TextComesBetweenTheRecords) {
  EXPECT_TRUE(bench.inject(FaultKind::TextMessage));
  const auto packets = payloads(bench.run(1ms));
  ASSERT_EQ(packets.size(), 2U);
  EXPECT_EQ(packets[0][0], 7);
  EXPECT_EQ(packets[0].back(), 0);
  EXPECT_EQ(packets[1][0], 44);
}

TEST_F(LwnxFault, DeviceErrorSendsTextInsteadOfReadings) {
  bench.run(1ms);
  EXPECT_TRUE(bench.inject(FaultKind::DeviceError, 900ms));
  const auto packets = payloads(bench.run(899ms));
  ASSERT_EQ(packets.size(), 2U);
  EXPECT_EQ(text(packets[0]), std::string("\x07Laser error") + '\0');
  EXPECT_EQ(first_words(bench.run(10ms)).size(), 10U);
  EXPECT_EQ(payloads(bench.run(1s)).size(), 1000U);
}

TEST_F(LwnxFault, LaserOffMeasuresNothing) {
  bench.say(write_request(50, 0, 1));
  const std::size_t shots = bench.scene.shots.size();
  EXPECT_EQ(first_words(bench.run(2ms)), (std::vector<int>{-1, -1}));
  EXPECT_EQ(bench.scene.shots.size(), shots);
}

TEST_F(LwnxFault, OthersAreUnknown) {
  for (const FaultKind kind : {FaultKind::SwallowReply, FaultKind::DropByte, FaultKind::LostFrame,
                               FaultKind::MissedSteps, FaultKind::Emergency}) {
    EXPECT_FALSE(bench.inject(kind));
  }
}

}  // namespace
}  // namespace slamsensor::tools
