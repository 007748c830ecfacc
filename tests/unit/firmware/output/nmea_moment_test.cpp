#include "firmware/output/nmea.hpp"
#include "tests/unit/firmware/output/nmea_lines.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;
using namespace tests;
using testing::ElementsAre;

class NmeaMoments : public testing::Test {
 protected:
  GeoReference geo_{kDatum};
  NmeaContext context_{.geo = &geo_};
};

TEST_F(NmeaMoments, AnEpochBetweenScansHasItsOwnTimeAndReportsTheAgeOfTheScan) {
  context_.zda = true;
  context_.moment = NmeaMoment{.utc = good_fix().time.middle_utc + 83s + 800ms, .age = 83s + 800ms};
  const std::vector<std::string> sentences = lines(good_fix(), context_);
  ASSERT_EQ(sentences.size(), 7U);
  for (const std::size_t i : {0U, 1U, 2U, 4U, 5U}) {
    EXPECT_EQ(fields(sentences[i])[1], "101654.00") << sentences[i];
  }
  EXPECT_EQ(fields(sentences[6])[2], "101654.00");
  EXPECT_EQ(fields(sentences[6])[14], "83.8");
}

TEST_F(NmeaMoments, AnAgeIsNeverNegativeAndEmptyBeforeTheFirstScan) {
  context_.moment = NmeaMoment{.utc = 1s, .age = -10ms};
  EXPECT_EQ(fields(lines(good_fix(), context_).back())[14], "0.00");
  context_.moment->age.reset();
  const std::vector<std::string> last = fields(lines(good_fix(), context_).back());
  ASSERT_EQ(last.size(), 17U);
  EXPECT_EQ(last[14], "");
}

TEST_F(NmeaMoments, TheAgeGivesUpItsDecimalsBeforeThePoseDoes) {
  core::Fix fix = good_fix();
  fix.pose_W = {-1234.567, -2345.678, 1.0};
  fix.error_xi = 123;
  context_.moment = NmeaMoment{.utc = 1s, .age = 512s + 340ms};
  const std::vector<std::string> last = fields(lines(fix, context_).back());
  EXPECT_EQ(last[6], "-1234.57");
  EXPECT_EQ(last[14], "512");
  fix.pose_W = {-23.456, -45.678, 2.0};
  fix.error_xi = 3;
  const std::vector<std::string> usual = fields(lines(fix, context_).back());
  EXPECT_EQ(usual[6], "-23.456");
  EXPECT_EQ(usual[8], "114.59");
  EXPECT_EQ(usual[14], "512");
  fix.pose_W = {3.5, 5.5, 1.0};
  const std::vector<std::string> near = fields(lines(fix, context_).back());
  EXPECT_EQ(near[14], "512.3");
  EXPECT_EQ(near[16], "0.40");
}

TEST_F(NmeaMoments, SentencesAreSettings) {
  NmeaConfig config{.zda = true};
  config.sentences = {.rmc = false, .gga = true, .gbs = false, .hdt = false, .ths = true, .gst = false};
  config.sentences.pslma = false;
  EXPECT_THAT(lines(good_fix(), nmea_context(config, &geo_, NmeaMode::Live)),
              ElementsAre("$GPGGA,101530.20,4727.1234560,N,00834.6543212,E,1,08,0.24,412.35,M,0.0,M,,*5C",
                          "$GPTHS,123.45,A*06", "$GPZDA,101530.20,14,07,2025,00,00*65"));
  EXPECT_EQ(fields(lines(good_fix(), nmea_context(config, &geo_, NmeaMode::Simulated))[1])[2], "S");
}

TEST_F(NmeaMoments, AHomeMapThatTookThePlaceOfAnotherHasNoPlaceOnTheEarth) {
  core::Fix fix = good_fix();
  EXPECT_EQ(fields(lines(fix, context_)[0])[2], "A");
  fix.is_home_replaced = true;
  for (const std::string& line : lines(fix, context_)) {
    EXPECT_EQ(line.find("HDT"), std::string::npos) << line;
    EXPECT_EQ(line.find("4727."), std::string::npos) << line;
    EXPECT_TRUE(line.find("PSLMA") == std::string::npos || fields(line)[3] == "A") << line;
  }
  EXPECT_EQ(fields(lines(fix, context_)[0])[2], "V");
}

TEST_F(NmeaMoments, AHeadingWithAModeSaysVWithoutAFix) {
  context_.sentences = {.rmc = false, .gga = false, .gbs = false, .hdt = true, .ths = true, .gst = false};
  context_.sentences.pslma = false;
  core::Fix fix = good_fix();
  fix.status = core::FixStatus::NoFix;
  EXPECT_THAT(lines(fix, context_), ElementsAre("$GPTHS,,V*0E"));
}

}  // namespace
}  // namespace slamsensor::firmware
