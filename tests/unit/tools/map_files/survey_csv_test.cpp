#include "tools/map_files/survey_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kDegrees = "-35.1,149.1\n-35.1001,149.1001\n-35.1002,149.1003\n";

tl::expected<Survey, InputError> read(const std::string& text, const SurveyColumns& columns = {}) {
  return parse_survey_csv(text, "s.csv", columns);
}

TEST(SurveyCsv, KnowsTheUsualNamesOfDegreesInAnyCase) {
  for (const char* const names :
       {"Lat,Lon", "lat,lng", "LATITUDE,LONGITUDE", "Latitude,Long", "LATITUDE_DEG,longitude_deg"}) {
    const auto survey = read(std::string(names) + '\n' + kDegrees);
    ASSERT_TRUE(survey) << names;
    EXPECT_EQ(survey->frame, SurveyFrame::Wgs84) << names;
    EXPECT_EQ(survey->points[1].place.longitude_deg, 149.1001) << names;
  }
}

TEST(SurveyCsv, KnowsTheUsualNamesOfMetresInAnyCase) {
  for (const char* const names : {"X,Y", "X_M,y_m", "Easting,Northing"}) {
    const auto survey = read(std::string(names) + "\n1,2\n");
    ASSERT_TRUE(survey) << names;
    EXPECT_EQ(survey->points[0].local_m, core::Point2(1, 2)) << names;
  }
}

TEST(SurveyCsv, NamedColumnsThatMeanDegreesAreDegrees) {
  const std::string text = "x,y,Lat,Lng\n1,2,-35.1,149.1\n";
  for (const SurveyColumns& columns : {SurveyColumns{"Lat", "Lng", {}}, SurveyColumns{"Lng", "Lat", {}}}) {
    const auto survey = read(text, columns);
    ASSERT_TRUE(survey);
    EXPECT_EQ(survey->frame, SurveyFrame::Wgs84);
    EXPECT_EQ(survey->points[0].place.latitude_deg, -35.1);
  }
  const auto mixed = read(text, {"Lat", "y", {}});
  ASSERT_FALSE(mixed);
  EXPECT_THAT(mixed.error().message, HasSubstr("one of them means degrees"));
}

TEST(SurveyCsv, SaysWhichDegreesItDoesNotRead) {
  EXPECT_EQ(read("id,x_m,y_m,lat,lon\n1,1,2,-35,149\n")->degrees_not_read, "lat lon");
  EXPECT_EQ(read("id,x_m,y_m\n1,1,2\n")->degrees_not_read, "");
}

TEST(SurveyCsv, TheHintNamesTheShortNamesToo) {
  const auto survey = read("a,b\n1,2\n");
  ASSERT_FALSE(survey);
  EXPECT_THAT(survey.error().message, AllOf(HasSubstr("lat,lon"), HasSubstr("--columns")));
}

TEST(SurveyMap, KeepsDiameters) {
  const auto sizes = [](const tl::expected<Survey, InputError>& survey) {
    std::vector<double> diameters_m;
    const auto made = map_of_survey(survey.value(), "s", {});
    for (const core::MapLandmark& landmark : made->map.landmarks) {
      diameters_m.push_back(std::round(1e4 * landmark.size.diameter_m()) / 1e4);
    }
    return diameters_m;
  };
  const std::vector<double> known{0.25, 0.0, 0.5};
  EXPECT_EQ(sizes(read("id,x_m,y_m,diameter_m\n1,1,2,0.25\n2,7,3,\n3,5,6,0.5\n")), known);
  const std::string point = R"({"type":"Feature","geometry":{"type":"Point","coordinates":[)";
  EXPECT_EQ(sizes(parse_survey_geojson(R"({"type":"FeatureCollection","crs":null,"features":[)" + point +
                                           R"(1,2]},"properties":{"diameter_m":0.25}},)" + point +
                                           R"(7,3]},"properties":{"diameter_m":"thick"}},)" + point +
                                           R"(5,6]},"properties":{"diameter_m":0.5}}]})",
                                       "s.geojson")),
            known);
  EXPECT_THAT(read("x_m,y_m,diameter_m\n1,2,thick\n").error().message,
              AllOf(HasSubstr("s.csv:2"), HasSubstr("diameter_m")));
}

TEST(SurveyMap, SaysWhyIdsAreGivenAnew) {
  const auto problem = [](const std::string& text) {
    return map_of_survey(*read(text), "s.csv", {})->id_problem;
  };
  EXPECT_EQ(problem("id,x_m,y_m\n1,1,2\n2,7,3\n3,5,6\n"), "");
  EXPECT_EQ(problem("id,x_m,y_m\n1,1,2\n1,7,3\n3,5,6\n"), "line 3 has the id 1 of line 2 once more");
  EXPECT_EQ(problem("x_m,y_m\n1,2\n7,3\n5,6\n"), "the survey has none");
  EXPECT_EQ(problem("id,x_m,y_m\n1,1,2\nb,7,3\n3,5,6\n"), "line 3 has no id that is a whole number");
}

TEST(SurveyGeoJson, ReadsCollectionsOfGeometriesAndTheIdsOfFeatures) {
  const auto survey = parse_survey_geojson(
      R"({"type":"FeatureCollection","features":[{"type":"Feature","id":100,"properties":null,"geometry":)"
      R"({"type":"GeometryCollection","geometries":[{"type":"Point","coordinates":[149.1,-35.1]},)"
      R"({"type":"LineString","coordinates":[]}]}},{"type":"Feature","id":101,"properties":{"id":7},)"
      R"("geometry":{"type":"Point","coordinates":[149.2,-35.2]}}]})",
      "s.geojson");
  ASSERT_TRUE(survey);
  ASSERT_EQ(survey->points.size(), 2U);
  EXPECT_EQ(survey->points[0].id, 100);
  EXPECT_EQ(survey->points[1].id, 7) << "the property goes before";
  EXPECT_EQ(survey->passed_over, 1U);
}

}  // namespace
}  // namespace slamsensor::tools
