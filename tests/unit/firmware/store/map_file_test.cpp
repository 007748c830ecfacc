#include "firmware/store/map_file.hpp"

#include "firmware/control/control_request.hpp"
#include "firmware/store/map_names.hpp"
#include "tests/support/forest.hpp"
#include "tests/unit/firmware/store/golden_maps.hpp"
#include "tests/unit/firmware/store/sample_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

namespace slamsensor::firmware {
namespace {

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same_numbers(const core::MapState& a, const core::MapState& b) {
  EXPECT_EQ(a.weight, b.weight);
  EXPECT_EQ(a.landmarks_evicted, b.landmarks_evicted);
  EXPECT_EQ(a.path_thinnings, b.path_thinnings);
  EXPECT_EQ(a.next_id, b.next_id);
  EXPECT_EQ(a.scans, b.scans);
}

void expect_same_about(const MapAbout& a, const MapAbout& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.created_utc_s, b.created_utc_s);
  EXPECT_EQ(a.saved_utc_s, b.saved_utc_s);
  EXPECT_EQ(a.saves, b.saves);
  EXPECT_EQ(a.frozen, b.frozen);
  ASSERT_EQ(a.datum.has_value(), b.datum.has_value());
  if (a.datum) {
    EXPECT_EQ(a.datum->latitude_deg, b.datum->latitude_deg);
    EXPECT_EQ(a.datum->longitude_deg, b.datum->longitude_deg);
    EXPECT_EQ(a.datum->height_m, b.datum->height_m);
    EXPECT_EQ(a.datum->bearing_deg, b.datum->bearing_deg);
  }
  EXPECT_EQ(a.method.tolerance_m, b.method.tolerance_m);
  EXPECT_EQ(a.method.range_step_m, b.method.range_step_m);
  EXPECT_EQ(a.method.bearing_step_rad, b.method.bearing_step_rad);
  EXPECT_EQ(a.method.depth, b.method.depth);
  EXPECT_EQ(a.method.landmarks_max, b.method.landmarks_max);
}

TEST(Crc32, IsThatOfZlib) {
  constexpr std::string_view kDigits = "123456789";
  const std::vector<std::uint8_t> digits(kDigits.begin(), kDigits.end());
  EXPECT_EQ(crc32_of(digits), 0xCBF43926U);
  EXPECT_EQ(crc32_of(std::span(digits).first(4), std::span(digits).subspan(4)), 0xCBF43926U);
}

TEST(MapFile, TheSampleIsWrittenAsTheGoldenFile) {
  EXPECT_EQ(tests::sample_bytes(), tests::from_hex(tests::kGoldenMap));
}

TEST(MapFile, AMapMarkedFrozenIsElseTheSame) {
  MapFile sample = tests::sample_map();
  sample.about.frozen = true;
  EXPECT_EQ(encode_map(sample.about, sample.state()), tests::from_hex(tests::kGoldenFrozenMap));
  const auto map = decode_map(tests::from_hex(tests::kGoldenFrozenMap), unlimited_capacities());
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_TRUE(map->about.frozen);
  expect_same_about(map->about, sample.about);
  EXPECT_TRUE(same_bytes(map->landmarks, sample.landmarks));
  EXPECT_TRUE(same_bytes(map->path, sample.path));
}

// A survey that a sensor loaded, or `locate`, was a map like any other, and a driven map a survey.
TEST(MapFile, ASurveyIsMarkedWhereItIsFrozenAndNoOlderFileIsOne) {
  MapFile sample = tests::sample_map();
  sample.about.frozen = true;
  sample.numbers.is_surveyed = true;
  const auto survey = decode_map(encode_map(sample.about, sample.state()), unlimited_capacities());
  ASSERT_TRUE(survey) << survey.error().message;
  EXPECT_TRUE(survey->about.frozen);
  EXPECT_TRUE(survey->state().is_surveyed);
  sample.about.frozen = false;
  const auto grown = decode_map(encode_map(sample.about, sample.state()), unlimited_capacities());
  ASSERT_TRUE(grown) << grown.error().message;
  EXPECT_FALSE(grown->state().is_surveyed) << "what may grow leaves something out";
  for (const auto& golden : {tests::kGoldenMap, tests::kGoldenFrozenMap}) {
    const auto old = decode_map(tests::from_hex(golden), unlimited_capacities());
    ASSERT_TRUE(old) << old.error().message;
    EXPECT_FALSE(old->state().is_surveyed);
  }
}

TEST(MapFile, WhatWasLearnedWithAMapIsKept) {
  MapFile sample = tests::sample_map();
  core::Rates rates;
  double next = 0.0;
  core::Rates::visit_numbers(rates, [&](auto& number) {
    number += static_cast<std::remove_reference_t<decltype(number)>>(next += 0.25);
  });
  rates.offset_m = -0.125;
  sample.numbers.rates = rates;
  const auto bytes = encode_map(sample.about, sample.state());
  const auto map = decode_map(bytes, unlimited_capacities());
  ASSERT_TRUE(map) << map.error().message;
  ASSERT_TRUE(map->numbers.rates);
  EXPECT_EQ(map->numbers.rates->spread_m2, 0.25);
  EXPECT_EQ(map->numbers.rates->structure_decades, core::Rates::kStartStructure + 2.0);
  EXPECT_EQ(map->numbers.rates->bearings.back(), 19.0F);
  EXPECT_EQ(encode_map(map->about, map->state()), bytes);
  for (const double bad : {std::nan(""), HUGE_VAL, -1.0, rates.offset_m, 1e10}) {
    sample.numbers.rates = rates;
    sample.numbers.rates->clutter_count = bad;
    const auto refused = decode_map(encode_map(sample.about, sample.state()), unlimited_capacities());
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().problem, MapProblem::Flawed);
    EXPECT_TRUE(refused.error().message.starts_with("what was learned with it has a number that cannot be"))
        << bad;
  }
}

// Version 3 has nothing of what was learned, version 4 all but how well sizes are measured.
TEST(MapFile, OlderVersionsAreReadWhichHaveNoSizes) {
  MapFile sample = tests::sample_map();
  for (core::MapLandmark& landmark : sample.landmarks) {
    landmark.size = {};
  }
  for (const auto& golden : {tests::kGoldenMapOfVersion3, tests::kGoldenMapOfVersion4}) {
    auto old = decode_map(tests::from_hex(golden), unlimited_capacities());
    ASSERT_TRUE(old) << old.error().message;
    ASSERT_EQ(old->numbers.rates.has_value(), golden == tests::kGoldenMapOfVersion4);
    if (old->numbers.rates) {
      EXPECT_EQ(old->numbers.rates->spread_m2, 0.25);
      EXPECT_EQ(old->numbers.rates->bearings.back(), 19.0F);
      EXPECT_EQ(old->numbers.rates->size_square, 0.0);
      EXPECT_EQ(old->numbers.rates->size_count, 0.0);
    }
    old->numbers.rates.reset();
    EXPECT_EQ(encode_map(old->about, old->state()), encode_map(sample.about, sample.state()));
  }
}

TEST(MapFile, ADatumIsAPlaceThatTheSettingsCanHaveToo) {
  MapFile sample = tests::sample_map();
  const auto loads = [&](double height_m, double bearing_deg) {
    sample.about.datum = Datum{10.0, 20.0, height_m, bearing_deg};
    EXPECT_EQ(is_on_earth(*sample.about.datum),
              decode_map(encode_map(sample.about, sample.state()), unlimited_capacities()).has_value());
    return is_on_earth(*sample.about.datum);
  };
  for (const double height_m : {-1000.0, 0.0, 10'000.0}) {
    EXPECT_TRUE(loads(height_m, 90.0));
    EXPECT_TRUE(parse_control_request("datum set 10 20 " + std::to_string(height_m) + " 90")) << height_m;
  }
  for (const double height_m : {-1001.0, 10'001.0, 1e308, -1e308, std::nan(""), HUGE_VAL}) {
    EXPECT_FALSE(loads(height_m, 90.0));
    EXPECT_FALSE(parse_control_request("datum set 10 20 " + std::to_string(height_m) + " 90")) << height_m;
  }
  EXPECT_FALSE(loads(0.0, 361.0));
}

TEST(MapFile, TheGoldenFileIsTheSample) {
  const auto map = decode_map(tests::from_hex(tests::kGoldenMap), unlimited_capacities());
  ASSERT_TRUE(map) << map.error().message;
  const MapFile sample = tests::sample_map();
  expect_same_about(map->about, sample.about);
  expect_same_numbers(map->numbers, sample.numbers);
  EXPECT_TRUE(same_bytes(map->landmarks, sample.landmarks));
  EXPECT_TRUE(same_bytes(map->positions_W, sample.positions_W));
  EXPECT_TRUE(same_bytes(map->path, sample.path));
}

TEST(MapFile, RandomMapsComeBackBitForBit) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    tests::Draw draw(seed);
    MapFile map = tests::sample_map();
    map.about.name = std::string(1 + draw.below(64), 'x');
    if (draw.below(2) == 0) {
      map.about.datum.reset();
    }
    const std::uint32_t count = 3 + draw.below(500);
    map.landmarks.assign(count, map.landmarks[0]);
    map.positions_W.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      map.landmarks[i].id = i;
      map.positions_W[i] = {draw.uniform(-65e3, 65e3), draw.normal(100.0)};
    }
    map.path.resize(draw.below(40));
    for (std::uint32_t i = 0; i < map.path.size(); ++i) {
      map.path[i] = {i, draw.below(5), {draw.normal(9.0), draw.normal(9.0), draw.normal(1.0)}};
    }
    map.numbers.next_id = count;
    const auto back = decode_map(encode_map(map.about, map.state()), unlimited_capacities());
    ASSERT_TRUE(back) << "seed " << seed << ": " << back.error().message;
    expect_same_about(back->about, map.about);
    expect_same_numbers(back->numbers, map.numbers);
    EXPECT_TRUE(same_bytes(back->landmarks, map.landmarks)) << "seed " << seed;
    EXPECT_TRUE(same_bytes(back->positions_W, map.positions_W)) << "seed " << seed;
    EXPECT_TRUE(same_bytes(back->path, map.path)) << "seed " << seed;
  }
}

TEST(MapFile, EveryFlippedBitIsFound) {
  const std::vector<std::uint8_t> good = tests::sample_bytes();
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::vector<std::uint8_t> bytes = good;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_FALSE(decode_map(bytes, unlimited_capacities())) << "bit " << bit;
  }
}

TEST(MapFile, EveryShorterFileIsRefused) {
  const std::vector<std::uint8_t> good = tests::sample_bytes();
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(decode_map(std::span(good).first(size), unlimited_capacities())) << size << " bytes";
  }
}

TEST(MapText, NamesHaveOneToSixtyFourPlainCharacters) {
  EXPECT_TRUE(is_map_name("default"));
  EXPECT_TRUE(is_map_name("A-z_09"));
  EXPECT_TRUE(is_map_name(std::string(64, 'a')));
  for (const std::string& name :
       {std::string(), std::string(65, 'a'), std::string("a b"), std::string(".."), std::string("../a"),
        std::string("a/b"), std::string("a.b"), std::string("a\0b", 3), std::string("\xC3\xA4")}) {
    EXPECT_FALSE(is_map_name(name)) << name;
  }
}

TEST(MapText, TimesAreWrittenAsUtc) {
  EXPECT_EQ(utc_text(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(utc_text(1'795'439'109), "2026-11-23T13:05:09Z");
  EXPECT_EQ(utc_name(951'782'400), "20000229T000000Z");
  EXPECT_EQ(utc_text(INT64_MAX), "9999-12-31T23:59:59Z");
  EXPECT_EQ(utc_text(-1), "1970-01-01T00:00:00Z");
}

}  // namespace
}  // namespace slamsensor::firmware
