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
  EXPECT_TRUE(bench.say(read_request(0)).empty());
  EXPECT_EQ(bench.say(read_request(0)).size(), 22U);
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

}  // namespace
}  // namespace slamsensor::tools
