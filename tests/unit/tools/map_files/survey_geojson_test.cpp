// GeoJSON of the wrong shape: each is refused with the file, its line and what is wrong.
#include "tools/map_files/survey_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string error_of(const std::string& text) {
  const auto survey = parse_survey_geojson(text, "s.geojson");
  return survey ? std::string() : survey.error().message;
}

std::string collection(const std::string& features, const std::string& more = "") {
  return R"({"type":"FeatureCollection",)" + more + R"("features":)" + features + "}";
}

std::string feature(const std::string& geometry, const std::string& properties = "{}") {
  return R"({"type":"Feature","properties":)" + properties + R"(,"geometry":)" + geometry + "}";
}

const std::string kPoint = R"({"type":"Point","coordinates":[1,2]})";

/// Whatever JSON may stand in a place.
const std::vector<std::string> kValues{"null",
                                       "true",
                                       "5",
                                       "-1.5",
                                       "1e300",
                                       R"("text")",
                                       "[]",
                                       "[[[[]]]]",
                                       "{}",
                                       "[{}]",
                                       R"({"a":{"b":1}})",
                                       R"([null,"x",{}])"};

TEST(SurveyGeoJson, ReadsTheShapesOfTheStandard) {
  for (const std::string& text :
       {kPoint, feature(kPoint), collection("[" + feature(kPoint) + "]"),
        std::string(R"({"type":"MultiPoint","coordinates":[[1,2],[3,4]]})"),
        collection("[" + feature(kPoint, "null") + "," + feature("null") + "," +
                   feature(R"({"type":"GeometryCollection","geometries":[]})") + "]")}) {
    EXPECT_EQ(error_of(text), "") << text;
  }
}

TEST(SurveyGeoJson, NoValueInAnyPlaceIsAFault) {
  for (const std::string& value : kValues) {
    for (const std::string& text :
         {value, R"({"type":)" + value + "}", collection(value), collection("[" + value + "]"),
          collection("[" + feature(value) + "]"), feature(R"({"type":)" + value + R"(,"coordinates":[1,2]})"),
          feature(R"({"type":"Point","coordinates":)" + value + "}"),
          feature(R"({"type":"Point","coordinates":[1,)" + value + "]}"),
          feature(R"({"type":"MultiPoint","coordinates":)" + value + "}"),
          feature(R"({"type":"MultiPoint","coordinates":[)" + value + "]}"), feature(kPoint, value),
          feature(kPoint, R"({"id":)" + value + "}"), feature(kPoint, R"({"kind":)" + value + "}"),
          collection("[" + feature(kPoint) + "]", R"("crs":)" + value + ","),
          collection("[" + feature(kPoint) + "]", R"("crs":{"properties":)" + value + "},"),
          collection("[" + feature(kPoint) + "]", R"("crs":{"properties":{"name":)" + value + "}},"),
          collection("[" + feature(kPoint) + "]", R"("slamsensor":)" + value + ","),
          collection("[" + feature(kPoint) + "]", R"("slamsensor":{"datum":)" + value + "},")}) {
      const auto survey = parse_survey_geojson(text, "s.geojson");  // does not throw
      if (!survey) {
        EXPECT_THAT(survey.error().message, HasSubstr("s.geojson")) << text;
        EXPECT_GT(survey.error().message.size(), 20U) << text;
      } else {
        EXPECT_FALSE(survey->points.empty()) << text;
      }
    }
  }
}

TEST(SurveyGeoJson, SaysWhatIsWrong) {
  EXPECT_THAT(error_of(R"({"type":"FeatureCollection","features":{"a":1}})"),
              AllOf(HasSubstr("s.geojson:1"), HasSubstr("\"features\": [...]")));
  EXPECT_THAT(error_of(R"({"type":"FeatureCollection"})"), HasSubstr("\"features\": [...]"));
  EXPECT_THAT(error_of(R"({"type":"Feature","geometry":{"type":null,"coordinates":[1,2]}})"),
              HasSubstr("a geometry needs a \"type\""));
  EXPECT_THAT(error_of(R"({"type":5})"), HasSubstr("\"type\" that is a text"));
  EXPECT_THAT(error_of(R"({"type":"MultiPoint","coordinates":null})"), HasSubstr("a MultiPoint needs"));
  EXPECT_THAT(error_of(collection("[\n" + feature(kPoint) + ",\n5]")), HasSubstr("s.geojson"));
  EXPECT_THAT(error_of(collection("[" + feature(kPoint) + "]", R"("crs":5,)")),
              HasSubstr("\"crs\" names no"));
  EXPECT_THAT(error_of(collection("[" + feature(kPoint) + "]",
                                  R"("slamsensor":{"datum":{"latitude_deg":1,"longitude_deg":2,)"
                                  R"("height_m":1e308,"bearing_deg":0}},)")),
              HasSubstr("no place on the earth"));
}

TEST(SurveyGeoJson, RefusesWhatNestsWithoutEnd) {
  const std::string open(100'000, '[');
  const std::string close(100'000, ']');
  EXPECT_THAT(error_of(collection("[" + feature(kPoint, R"({"a":)" + open + close + "}") + "]")),
              HasSubstr("nests more than"));
  EXPECT_NE(error_of(open), "");
}

// 2^64 - 1 became -1, and a map with an id that no map can have.
TEST(SurveyGeoJson, AnIdThatIsTooLargeIsNone) {
  std::string features;
  for (const char* const id : {"1", "2", "18446744073709551615"}) {
    features +=
        (features.empty() ? "" : ",") +
        feature(R"({"type":"Point","coordinates":[)" + std::string(1, id[0]) + R"(e-4,)" + id[0] + "e-4]}",
                R"({"id":)" + std::string(id) + "}");
  }
  const auto survey = parse_survey_geojson(
      collection("[" + features + R"(,)" + feature(R"({"type":"Point","coordinates":[5e-4,0]})") + "]"),
      "s.geojson");
  ASSERT_TRUE(survey) << survey.error().message;
  EXPECT_FALSE(survey->points[2].id.has_value());
  const auto made = map_of_survey(*survey, "s.geojson", {});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_NE(made->id_problem, "");
  EXPECT_EQ(made->map.numbers.next_id, made->map.landmarks.size());
}

TEST(SurveyMap, IsMarkedAsASurveyUnlessItMayGrow) {
  const auto survey = parse_survey_geojson(
      R"({"type":"MultiPoint","coordinates":[[1e-4,0],[0,1e-4],[2e-4,2e-4],[3e-4,0]]})", "s.geojson");
  ASSERT_TRUE(survey);
  SurveyMapWishes wishes;
  EXPECT_TRUE(map_of_survey(*survey, "s", wishes)->map.state().is_surveyed);
  wishes.frozen = false;
  EXPECT_FALSE(map_of_survey(*survey, "s", wishes)->map.state().is_surveyed);
}

}  // namespace
}  // namespace slamsensor::tools
