#include "firmware/output/nmea.hpp"
#include "firmware/output/nmea_sentence.hpp"
#include "tests/unit/firmware/output/nmea_lines.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <random>
#include <string>

namespace slamsensor::firmware {
namespace {

using namespace std::chrono_literals;
using namespace tests;
using testing::HasSubstr;

NmeaConfig only(bool NmeaSentences::*sentence) {
  NmeaConfig config;
  config.sentences = {.rmc = false, .gga = false, .gbs = false, .hdt = false, .ths = false, .gst = false};
  config.sentences.pslma = false;
  config.sentences.*sentence = true;
  return config;
}

constexpr bool NmeaSentences::*kEach[] = {&NmeaSentences::rmc,  &NmeaSentences::gga, &NmeaSentences::gbs,
                                          &NmeaSentences::hdt,  &NmeaSentences::ths, &NmeaSentences::gst,
                                          &NmeaSentences::pslma};

/// A fix all of whose numbers are as long as they get.
core::Fix longest_fix() {
  core::Fix fix = good_fix();
  fix.pose_W = {-1e6, -1e6, -core::kDegree};
  fix.covariance = Eigen::Matrix3d::Identity() * 1e10;
  fix.covariance(0, 1) = fix.covariance(1, 0) = -5e9;
  fix.error_xi = fix.matches = fix.landmarks_seen = std::numeric_limits<std::uint32_t>::max();
  fix.map = std::numeric_limits<std::uint32_t>::max();
  fix.protection_radius_m = 1e4;
  return fix;
}

// The table of lengths is right: reached by the longest that there is, and never exceeded.
TEST(NmeaLine, EachSentenceReachesItsMostBytes) {
  const GeoReference geo(Datum{-80.0, -170.0, -1000.0, 12.0});
  for (bool NmeaSentences::*const sentence : kEach) {
    const NmeaConfig config = only(sentence);
    NmeaContext context = nmea_context(config, &geo, NmeaMode::Live);
    context.landmark_sigma_m = 100.0;
    context.moment = NmeaMoment{.utc = good_fix().time.middle_utc, .age = 99'999s};
    EXPECT_EQ(epoch_text(longest_fix(), context).size(), nmea_epoch_bytes_max(config));
  }
}

TEST(NmeaLineProperty, NoEpochExceedsTheMostBytesOfItsSentences) {
  constexpr unsigned kSeed = 4711;
  std::mt19937_64 random(kSeed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  for (int i = 0; i < 20'000; ++i) {
    const GeoReference geo(
        Datum{uniform(-90.0, 90.0), uniform(-180.0, 180.0), uniform(-1000.0, 1e4), uniform(0.0, 360.0)});
    NmeaConfig config;
    for (bool NmeaSentences::*const sentence : kEach) {
      config.sentences.*sentence = uniform(0.0, 1.0) < 0.7;
    }
    config.zda = uniform(0.0, 1.0) < 0.5;
    config.landmark_sigma_m = std::pow(10.0, uniform(-3.0, 2.0));
    core::Fix fix = good_fix();
    fix.status = static_cast<core::FixStatus>(i % 3);
    const double reach_m = std::pow(10.0, uniform(0.0, 6.0));
    fix.pose_W = {uniform(-reach_m, reach_m), uniform(-reach_m, reach_m), uniform(-4.0, 4.0)};
    fix.covariance = Eigen::Matrix3d::Identity() * std::pow(10.0, uniform(-6.0, 12.0));
    fix.matches = static_cast<std::uint32_t>(uniform(0.0, 2000.0));
    fix.error_xi = static_cast<std::uint32_t>(uniform(0.0, 20'000.0));
    fix.map = static_cast<std::uint32_t>(std::pow(10.0, uniform(0.0, 9.0)));
    fix.protection_radius_m = std::pow(10.0, uniform(-3.0, 6.0));
    NmeaContext context = nmea_context(config, &geo, NmeaMode::Live);
    context.moment =
        NmeaMoment{.utc = good_fix().time.middle_utc, .age = hal::from_seconds(uniform(0.0, 1e6))};
    ASSERT_LE(epoch_text(fix, context).size(), nmea_epoch_bytes_max(config))
        << "seed " << kSeed << " case " << i;
  }
}

TEST(NmeaLine, TheDefaultFitsTheDefaultLine) {
  const NmeaLineLoad load = nmea_line_load(NmeaConfig{}, 1.0, 38'400);
  EXPECT_LT(load.share(), 0.1);
  EXPECT_TRUE(load.fits());
  EXPECT_TRUE(nmea_line_load(NmeaConfig{}, 1.0, 4800).fits());
}

TEST(NmeaLine, TenHertzOfEverythingDoesNotFitTheDefaultLine) {
  NmeaConfig config;
  config.zda = true;
  const NmeaLineLoad load = nmea_line_load(config, 10.0, 38'400);
  EXPECT_DOUBLE_EQ(load.bits_per_s(), 100.0 * static_cast<double>(nmea_epoch_bytes_max(NmeaConfig{})) +
                                          10.0 * static_cast<double>(nmea_epoch_bytes_max(config) -
                                                                     nmea_epoch_bytes_max(NmeaConfig{})));
  EXPECT_FALSE(load.fits());
  EXPECT_TRUE(nmea_line_load(config, 10.0, 57'600).fits());
  EXPECT_THAT(to_text(load), HasSubstr("10 epochs/s of up to"));
  EXPECT_THAT(to_text(load), HasSubstr("of the line's 38400"));
}

TEST(NmeaLine, TheAdviceOfTheTextIsGoodAdvice) {
  const NmeaLineLoad load = nmea_line_load(NmeaConfig{}, 10.0, 9600);
  const std::string text = to_text(load);
  const double baud = std::stod(text.substr(text.find("at least ") + 9));
  const double rate_hz = std::stod(text.substr(text.find("at most ") + 8));
  EXPECT_TRUE(nmea_line_load(NmeaConfig{}, 10.0, static_cast<std::uint32_t>(baud)).fits()) << text;
  EXPECT_FALSE(nmea_line_load(NmeaConfig{}, 10.0, static_cast<std::uint32_t>(baud) - 1).fits()) << text;
  EXPECT_TRUE(nmea_line_load(NmeaConfig{}, rate_hz, 9600).fits()) << text;
  EXPECT_FALSE(nmea_line_load(NmeaConfig{}, rate_hz + 0.02, 9600).fits()) << text;
}

}  // namespace
}  // namespace slamsensor::firmware
