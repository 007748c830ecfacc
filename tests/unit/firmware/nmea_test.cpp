#include "firmware/output/nmea.hpp"

#include "tests/unit/firmware/output/nmea_lines.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;
using namespace tests;
using testing::ElementsAre;

void expect_well_formed(const std::string& line) {
  EXPECT_LE(line.size() + 2, kNmeaSentenceMax) << line;
  ASSERT_EQ(line[0], '$');
  const std::size_t star = line.find('*');
  ASSERT_EQ(star + 3, line.size()) << line;
  EXPECT_EQ(std::stoul(line.substr(star + 1), nullptr, 16), nmea_checksum(line.substr(1, star - 1))) << line;
  for (const char c : line) {
    EXPECT_TRUE(c >= 0x20 && c < 0x7f) << line;
  }
  EXPECT_EQ(line.find("nan"), std::string::npos);
  EXPECT_EQ(line.find("inf"), std::string::npos);
}

class Nmea : public testing::Test {
 protected:
  GeoReference geo_{kDatum};
  NmeaContext context_{.geo = &geo_};
};

TEST_F(Nmea, GoldenEpochOfAFix) {
  context_.zda = true;
  EXPECT_THAT(
      lines(good_fix(), context_),
      ElementsAre("$GPRMC,101530.20,A,4727.1234560,N,00834.6543212,E,,,140725,,,A*54",
                  "$GPGGA,101530.20,4727.1234560,N,00834.6543212,E,1,08,0.24,412.35,M,0.0,M,,*5C",
                  "$GPGBS,101530.20,0.055,0.045,,,,,*6A", "$GPHDT,123.45,T*04",
                  "$GPGST,101530.20,0.300,0.055,0.045,0.0,0.055,0.045,*7E",
                  "$GPZDA,101530.20,14,07,2025,00,00*65",
                  "$PSLMA,POSE,101530.20,A,A,0,0.000,0.000,326.550,0.055,0.50,3,8,11,0.00,1,0.40*72"));
}

TEST_F(Nmea, GoldenEpochWithoutAFix) {
  core::Fix fix = good_fix();
  fix.status = core::FixStatus::NoFix;
  fix.reason = core::FixReason::NoOverlap;
  fix.matches = 0;
  fix.landmarks_seen = 7;
  EXPECT_THAT(lines(fix, context_),
              ElementsAre("$GPRMC,101530.20,V,,,,,,,140725,,,N*7C", "$GPGGA,101530.20,,,,,0,00,,,,,,,*4C",
                          "$GPGBS,101530.20,,,,,,,*6B", "$GPGST,101530.20,,,,,,,*7D",
                          "$PSLMA,POSE,101530.20,V,A,2,,,,,,,0,7,0.00,,*5C"));
}

TEST_F(Nmea, AnAmbiguousPoseIsNeverAPosition) {
  core::Fix fix = good_fix();
  fix.status = core::FixStatus::Ambiguous;
  fix.reason = core::FixReason::Symmetric;
  EXPECT_THAT(
      lines(fix, context_),
      ElementsAre("$GPRMC,101530.20,V,,,,,,,140725,,,N*7C", "$GPGGA,101530.20,,,,,0,00,,,,,,,*4C",
                  "$GPGBS,101530.20,,,,,,,*6B", "$GPGST,101530.20,,,,,,,*7D",
                  "$PSLMA,POSE,101530.20,U,A,3,0.000,0.000,326.550,0.055,0.50,3,8,11,0.00,1,0.40*65"));
}

TEST_F(Nmea, WithoutADatumOnlyTheLocalSentenceCarriesThePose) {
  context_.geo = nullptr;
  EXPECT_THAT(
      lines(good_fix(), context_),
      ElementsAre("$GPRMC,101530.20,V,,,,,,,140725,,,N*7C", "$GPGGA,101530.20,,,,,0,00,,,,,,,*4C",
                  "$GPGBS,101530.20,,,,,,,*6B", "$GPGST,101530.20,,,,,,,*7D",
                  "$PSLMA,POSE,101530.20,A,A,0,0.000,0.000,326.550,0.055,0.50,3,8,11,0.00,1,0.40*72"));
}

TEST_F(Nmea, AReplayCallsItselfSimulated) {
  context_.mode = NmeaMode::Simulated;
  context_.quality = NmeaQuality::RtkFixed;
  const std::vector<std::string> sentences = lines(good_fix(), context_);
  EXPECT_EQ(sentences[0], "$GPRMC,101530.20,A,4727.1234560,N,00834.6543212,E,,,140725,,,S*46");
  EXPECT_EQ(sentences[1], "$GPGGA,101530.20,4727.1234560,N,00834.6543212,E,8,08,0.24,412.35,M,0.0,M,,*55");
  EXPECT_EQ(fields(sentences.back())[4], "S");
}

TEST_F(Nmea, QualityAndTalkerAreSettings) {
  const NmeaConfig config{
      .talker = "GN", .quality = NmeaQuality::RtkFloat, .zda = true, .landmark_sigma_m = 0.1};
  const std::vector<std::string> sentences = lines(good_fix(), nmea_context(config, &geo_, NmeaMode::Live));
  ASSERT_EQ(sentences.size(), 7U);
  EXPECT_EQ(fields(sentences[0])[0], "$GNRMC");
  EXPECT_EQ(fields(sentences[0])[12], "F");
  EXPECT_EQ(fields(sentences[1])[6], "5");
  EXPECT_EQ(fields(sentences[1])[8], "0.71");
  EXPECT_EQ(fields(sentences[3])[0], "$GNHDT");
  EXPECT_EQ(fields(sentences[4])[2], "0.100");
}

TEST_F(Nmea, SatellitesAreTheMatchesUpTo99) {
  core::Fix fix = good_fix();
  fix.matches = 3;
  EXPECT_EQ(fields(lines(fix, context_)[1])[7], "03");
  fix.matches = 120;
  EXPECT_EQ(fields(lines(fix, context_)[1])[7], "99");
}

TEST_F(Nmea, ErrorsAreTurnedToTrueNorthAndEast) {
  const GeoReference north_up(Datum{47.0, 8.0, 0.0, 0.0});  // x north, y west
  context_.geo = &north_up;
  core::Fix fix = good_fix();
  fix.covariance(0, 0) = 0.04;
  fix.covariance(1, 1) = 0.01;
  const std::vector<std::string> sentences = lines(fix, context_);
  EXPECT_EQ(fields(sentences[2])[2], "0.200");
  EXPECT_EQ(fields(sentences[2])[3], "0.100");
  EXPECT_EQ(fields(sentences[4])[5], "0.0");
  // A positive correlation of x (north) and y (west) leans the ellipse to the north-west.
  fix.covariance(1, 1) = 0.04;
  fix.covariance(0, 1) = fix.covariance(1, 0) = 0.02;
  EXPECT_EQ(fields(lines(fix, context_)[4])[5], "135.0");
}

TEST_F(Nmea, AnUnusableCovarianceLeavesItsFieldsEmpty) {
  core::Fix fix = good_fix();
  fix.covariance(0, 0) = std::nan("");
  const std::vector<std::string> sentences = lines(fix, context_);
  EXPECT_EQ(fields(sentences[0])[2], "A");
  EXPECT_EQ(fields(sentences[1])[8], "");
  EXPECT_EQ(sentences[2], "$GPGBS,101530.20,,,,,,,*6B");
  EXPECT_EQ(sentences[4], "$GPGST,101530.20,,,,,,,*7D");
  EXPECT_EQ(fields(sentences[5])[9], "");
  EXPECT_EQ(fields(sentences[5])[10], "");
}

TEST_F(Nmea, APoseThatIsNotFiniteIsNoFix) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
    core::Fix fix = good_fix();
    fix.pose_W.y_m = bad;
    const std::vector<std::string> sentences = lines(fix, context_);
    EXPECT_EQ(fields(sentences[0])[2], "V");
    EXPECT_EQ(fields(sentences[1])[6], "0");
    EXPECT_EQ(fields(sentences.back())[3], "V");
    EXPECT_EQ(fields(sentences.back())[6], "");
  }
}

TEST_F(Nmea, WritesNothingIntoABufferThatMayBeTooSmall) {
  std::array<char, kNmeaEpochBytesMax> out{};
  EXPECT_EQ(format_nmea(good_fix(), context_, std::span<char>(out).first(kNmeaEpochBytesMax - 1)), 0U);
  EXPECT_EQ(out[0], '\0');
}

// The longest of everything still fits, gives up decimals before characters, and loses no sentence.
TEST_F(Nmea, NoSentenceEverExceeds82Characters) {
  const GeoReference far(Datum{-89.5, -179.9, -1000.0, 12.0});
  context_.geo = &far;
  context_.zda = true;
  context_.sentences.ths = true;
  context_.landmark_sigma_m = 1e-9;
  context_.moment = NmeaMoment{.utc = good_fix().time.middle_utc, .age = 200'000s};
  core::Fix fix = good_fix();
  fix.pose_W = {-1e6, -1e6, -1e-9};
  fix.covariance = Eigen::Matrix3d::Identity() * 1e300;
  fix.error_xi = std::numeric_limits<std::uint32_t>::max();
  fix.matches = fix.landmarks_seen = std::numeric_limits<std::uint32_t>::max();
  fix.map = std::numeric_limits<std::uint32_t>::max();
  fix.protection_radius_m = 1e300;
  const std::vector<std::string> sentences = lines(fix, context_);
  ASSERT_EQ(sentences.size(), 8U);
  for (const std::string& line : sentences) {
    expect_well_formed(line);
  }
  ASSERT_EQ(fields(sentences.back()).size(), 17U);
  EXPECT_EQ(fields(sentences.back())[6], "-1000000");
  EXPECT_EQ(fields(sentences.back())[15], "4294967295");
  for (const std::size_t given_up : {9U, 10U, 14U, 16U}) {
    EXPECT_EQ(fields(sentences.back())[given_up], "");
  }
}

TEST_F(Nmea, ThePlaceKeepsItsMillimetresWhileOtherFieldsGetShorter) {
  core::Fix fix = good_fix();
  fix.pose_W.x_m = fix.pose_W.y_m = -234.567;
  fix.error_xi = 12;
  fix.protection_radius_m = 0.61;
  context_.moment = NmeaMoment{.utc = good_fix().time.middle_utc, .age = 5300ms};
  EXPECT_EQ(lines(fix, context_).back().substr(27), ",-234.567,-234.567,326.55,0.06,0.5,12,8,11,5,1,0.7*6C");
}

// A radius that looks smaller than it is would promise too much.
TEST_F(Nmea, TheProtectionRadiusIsRoundedUp) {
  core::Fix fix = good_fix();
  for (const auto& [radius_m, text] : {std::pair(0.4, "0.40"), std::pair(0.401, "0.41"),
                                       std::pair(2.0 / 3.0, "0.67"), std::pair(0.0001, "0.01")}) {
    fix.protection_radius_m = radius_m;
    EXPECT_EQ(fields(lines(fix, context_).back())[16], text);
  }
  for (const double unknown : {0.0, -1.0, std::nan("")}) {
    fix.protection_radius_m = unknown;
    EXPECT_EQ(fields(lines(fix, context_).back())[16], "");
  }
}

// A pose in another frame would be taken for one in the home map.
TEST_F(Nmea, APoseInALocalMapIsNoFix) {
  core::Fix fix = good_fix();
  fix.status = core::FixStatus::NoFix;
  fix.reason = core::FixReason::LocalMap;
  fix.map = 2;
  const std::vector<std::string> sentences = lines(fix, context_);
  EXPECT_EQ(fields(sentences[0])[2], "V");
  EXPECT_EQ(sentences.back().substr(0, 49), "$PSLMA,POSE,101530.20,V,A,10,,,,,,,8,11,0.00,,*50");
}

TEST_F(Nmea, ReasonsHaveTheirNumbers) {
  core::Fix fix = good_fix();
  fix.status = core::FixStatus::NoFix;
  for (const auto& [reason, number] :
       {std::pair(core::FixReason::Timing, "8"), std::pair(core::FixReason::Copy, "9"),
        std::pair(core::FixReason::LocalMap, "10"), std::pair(core::FixReason::NoScan, "11")}) {
    fix.reason = reason;
    EXPECT_EQ(fields(lines(fix, context_).back())[5], number);
  }
  EXPECT_EQ(fields(lines(core::Fix{}, context_).back())[5], "11") << "before the first scan";
}

double angle_deg(const std::string& text, std::size_t degree_digits, char hemisphere) {
  const double degrees =
      std::stod(text.substr(0, degree_digits)) + std::stod(text.substr(degree_digits)) / 60.0;
  return hemisphere == 'S' || hemisphere == 'W' ? -degrees : degrees;
}

TEST(NmeaProperty, APositionReadsBackWithinAMillimetre) {
  constexpr unsigned kSeed = 20250714;
  std::mt19937_64 random(kSeed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  for (int i = 0; i < 20'000; ++i) {
    const Datum datum{uniform(-89.0, 89.0), uniform(-180.0, 180.0), uniform(-100.0, 4000.0),
                      uniform(0.0, 360.0)};
    const GeoReference geo(datum);
    core::Fix fix = good_fix();
    fix.pose_W = {uniform(-5000.0, 5000.0), uniform(-5000.0, 5000.0), uniform(-4.0, 4.0)};
    const std::vector<std::string> sentences = lines(fix, NmeaContext{.geo = &geo});
    for (const std::string& line : sentences) {
      expect_well_formed(line);
    }
    const std::vector<std::string> gga = fields(sentences[1]);
    const GeographicLib::LocalCartesian plane(datum.latitude_deg, datum.longitude_deg, datum.height_m);
    double east_m = 0.0;
    double north_m = 0.0;
    double up_m = 0.0;
    plane.Forward(angle_deg(gga[2], 2, gga[3][0]), angle_deg(gga[4], 3, gga[5][0]),
                  geo.locate(fix.pose_W).height_m, east_m, north_m, up_m);
    const double beta = datum.bearing_deg * core::kDegree;
    const double x_m = east_m * std::sin(beta) + north_m * std::cos(beta);
    const double y_m = -east_m * std::cos(beta) + north_m * std::sin(beta);
    ASSERT_NEAR(x_m, fix.pose_W.x_m, 1e-3) << "seed " << kSeed << " case " << i << ' ' << sentences[1];
    ASSERT_NEAR(y_m, fix.pose_W.y_m, 1e-3) << "seed " << kSeed << " case " << i << ' ' << sentences[1];
    const std::vector<std::string> local = fields(sentences.back());
    ASSERT_NEAR(std::stod(local[6]), fix.pose_W.x_m, 1e-3) << "seed " << kSeed << " case " << i;
    ASSERT_NEAR(std::stod(local[7]), fix.pose_W.y_m, 1e-3) << "seed " << kSeed << " case " << i;
  }
}

}  // namespace
}  // namespace slamsensor::firmware
