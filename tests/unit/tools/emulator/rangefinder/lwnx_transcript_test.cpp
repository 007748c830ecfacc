#include "tests/unit/tools/emulator/rangefinder/lwnx_bench.hpp"

namespace slamsensor::tools {
namespace {

const std::string kName = "AA 40 00 00 70 9F";
const std::string kNameIsLw20 = "AA 40 04 00 4C 57 32 30 00 00 00 00 00 00 00 00 00 00 00 00 1C CC";

TEST(LwnxTranscript, CrcHasItsCheckValue) {
  EXPECT_EQ(crc16_xmodem(bytes_of("123456789")), 0x31C3);
}

TEST(LwnxTranscript, Lw20AnswersAsItsManual) {
  LwnxBench bench(ready(LwnxModel::Lw20));
  play(bench,
       {{"read product name", kName, kNameIsLw20},
        {"save with the token 1234", "AA C1 00 0C 34 12 80 70", "AA 41 00 0C CC 69"},
        {"stream raw", "AA 41 01 1E 01 00 00 00 FE 8A", "AA 41 01 1E 01 00 00 00 FE 8A"},
        {"stream off", "AA 41 01 1E 00 00 00 00 4A FC", "AA 41 01 1E 00 00 00 00 4A FC"},
        {"distance output: all", "AA 41 01 1B FF 00 00 00 BE 94", "AA 41 01 1B FF 00 00 00 BE 94"},
        {"distance output: raw, strength", "AA 41 01 1B 11 00 00 00 0E B2", "AA 41 01 1B 11 00 00 00 0E B2"},
        {"measuring mode 8", "AA 81 00 5D 08 AD 3E", "AA 81 00 5D 08 AD 3E"},
        {"high speed on", "AA 81 00 46 01 0D 70", "AA 81 00 46 01 0D 70"},
        {"921600 baud", "AA 81 00 5A 07 D5 56", "AA 81 00 5A 07 D5 56"},
        {"laser on", "AA 81 00 32 01 90 B4", "AA 81 00 32 01 90 B4"}});
  EXPECT_EQ(bench.device.refused(), 0U);
  EXPECT_EQ(bench.device.baud(), 115200U);  // until the next start
}

TEST(LwnxTranscript, TokenIsReadAndServesOnce) {
  LwnxBench bench(ready(LwnxModel::Lw20));
  const auto answer = payloads(bench.say("AA 40 00 0A 3A 3E"));
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(hex(answer[0]), "0A 34 12");
  EXPECT_FALSE(bench.say("AA C1 00 0C 34 12 80 70").empty());
  EXPECT_TRUE(bench.say("AA C1 00 0C 34 12 80 70").empty());
  EXPECT_EQ(bench.device.refused(), 1U);
  EXPECT_FALSE(bench.say(write_request(12, token(bench), 2)).empty());
}

TEST(LwnxTranscript, DistancesComeAsInTheManual) {
  LwnxBench bench(ready(LwnxModel::Lw20));
  bench.scene.target.reflectance = 57.2 * 12.34 * 12.34 / 1.5e5;
  play(bench, {{"read distance, strength 57", "AA 40 00 2C 9E 7A", "AA 40 01 2C D2 04 39 00 E0 2A"}});
  bench.scene.target.reflectance = 80.2 * 12.34 * 12.34 / 1.5e5;
  play(bench, {{"read distance, strength 80", "AA 40 00 2C 9E 7A", "AA 40 01 2C D2 04 50 00 52 9B"}});
  EXPECT_EQ(bench.scene.reports.size(), 2U);
}

TEST(LwnxTranscript, RawPacketComesAsInTheManual) {
  LwnxSettings settings = ready(LwnxModel::Lw20);
  settings.raw_readings = 3;
  settings.product.find(95)->initial = 0;
  set_rate(settings, 20'000.0);
  LwnxBench bench(settings);
  bench.scene.of = [&bench](Stamp) -> Target {
    const std::size_t shot = bench.scene.shots.size();
    return shot == 3 ? Target{} : Target{TargetKind::Target, 12.33 + 0.01 * static_cast<double>(shot), 0.5};
  };
  EXPECT_EQ(hex(bench.say("AA 41 01 1E 01 00 00 00 FE 8A", 150us)),
            "AA 41 01 1E 01 00 00 00 FE 8A AA 00 02 28 03 D2 04 D3 04 FF FF 58 0E");
}

TEST(LwnxTranscript, OtherProductsTakeTheirUpdateRates) {
  LwnxBench sf45(ready(LwnxModel::Sf45b));
  play(sf45, {{"SF45: update rate 12", "AA 81 00 42 0C 64 6D", "AA 81 00 42 0C 64 6D"}});
  LwnxBench grf(ready(LwnxModel::Grf500));
  play(grf, {{"GRF-500: 5 Hz", "AA 41 01 4A 32 00 00 00 FF A1", "AA 41 01 4A 32 00 00 00 FF A1"}});
}

TEST(LwnxTranscript, StreamFiveSendsDistancesAtTheMeasuringRate) {
  LwnxBench bench(ready(LwnxModel::Lw20));
  EXPECT_EQ(hex(bench.say("AA 41 01 1E 05 00 00 00 0F 40", 2ms)), "AA 41 01 1E 05 00 00 00 0F 40");
  const auto packets = payloads(bench.run(1s));
  EXPECT_EQ(packets.size(), 388U);
  for (const Bytes& packet : packets) {
    ASSERT_EQ(packet.size(), 5U);
    EXPECT_EQ(packet[0], 44);
    EXPECT_EQ(word(packet, 1), 1234);
  }
}

TEST(LwnxTranscript, WrongCrcLengthAndIdAreNotAnswered) {
  LwnxBench bench(ready(LwnxModel::Lw20));
  EXPECT_TRUE(bench.say("AA 40 00 00 70 9E").empty());                   // CRC
  EXPECT_TRUE(bench.say(request(0, RequestAccess::Read, {1})).empty());  // a read has no data
  EXPECT_TRUE(bench.say(write_request(27, 1, 2)).empty());               // four bytes
  EXPECT_TRUE(bench.say(write_request(93, 8, 4)).empty());               // one byte
  EXPECT_TRUE(bench.say(write_request(0, 1, 1)).empty());                // read only
  EXPECT_TRUE(bench.say(read_request(12)).empty());                      // write only
  EXPECT_TRUE(bench.say(read_request(200)).empty());
  EXPECT_EQ(bench.device.refused(), 7U);
  EXPECT_EQ(hex(bench.say("55 AA 55 00 " + kName)), kNameIsLw20);  // a false start before it
}

TEST(LwnxTranscript, ImpossibleValuesAreAnsweredWithWhatIsKept) {
  LwnxBench bench(ready(LwnxModel::Lw20));
  EXPECT_EQ(hex(bench.say(write_request(93, 9, 1))), "AA 81 00 5D 08 AD 3E");
  EXPECT_EQ(payloads(bench.say(write_request(30, 77, 4))), std::vector<Bytes>{from_hex("1E 00 00 00 00")});
  EXPECT_EQ(payloads(bench.say(write_request(90, 8, 1))), std::vector<Bytes>{from_hex("5A 04")});
}

TEST(LwnxTranscript, TheUpdateRateMayTakeTwoBytes) {
  LwnxSettings settings = ready(LwnxModel::Lw24);  // two in its guide, one in those of its relatives
  settings.product.find(66)->read_bytes = 2;
  settings.product.find(66)->write_bytes = 2;
  LwnxBench bench(settings);
  EXPECT_TRUE(bench.say(write_request(66, 3, 1)).empty());
  EXPECT_FALSE(bench.say(write_request(66, 3, 2)).empty());
}

}  // namespace
}  // namespace slamsensor::tools
