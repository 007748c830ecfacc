#include "firmware/config/list_config.hpp"
#include "firmware/config/load_config.hpp"

#include <gmock/gmock.h>

namespace slamsensor::firmware {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

LoadedConfig loaded(std::string_view text) {
  const auto result = load_config_text(text, "f.toml");
  EXPECT_TRUE(result) << error_lines(result.error());
  return result.value_or(LoadedConfig{});
}

std::string text_of(std::string_view key, const LoadedConfig& config) {
  return value_text(settings()[*find_setting(key)], config.config).value_or("none");
}

TEST(SettingKinds, TimesAreSecondsInTheFileAndStampsInTheProgram) {
  const LoadedConfig config = loaded("[ptu]\nquery_timeout_s = 0.1234\nmotion_timeout_s = 2\n");
  EXPECT_EQ(config.config.head.ptu.query_timeout, std::chrono::microseconds(123'400));
  EXPECT_EQ(config.config.head.ptu.motion_timeout, std::chrono::seconds(2));
  EXPECT_EQ(text_of("ptu.query_timeout_s", config), "0.1234");
}

TEST(SettingKinds, IdentifiersAreWrittenEitherWayAndShownInHexadecimal) {
  const LoadedConfig config = loaded("[benewake_can]\ndevice_id = 291\nhost_id = 0x1FFFFFFF\n");
  EXPECT_EQ(config.config.head.benewake_can.device_id, 0x123U);
  EXPECT_EQ(text_of("benewake_can.device_id", config), "0x123");
  EXPECT_EQ(text_of("benewake_can.host_id", config), "0x1FFFFFFF");
  EXPECT_EQ(allowed_text(settings()[*find_setting("benewake_can.host_id")]), "0x0 .. 0x1FFFFFFF");
}

TEST(SettingKinds, ListsKeepTheirOrder) {
  const LoadedConfig config = loaded("[ptu]\nrates_baud = [57600, 9600]\n");
  EXPECT_THAT(config.config.head.ptu.rates_baud, ElementsAre(57'600U, 9600U));
  EXPECT_EQ(text_of("ptu.rates_baud", config), "[57600, 9600]");
}

TEST(SettingKinds, SentencesAreSwitches) {
  const NmeaConfig config = loaded("[nmea]\nsentences = [\"ZDA\", \"THS\", \"RMC\"]\n").config.nmea;
  EXPECT_TRUE(config.sentences.rmc);
  EXPECT_TRUE(config.sentences.ths);
  EXPECT_TRUE(config.zda);
  EXPECT_FALSE(config.sentences.gga || config.sentences.gbs || config.sentences.hdt || config.sentences.gst ||
               config.sentences.pslma);
}

TEST(SettingKinds, CodesAndTextsOfAPointLaserHaveAMeaning) {
  const LoadedConfig config = loaded(
      "[point_laser]\ncodes = [\"0=fault\", \"-1=weak\", \"65535=none\"]\n"
      "texts = [\"a=b=saturated\", \"DE02=none\"]\nstrength_separator = \",\"\n");
  const hal::PointLaserConfig& laser = config.config.head.point_laser;
  ASSERT_EQ(laser.codes.size(), 3U);
  EXPECT_EQ(laser.codes[0].echo, hal::Echo::Fault);
  EXPECT_EQ(laser.codes[1].number, -1);
  EXPECT_EQ(laser.codes[1].echo, hal::Echo::Weak);
  EXPECT_EQ(laser.codes[2].number, 65'535);
  ASSERT_EQ(laser.texts.size(), 2U);
  EXPECT_EQ(laser.texts[0].text, "a=b");
  EXPECT_EQ(laser.texts[0].echo, hal::Echo::Saturated);
  EXPECT_EQ(laser.strength_separator, ',');
  EXPECT_EQ(text_of("point_laser.codes", config), R"(["0=fault", "-1=weak", "65535=none"])");
  EXPECT_EQ(text_of("point_laser.texts", config), R"(["a=b=saturated", "DE02=none"])");

  for (const char* bad : {"=none", "12", "12=return", "12=", "1 2=none", "99999999999999999999=none"}) {
    EXPECT_FALSE(load_config_text("[point_laser]\ncodes = [\"" + std::string(bad) + "\"]\n", "f")) << bad;
  }
  for (const char* bad :
       {"=none", "DE02", "DE02=maybe", "\\u0007=none", "0123456789012345678901234567890123=none"}) {
    EXPECT_FALSE(load_config_text("[point_laser]\ntexts = [\"" + std::string(bad) + "\"]\n", "f")) << bad;
  }
}

TEST(SettingKinds, ControlCharactersAreEscaped) {
  EXPECT_EQ(quoted_text("a\"b\\c\r\n\t\x1B\x7F"), R"("a\"b\\c\r\n\t\u001B\u007F")");
  const LoadedConfig config = loaded("[point_laser]\nstop = \"\\u001B\\u0000\"\n");
  EXPECT_EQ(config.config.head.point_laser.stop, std::string("\x1B\0", 2));
  EXPECT_EQ(text_of("point_laser.stop", config), R"("\u001B\u0000")");
}

TEST(Rs485, IsWholeOrAbsent) {
  EXPECT_FALSE(loaded("").config.head.pan_tilt_port.rs485);
  const LoadedConfig config = loaded(
      "[pan_tilt_rs485]\nrts_while_sending = \"low\"\nrts_after_sending = \"high\"\n"
      "delay_before_send_ms = 3\ndelay_after_send_ms = 4\n");
  const auto& rs485 = config.config.head.pan_tilt_port.rs485;
  ASSERT_TRUE(rs485);
  EXPECT_EQ(rs485->rts_while_sending, hal::Rs485Level::Low);
  EXPECT_EQ(rs485->rts_after_sending, hal::Rs485Level::High);
  EXPECT_EQ(rs485->delay_before_send_ms, 3U);
  const auto refused = load_config_text("[pan_tilt_rs485]\ndelay_after_send_ms = 4\n", "f.toml");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().size(), 3U);
}

TEST(Preset, StandsBelowTheKeysOfItsSectionInWhateverOrder) {
  for (const char* text : {"[point_laser]\npreset = \"mdl_laserace_im_hr\"\nbaud = 9600\n",
                           "[point_laser]\nbaud = 9600\npreset = \"mdl_laserace_im_hr\"\n"}) {
    const hal::PointLaserConfig laser = loaded(text).config.head.point_laser;
    const hal::PointLaserConfig preset = hal::mdl_laserace_im_hr_unverified();
    EXPECT_EQ(laser.baud, 9600U);
    EXPECT_EQ(laser.product, preset.product);
    EXPECT_EQ(laser.layout, hal::PointLaserConfig::Layout::Unverified);
    EXPECT_TRUE(laser.texts.empty());
    EXPECT_EQ(laser.stop, "");
  }
}

TEST(Preset, OfALaterLayerKeepsTheKeysOfEarlierOnes) {
  LoadedConfig config;
  EXPECT_TRUE(apply_layer(config, "[point_laser]\nrate_hz = 500\n", "base.toml").empty());
  EXPECT_EQ(config.config.head.point_laser.product, "ASTECH LDS70A");
  EXPECT_TRUE(apply_layer(config, "[point_laser]\npreset = \"custom\"\n", "drop-in.toml").empty());
  EXPECT_EQ(config.config.head.point_laser.rate_hz, 500.0);
  EXPECT_EQ(config.config.head.point_laser.product, "point laser");
  EXPECT_EQ(config.config.head.point_laser.width, 0U);
  const std::string list = list_config(config);
  EXPECT_THAT(list, testing::ContainsRegex("point_laser.rate_hz +  *= 500.0 Hz +base.toml:2\n"));
  EXPECT_THAT(list,
              testing::ContainsRegex("point_laser.width +  *= 0 +drop-in.toml:2 .point_laser.preset.\n"));
  EXPECT_THAT(list, testing::ContainsRegex("point_laser.baud +  *= 115200 baud +default\n"));
}

TEST(Drivers, WhatTheyWouldRefuseIsRefusedBefore) {
  const auto refused = load_config_text("[benewake]\nrate_hz = 150\n", "f.toml");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error()[0].text(),
              HasSubstr("f.toml:2:11: benewake.rate_hz: Benewake TF03: rate_hz 150"));
  EXPECT_EQ(refused.error().size(), 1U) << "once, though two drivers refuse it:\n"
                                        << error_lines(refused.error());
}

}  // namespace
}  // namespace slamsensor::firmware
