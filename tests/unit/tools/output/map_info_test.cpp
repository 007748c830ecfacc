#include "tests/unit/firmware/store/sample_map.hpp"
#include "tools/output/result_files.hpp"

#include <gtest/gtest.h>

namespace slamsensor::tools {
namespace {

TEST(MapInfo, ReportsWhatAMapHolds) {
  EXPECT_EQ(
      map_info_text(tests::sample_map(), 564),
      "map        orchard-7\n"
      "file       564 bytes\n"
      "saved      2026-11-23T13:05:09Z, save 12 since 2026-01-01T00:00:00Z\n"
      "landmarks  5 from 40 scans, W 5000000019\n"
      "extent     x -64000.00 to 8.00 m, y -2.25 to 33.00 m\n"
      "error      xi up to 2\n"
      "path       3 poses\n"
      "method     tolerance 0.5 m, depth 2, cells of 0.25 m by 0.516 deg, up to 30 landmarks per scan\n"
      "mode       a sensor may change it\n"
      "datum      latitude 59.3325000, longitude 18.0649000, height 28.50 m, x axis towards 90.000 deg\n");
}

TEST(MapInfo, LeavesOutWhatAMapDoesNotSay) {
  firmware::MapFile map = tests::sample_map();
  map.about.created_utc_s = 0;
  map.about.datum.reset();
  const std::string text = map_info_text(map, 335);
  EXPECT_EQ(text.find("since"), std::string::npos);
  EXPECT_NE(text.find("datum      none\n"), std::string::npos);
}

TEST(MapInfo, RowsAreThoseOfMapCsv) {
  const std::vector<MapRow> rows = map_rows(tests::sample_map());
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_EQ(format_map(std::span(rows).subspan(3, 1)),
            "id,x_m,y_m,xi,sightings,first_scan,last_scan,sigma_m,diameter_m\n5,-64000.000000,33.000000,1,2,"
            "4,39,2.5000,0.882\n");
}

}  // namespace
}  // namespace slamsensor::tools
