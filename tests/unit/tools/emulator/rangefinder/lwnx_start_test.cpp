#include "tests/unit/tools/emulator/rangefinder/lwnx_bench.hpp"

namespace slamsensor::tools {
namespace {

LwnxSettings powered(LwnxModel model) {
  LwnxSettings settings = ready(model);
  settings.begin = DeviceBegin::PowerUp;
  return settings;
}

TEST(LwnxStart, Lw20SwallowsTheFirstCommandAndTheFirstPacket) {
  LwnxBench bench(powered(LwnxModel::Lw20));
  EXPECT_TRUE(bench.say(read_request(0), 290ms).empty());  // still booting: not even heard
  EXPECT_EQ(bench.device.next_event(), 300ms);
  bench.run(20ms);
  EXPECT_TRUE(bench.say(read_request(0)).empty());  // chooses the interface
  EXPECT_TRUE(bench.say(read_request(0)).empty());  // switches LWNX on
  EXPECT_EQ(bench.say(read_request(0)).size(), 22U);
}

TEST(LwnxStart, TextChoosesTheInterfaceToo) {
  LwnxBench bench(powered(LwnxModel::Sf20));
  bench.run(400ms);
  EXPECT_TRUE(bench.say(bytes_of("www\r\n")).empty());
  EXPECT_EQ(text(bench.say(bytes_of("?P\r\n"))), "p:SF20,1.0.0,11\r\n");
  EXPECT_TRUE(bench.say(read_request(0)).empty());
  EXPECT_EQ(bench.say(read_request(0)).size(), 22U);
  EXPECT_TRUE(bench.say(bytes_of("?P\r\n")).empty());  // packets only from now on
}

TEST(LwnxStart, CommModeOneNeedsNoFirstCommand) {
  LwnxSettings settings = powered(LwnxModel::Lw20);
  settings.product.find(28)->initial = 1;
  LwnxBench bench(settings);
  bench.run(400ms);
  EXPECT_TRUE(bench.say(read_request(0)).empty());
  EXPECT_FALSE(bench.say(read_request(0)).empty());
}

TEST(LwnxStart, OtherProductsAnswerAtOnce) {
  for (const LwnxModel model :
       {LwnxModel::Lw24, LwnxModel::Sf000, LwnxModel::Sf30d, LwnxModel::Sf45b, LwnxModel::Grf500}) {
    LwnxBench bench(powered(model));
    bench.run(400ms);
    EXPECT_TRUE(bench.say(bytes_of("UUU")).empty());
    const auto answer = payloads(bench.say(read_request(0)));
    ASSERT_EQ(answer.size(), 1U);
    EXPECT_EQ(answer[0].size(), 17U);
    EXPECT_EQ(text(answer[0]).substr(1, 4), lwnx_product(model).name.substr(0, 4));
  }
}

TEST(LwnxStart, BaudChangesAfterSaveAndReset) {
  LwnxBench bench(ready(LwnxModel::Lw20));
  bench.say(write_request(90, 7, 1));
  bench.say(write_request(14, token(bench), 2), 1s);  // without a save
  EXPECT_EQ(bench.device.baud(), 115200U);
  bench.say(bytes_of("www\r\n"));
  bench.say(read_request(0));
  bench.say(write_request(90, 7, 1));
  EXPECT_FALSE(bench.say(write_request(12, token(bench), 2)).empty());
  EXPECT_FALSE(bench.say(write_request(14, token(bench), 2)).empty());
  EXPECT_EQ(bench.device.baud(), 115200U);
  bench.run(1s);
  EXPECT_EQ(bench.device.baud(), 921600U);
  EXPECT_TRUE(bench.say(read_request(0)).empty());  // as after power-up
}

TEST(LwnxStart, SettingsThatAreNotSavedAreLost) {
  LwnxBench bench(ready(LwnxModel::Lw20));
  bench.say(write_request(93, 3, 1));
  bench.say(write_request(12, token(bench), 2));
  bench.say(write_request(93, 1, 1));
  bench.say(write_request(30, 5, 4));
  EXPECT_TRUE(bench.inject(FaultKind::PowerCycle, 500ms));
  EXPECT_EQ(bench.sink.clears, 1);
  bench.sink.take();
  EXPECT_TRUE(bench.run(2s).empty());
  bench.say(bytes_of("www\r\n"));
  bench.say(read_request(0));
  EXPECT_EQ(payloads(bench.say(read_request(93))), std::vector<Bytes>{from_hex("5D 03")});
  EXPECT_EQ(payloads(bench.say(read_request(30))), std::vector<Bytes>{from_hex("1E 00 00 00 00")});
}

TEST(LwnxStart, TextComesUntilTheFirstPacketWhenSet) {
  LwnxSettings settings = powered(LwnxModel::Lw20);
  settings.screen_period = 100ms;
  LwnxBench bench(settings);
  bench.run(400ms);
  bench.say(bytes_of("www\r\n"));
  const std::string shown = text(bench.run(1s));
  EXPECT_EQ(shown.substr(0, 16), "LW20 measuring\r\n");
  EXPECT_EQ(shown.size(), 160U);
  bench.say(read_request(0), 150ms);
  EXPECT_TRUE(bench.run(1s).empty());
}

TEST(LwnxStart, TextAnswersDistances) {
  LwnxSettings settings = powered(LwnxModel::Sf20);
  settings.product.unanswered_first = 0;
  settings.product.find(95)->initial = 0;
  LwnxBench bench(settings);
  bench.run(400ms);
  EXPECT_EQ(text(bench.say(bytes_of("?LDF,0\r\n"))), "ldf,0:12.34\r\n");
  EXPECT_EQ(text(bench.say(bytes_of("?LDF,1\r\n"))), "ldf,1:12.34\r\n");
  EXPECT_EQ(text(bench.say(bytes_of("?LDL,2\r\n"))), "ldl,2:12.34\r\n");
  EXPECT_EQ(text(bench.say(bytes_of("LD\r\n"))), "ld,0:12.34\r\n");
  EXPECT_EQ(text(bench.say(bytes_of("#CB,6\r\n"))), "cb:6\r\n");
  bench.scene.target.range_m = 78.32;
  EXPECT_EQ(text(bench.say(bytes_of("d"))), "78.32\r\n");
  bench.scene.target.kind = TargetKind::Nothing;
  EXPECT_EQ(text(bench.say(bytes_of("D"))), "-1.00\r\n");
  EXPECT_TRUE(bench.say(bytes_of("?XYZ\r\n")).empty());
}

TEST(LwnxStart, TextStreamsAndStops) {
  LwnxSettings settings = powered(LwnxModel::Sf20);
  settings.product.unanswered_first = 0;
  LwnxBench bench(settings);
  bench.run(400ms);
  bench.say(bytes_of("$LDF,0\r\n"), Stamp{});
  const std::string lines = text(bench.run(100ms));
  EXPECT_EQ(lines.size(), 38 * std::string("ldf,0:12.34\r\n").size());
  bench.say(bytes_of("$\r\n"), Stamp{});
  EXPECT_TRUE(bench.run(100ms).empty());
}

TEST(LwnxStart, Sf11AnswersInItsOwnStyle) {
  LwnxBench bench(powered(LwnxModel::Sf11));
  bench.run(400ms);
  bench.scene.target.range_m = 98.67;
  EXPECT_EQ(text(bench.say(bytes_of("?\r\n"))), "? SF11/C V7 Firmware: V1.0.0\r\n");
  EXPECT_EQ(text(bench.say(bytes_of("?LD\r\n"))), "?LD 98.67\r\n");
  EXPECT_EQ(text(bench.say(bytes_of("d"))), "98.67\r\n");
}

TEST(LwnxStart, OldSf30StreamsTwoBytesUntilTheFirstPacket) {
  LwnxSettings settings = powered(LwnxModel::Sf30d);
  settings.legacy = LwnxLegacyStream::Sf30Binary;
  settings.product.find(78)->initial = 0;
  set_rate(settings, 39.0);
  LwnxBench bench(settings);
  bench.run(300ms);
  EXPECT_EQ(hex(bench.run(26ms)), "89 52");  // 1234 cm
  bench.scene.target.kind = TargetKind::LostShot;
  EXPECT_EQ(hex(bench.run(26ms)), "FD 00");  // 16000
  bench.say(read_request(0));
  EXPECT_TRUE(bench.run(1s).empty());
}

}  // namespace
}  // namespace slamsensor::tools
