#include "firmware/config/load_config.hpp"

#include <gmock/gmock.h>

namespace slamsensor::firmware {
namespace {

using testing::HasSubstr;

/// The value of `key` after "key=value" was laid over the defaults; the first mistake in its place.
std::string value_after(const std::string& key, const std::string& value) {
  LoadedConfig loaded;
  const auto errors = apply_assignments(loaded, {{key, value}}, "here");
  if (!errors.empty()) {
    return errors.front().text();
  }
  EXPECT_EQ(loaded.origin(key).short_text(), "here");
  return value_text(settings()[*find_setting(key)], loaded.config).value_or("none");
}

TEST(Assignment, IsSplitAtItsFirstEqualsSign) {
  EXPECT_EQ(parse_assignment("a.b=c"), (Assignment{"a.b", "c"}));
  EXPECT_EQ(parse_assignment(" a.b = \"c=d\" "), (Assignment{"a.b", "\"c=d\""}));
  EXPECT_EQ(parse_assignment("a.b="), (Assignment{"a.b", ""}));
  EXPECT_THAT(parse_assignment("a.b").error(), HasSubstr("write KEY=VALUE"));
  EXPECT_THAT(parse_assignment(" =3").error(), HasSubstr("write KEY=VALUE"));
  EXPECT_THAT(parse_assignment("").error(), HasSubstr("write KEY=VALUE"));
}

TEST(Assignment, NeedsNeitherQuotesNorBrackets) {
  EXPECT_EQ(value_after("nmea.rate_hz", "5"), "5.0");
  EXPECT_EQ(value_after("nmea.tcp", "true"), "true");
  EXPECT_EQ(value_after("acceptance.rule", "paper"), "\"paper\"");
  EXPECT_EQ(value_after("acceptance.rule", "\"paper\""), "\"paper\"");
  EXPECT_EQ(value_after("nmea.talker", "GN"), "\"GN\"");
  EXPECT_EQ(value_after("nmea.serial_path", "/dev/ttyS1"), "\"/dev/ttyS1\"");
  EXPECT_EQ(value_after("nmea.serial_path", "'/dev/ttyS1'"), "\"/dev/ttyS1\"");
  EXPECT_EQ(value_after("nmea.serial_path", ""), "\"\"");
  EXPECT_EQ(value_after("nmea.tcp_address", "::1"), "\"::1\"");
  EXPECT_EQ(value_after("nmea.sentences", "GGA,RMC"), "[\"RMC\", \"GGA\"]");
  EXPECT_EQ(value_after("nmea.sentences", "[\"GGA\"]"), "[\"GGA\"]");
  EXPECT_EQ(value_after("ptu.rates_baud", "9600, 19200"), "[9600, 19200]");
  EXPECT_EQ(value_after("ptu.rates_baud", "[9600]"), "[9600]");
  EXPECT_EQ(value_after("point_laser.start", "GO\\r"), "\"GO\\\\r\"")
      << "without quotes it is meant as it is";
  EXPECT_EQ(value_after("point_laser.start", "\"GO\\r\""), "\"GO\\r\"");
  EXPECT_EQ(value_after("lwnx.saturated_from", "inf"), "inf");
  EXPECT_EQ(value_after("benewake_can.device_id", "0x12"), "0x12");
}

TEST(Assignment, CannotSmuggleInAnotherLine) {
  EXPECT_THAT(value_after("nmea.rate_hz", "5\n[scan]\npan_min_deg = 1"),
              HasSubstr("here: nmea.rate_hz: has a value of more than one line"));
  EXPECT_THAT(value_after("nmea]\n[scan", "5"), HasSubstr("is no key"));
  EXPECT_THAT(value_after("", "5"), HasSubstr("is no key"));
  EXPECT_THAT(value_after("nmea.rate_hz", "5 # comment"), "5.0");
  EXPECT_THAT(value_after("nmea.sentences", "RMC\"]\n"), HasSubstr("more than one line"));
  EXPECT_THAT(value_after("nmea.sentences", "RMC\"], [\""), HasSubstr("is not allowed here"));
}

TEST(Assignment, TheLaterOfTwoCounts) {
  LoadedConfig loaded;
  EXPECT_TRUE(apply_assignments(loaded, {{"nmea.rate_hz", "2"}, {"nmea.rate_hz", "3"}}, "here").empty());
  EXPECT_EQ(loaded.config.daemon.nmea_rate_hz, 3.0);
}

TEST(Assignment, ThatIsNoTomlDoesNotHideTheOthers) {
  LoadedConfig loaded;
  const auto errors = apply_assignments(
      loaded, {{"nmea.rate_hz", "= 2"}, {"fix.stale_s", "-1"}, {"scan.settle_s", "3"}}, "here");
  ASSERT_EQ(errors.size(), 2U) << error_lines(errors);
  EXPECT_THAT(errors[0].text(), HasSubstr("here: nmea.rate_hz: value = 2 is not TOML"));
  EXPECT_THAT(errors[0].text(), HasSubstr("allowed: 0.1 .. 10.0 Hz"));
  EXPECT_THAT(errors[1].text(), HasSubstr("here: fix.stale_s: value -1 is out of range"));
  EXPECT_EQ(loaded.config.scan_head.scan.settle_s, 3.0);
}

}  // namespace
}  // namespace slamsensor::firmware
