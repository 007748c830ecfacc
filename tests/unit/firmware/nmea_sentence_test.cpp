#include "firmware/output/nmea_sentence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace slamsensor::firmware {
namespace {

using std::chrono::hours;
using std::chrono::nanoseconds;
using std::chrono::sys_days;
using namespace std::chrono_literals;

constexpr std::string_view kVerified[] = {
    "$GPGGA,101530.20,4727.123456,N,00834.654321,E,1,08,0.9,412.35,M,47.20,M,,*60",
    "$GPRMC,101530.20,A,4727.123456,N,00834.654321,E,0.01,,140725,,,A*49",
    "$GPVTG,,T,,M,0.01,N,0.02,K,A*20",
    "$GPGST,101530.20,0.050,0.060,0.040,35.0,0.055,0.045,0.110*63",
    "$GPHDT,123.45,T*04",
    "$GPZDA,101530.20,14,07,2025,00,00*65",
    "$GPTXT,01,01,02,SLAM sensor 0.1*67",
    "$GPRMC,101530.20,V,,,,,,,140725,,,N*7C",
    "$GPGGA,,,,,,0,,,,,,,,*66",
    "$PSLMA,POSE,101530.20,0.012,-0.034,123.45*7A",
    "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47",
    "$HEHDT,341.8,T*21",
    "$PUBX,00*33",
};

std::string field(double value, int decimals) {
  NmeaSentence sentence("X");
  const std::string line(sentence.fixed(value, decimals).finish());
  return line.substr(3, line.find('*') - 3);
}

std::string wrapped(double value_deg, int period_deg, int decimals) {
  NmeaSentence sentence("X");
  const std::string line(sentence.wrapped(value_deg, period_deg, decimals).finish());
  return line.substr(3, line.find('*') - 3);
}

TEST(NmeaSentence, ChecksumsAreThoseOfVerifiedExamples) {
  for (const std::string_view line : kVerified) {
    const std::size_t star = line.find('*');
    const unsigned long expected = std::stoul(std::string(line.substr(star + 1)), nullptr, 16);
    EXPECT_EQ(nmea_checksum(line.substr(1, star - 1)), expected) << line;
  }
}

TEST(NmeaSentence, FieldsComeInOrderWithChecksumAndLineEnd) {
  NmeaSentence sentence("GPZDA");
  sentence.text("101530.20").integer(14, 2).integer(7, 2).integer(2025, 4).text("00").text("00");
  EXPECT_EQ(sentence.finish(), "$GPZDA,101530.20,14,07,2025,00,00*65\r\n");
  EXPECT_EQ(NmeaSentence("GPGGA").blank(5).integer(0).blank(8).finish(), "$GPGGA,,,,,,0,,,,,,,,*66\r\n");
}

TEST(NmeaSentence, IsRefusedBeyond82Characters) {
  EXPECT_EQ(NmeaSentence("GPTXT").text(std::string(70, 'x')).finish().size(), kNmeaSentenceMax);
  EXPECT_EQ(NmeaSentence("GPTXT").text(std::string(71, 'x')).finish(), "");
  EXPECT_EQ(NmeaSentence("GPTXT").text(std::string(1000, 'x')).finish(), "");
}

TEST(NmeaSentence, FixedPointRoundsAndCarries) {
  EXPECT_EQ(field(0.0, 2), "0.00");
  EXPECT_EQ(field(-0.001, 2), "0.00");
  EXPECT_EQ(field(-0.006, 2), "-0.01");
  EXPECT_EQ(field(9.995001, 2), "10.00");
  EXPECT_EQ(field(0.999, 0), "1");
  EXPECT_EQ(field(-12345.6789, 3), "-12345.679");
  EXPECT_EQ(field(1e9, 9), "1000000000.000000000");
  EXPECT_EQ(field(1.1e9, 3), "");
  EXPECT_EQ(field(std::nan(""), 3), "");
  EXPECT_EQ(field(-std::numeric_limits<double>::infinity(), 3), "");
}

TEST(NmeaSentence, AnglesWrapAfterRounding) {
  EXPECT_EQ(wrapped(359.994, 360, 2), "359.99");
  EXPECT_EQ(wrapped(359.996, 360, 2), "0.00");
  EXPECT_EQ(wrapped(360.0, 360, 2), "0.00");
  EXPECT_EQ(wrapped(-0.001, 360, 2), "0.00");
  EXPECT_EQ(wrapped(-90.0, 360, 2), "270.00");
  EXPECT_EQ(wrapped(725.5, 360, 1), "5.5");
  EXPECT_EQ(wrapped(179.96, 180, 1), "0.0");
  EXPECT_EQ(wrapped(std::nextafter(359.995, 0.0), 360, 2).find("360"), std::string::npos);
  EXPECT_EQ(wrapped(std::nan(""), 360, 2), "");
}

TEST(NmeaSentence, LatitudeAndLongitudeCarryAtSixtyMinutes) {
  const auto text = [](double deg, int digits, int decimals) {
    const NmeaAngle angle = nmea_angle(deg, digits, decimals);
    return std::string(angle.negative ? "-" : "+") + std::string(angle.field.text());
  };
  EXPECT_EQ(text(47.4520576, 2, 6), "+4727.123456");
  EXPECT_EQ(text(8.57757202, 3, 7), "+00834.6543212");
  EXPECT_EQ(text(46.9999999999, 2, 7), "+4700.0000000");
  EXPECT_EQ(text(46.99999999, 2, 7), "+4659.9999994");
  EXPECT_EQ(text(-0.5, 2, 7), "-0030.0000000");
  EXPECT_EQ(text(-1e-12, 2, 7), "+0000.0000000");
  EXPECT_EQ(text(90.0, 2, 7), "+9000.0000000");
  EXPECT_EQ(text(-180.0, 3, 7), "-18000.0000000");
  EXPECT_EQ(text(179.9999999999, 3, 7), "+18000.0000000");
  EXPECT_EQ(text(std::nan(""), 3, 7), "+");
}

struct Instant {
  nanoseconds utc;
  const char* time;
  const char* date;
  std::int32_t year;
};

TEST(NmeaSentence, TimeRollsOverWithItsDate) {
  const nanoseconds day = sys_days(2025y / 7 / 14).time_since_epoch();
  const nanoseconds new_year = sys_days(2026y / 1 / 1).time_since_epoch();
  const nanoseconds leap_day = sys_days(2024y / 2 / 29).time_since_epoch();
  const nanoseconds nye99 = sys_days(2100y / 1 / 1).time_since_epoch();
  const Instant instants[] = {
      {day + 10h + 15min + 30s + 200ms, "101530.20", "140725", 2025},
      {day + 23h + 59min + 59s + 994'999'999ns, "235959.99", "140725", 2025},
      {day + 23h + 59min + 59s + 995ms, "000000.00", "150725", 2025},
      {day + 59min + 59s + 996ms, "010000.00", "140725", 2025},
      {new_year - 1ns, "000000.00", "010126", 2026},
      {leap_day - 1ms, "000000.00", "290224", 2024},
      {leap_day + 24h - 1ms, "000000.00", "010324", 2024},
      {nye99 - 1s, "235959.00", "311299", 2099},
      {nye99, "000000.00", "010100", 2100},
      {0ns, "000000.00", "010170", 1970},
      {-1s, "235959.00", "311269", 1969},
      {-1ns, "000000.00", "010170", 1970},
  };
  for (const Instant& instant : instants) {
    const NmeaTime time = nmea_time(instant.utc);
    EXPECT_EQ(time.time.text(), instant.time) << instant.utc.count();
    EXPECT_EQ(time.date.text(), instant.date) << instant.utc.count();
    EXPECT_EQ(time.year, instant.year) << instant.utc.count();
  }
}

}  // namespace
}  // namespace slamsensor::firmware
