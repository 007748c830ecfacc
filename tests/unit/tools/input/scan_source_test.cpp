#include "tools/input/scan_source.hpp"

#include "tests/unit/tools/input/pcd_writer.hpp"
#include "tests/unit/tools/input/temp_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

using std::filesystem::path;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kCloud = pcd_xyz(1, "ascii", "1 2 0.5\n");
const std::string kReadings = "pan_deg,tilt_deg,range_m\n0,0,1\n";
const std::string kMap = "id,x_m,y_m\n1,0,0\n";

std::string open_error(const std::vector<path>& inputs, const firmware::Config& config = {}) {
  const auto source = open_scans(inputs, config);
  return source ? "" : source.error().message;
}

std::vector<std::int64_t> numbers_of(const std::vector<path>& inputs, const firmware::Config& config = {}) {
  const auto source = open_scans(inputs, config);
  EXPECT_TRUE(source) << source.error().message;
  std::vector<std::int64_t> numbers;
  for (auto scan = (*source)->next(); scan && *scan; scan = (*source)->next()) {
    numbers.push_back((*scan)->number);
  }
  EXPECT_EQ(numbers.size(), (*source)->count());
  return numbers;
}

TEST(CsvKind, IsFoundFromTheHeader) {
  EXPECT_EQ(csv_kind("# c\r\n\r\n pan_deg,tilt_deg,range_m\r\n"), CsvKind::Readings);
  EXPECT_EQ(csv_kind("range_m,pan_deg\n"), CsvKind::Readings) << "the reader then says what is missing";
  EXPECT_EQ(csv_kind("\xEF\xBB\xBFscan,x_m,y_m"), CsvKind::Landmarks);
  EXPECT_EQ(csv_kind(kMap), CsvKind::Map);
  EXPECT_EQ(csv_kind("x,y\n"), CsvKind::Other);
  EXPECT_EQ(csv_kind("# only a comment"), CsvKind::Empty);
  EXPECT_EQ(csv_kind("\xEF\xBB\xBF\"pan_deg\";\"tilt_deg\";\"range_m\"\r\n"), CsvKind::Readings);
  EXPECT_EQ(csv_kind("sep=;\r\nscan;x_m;y_m\r\n"), CsvKind::Landmarks);
  EXPECT_EQ(csv_kind("id\tx_m\ty_m\n"), CsvKind::Map);
}

TEST(ScanSource, OrdersAFolderByNumberNotByName) {
  const TempFolder folder;
  for (const char* name :
       {"s_10.pcd", "s_9.PCD", "t_002.csv", "notes.txt", ".s_1.pcd", "reference.csv", "x.tum"}) {
    const std::string text = std::string(name) == "reference.csv" ? kMap : kCloud;
    folder.write(name, std::string(name) == "t_002.csv" ? kReadings : text);
  }
  folder.write("sub/s_5.pcd", kCloud);
  EXPECT_THAT(numbers_of({folder.path()}), ElementsAre(2, 9, 10));
}

TEST(ScanSource, NamesEveryEntryOfAFolderThatItDoesNotRead) {
  const TempFolder folder;
  folder.write("s_1.pcd", kCloud);
  folder.write("s_2.xyz", "1 2 3");
  folder.write("s_3.csv", "x,y,z\n1,2,3\n");
  folder.write("s_4.csv", "");
  folder.write("s_5.csv", std::string("\xFF\xFEp\0a\0n\0", 8));
  folder.write("drive.lcm", "");
  folder.write("sub/s_6.pcd", kCloud);
  std::filesystem::create_symlink(folder.path() / "gone", folder.path() / "s_7.pcd");
  folder.write("truth.tum", "");
  folder.write("map.csv", kMap);
  folder.write(".s_8.pcd", kCloud);
  folder.write("ReadMe.txt", "");
  const auto source = open_scans(std::vector<path>{folder.path()}, {});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->count(), 1U);
  std::vector<std::string> missed, companions;
  for (const NotRead& entry : (*source)->not_read()) {
    EXPECT_FALSE(entry.reason.empty());
    (entry.kind == NotReadKind::Missed ? missed : companions).push_back(entry.path.filename().string());
    if (entry.path.filename() == "s_5.csv") {
      EXPECT_THAT(entry.reason, AllOf(HasSubstr("UTF-16"), testing::Not(HasSubstr("s_5.csv"))));
    }
  }
  EXPECT_THAT(missed, ElementsAre("drive.lcm", "s_2.xyz", "s_3.csv", "s_4.csv", "s_5.csv", "s_7.pcd", "sub"));
  EXPECT_THAT(companions, ElementsAre(".s_8.pcd", "ReadMe.txt", "map.csv", "truth.tum"));
}

TEST(ScanSource, StampsInNamesOrderTheScansAndAreTheirTimes) {
  const TempFolder folder;
  folder.write("1600000001.900000000.pcd", kCloud);
  folder.write("1600000001.095000000.pcd", kCloud);
  folder.write("1600000000.500000000.pcd", kCloud);
  auto source = open_scans(std::vector<path>{folder.path()}, {}).value();
  EXPECT_THAT(source->order(), HasSubstr("by the time stamp"));
  for (const std::int64_t time_ms : {1'600'000'000'500, 1'600'000'001'095, 1'600'000'001'900}) {
    EXPECT_EQ(source->next().value()->time, std::chrono::milliseconds(time_ms));
  }
}

TEST(ScanSource, GivesScanlinesOfCloudsAndReadingsAndLandmarksOfLists) {
  const TempFolder folder;
  const std::vector<path> inputs{folder.write("c_3.pcd", pcd_xyz(2, "ascii", "1 2 0.5\nnan nan nan\n")),
                                 folder.write("trees.csv", "scan,x_m,y_m\n7,1,2\n1,3,4\n7,5,6\n"),
                                 folder.write("r_2.csv", kReadings)};
  auto source = open_scans(inputs, {}).value();
  EXPECT_EQ(source->count(), 4U);
  const InputScan list = source->next().value().value();
  EXPECT_TRUE(list.is_landmark_list);
  EXPECT_EQ(list.name, inputs[1].string() + ": scan 1");
  ASSERT_EQ(list.landmarks.size(), 1U);
  const InputScan readings = source->next().value().value();
  EXPECT_FALSE(readings.is_landmark_list);
  ASSERT_EQ(readings.scanlines.size(), 1U);
  EXPECT_EQ(readings.name, inputs[2].string());
  const InputScan cloud = source->next().value().value();
  ASSERT_EQ(cloud.scanlines.size(), 1U);
  EXPECT_EQ(cloud.scanlines[0].size(), 701U);
  EXPECT_EQ(cloud.points_skipped, 1U);
  EXPECT_EQ(source->next().value().value().landmarks.size(), 2U);
  EXPECT_FALSE(source->next().value());
  EXPECT_FALSE(source->next().value());
}

TEST(ScanSource, RefusesAScanTwiceAndNamesBoth) {
  const TempFolder folder;
  const path a = folder.write("a/s_1.pcd", kCloud);
  const path list = folder.write("trees.csv", "scan,x_m,y_m\n1,1,2\n");
  EXPECT_THAT(open_error({list, a}), AllOf(HasSubstr("trees.csv: scan 1"), HasSubstr(a.string())));
  EXPECT_THAT(open_error({list, list}), HasSubstr("trees.csv: scan 1"));
  EXPECT_THAT(open_error({a, a.parent_path()}), HasSubstr("has the same name, as has " + a.string()));
}

TEST(ScanSource, AFileNeedsNoNumber) {
  const TempFolder folder;
  const path cloud = folder.write("cloud.pcd", kCloud);
  const path huge = folder.write("s_9000000001.pcd", kCloud);
  EXPECT_THAT(numbers_of({cloud}), ElementsAre(0));
  EXPECT_THAT(numbers_of({folder.write("s_1.pcd", kCloud), cloud, huge}), ElementsAre(0, 1, 2));
  EXPECT_THAT(open_error({huge}), HasSubstr("too large"));
}

TEST(ScanSource, RefusesInputsThatHoldNoScans) {
  const TempFolder folder;
  EXPECT_THAT(open_error({}), HasSubstr("no input"));
  EXPECT_THAT(open_error({folder.path()}), HasSubstr("holds no scans"));
  EXPECT_THAT(open_error({folder.path() / "none.pcd"}), HasSubstr("does not exist"));
  EXPECT_THAT(open_error({folder.write("x.tum", "")}), HasSubstr("neither .pcd nor .csv"));
  EXPECT_THAT(open_error({folder.write("map.csv", kMap)}), HasSubstr("is a map"));
  EXPECT_THAT(open_error({folder.path()}), HasSubstr("holds no scans"));
  EXPECT_THAT(open_error({folder.write("o.csv", "a,b\n")}), HasSubstr("names no columns"));
  folder.write("s_1.csv", "");
  EXPECT_THAT(open_error({folder.path()}), HasSubstr("s_1.csv: is empty"));
}

TEST(ScanSource, GoesOnAfterAScanThatIsRefused) {
  const TempFolder folder;
  folder.write("s_1.pcd", kCloud);
  folder.write("s_2.pcd", "garbage");
  folder.write("s_3.pcd", kCloud);
  auto source = open_scans(std::vector<path>{folder.path()}, {}).value();
  EXPECT_EQ(source->next().value()->number, 1);
  EXPECT_THAT(source->next().error().message, HasSubstr("s_2.pcd:1"));
  EXPECT_EQ(source->next().value()->number, 3);
  std::filesystem::remove(folder.path() / "s_3.pcd");
  auto again = open_scans(std::vector<path>{folder.path() / "s_1.pcd"}, {}).value();
  std::filesystem::remove(folder.path() / "s_1.pcd");
  EXPECT_THAT(again->next().error().message, HasSubstr("does not exist"));
}

TEST(ScanSource, GoesOnAfterALandmarkListThatIsRefused) {
  const TempFolder folder;
  folder.write("s_1.pcd", kCloud);
  folder.write("bad.csv", "scan,x_m,y_m\n7,1,2\n7,far,3\n");
  folder.write("trees.csv", "scan,x_m,y_m\n3,1,2\n");
  auto source = open_scans(std::vector<path>{folder.path()}, {}).value();
  EXPECT_EQ(source->count(), 3U);
  EXPECT_THAT(source->next().error().message, HasSubstr("bad.csv:3"));
  EXPECT_EQ(source->next().value()->number, 1);
  EXPECT_EQ(source->next().value()->number, 3);
  EXPECT_FALSE(source->next().value());
}

TEST(ScanSource, TheFixesOfAnEarlierRunAreNoScans) {
  const TempFolder folder;
  folder.write("s_1.pcd", kCloud);
  const path fixes = folder.write("fixes.csv", "scan,status,reason,x_m,y_m\n1,fix,,0,0\n");
  const auto source = open_scans(std::vector<path>{folder.path()}, {}).value();
  EXPECT_EQ(source->count(), 1U);
  ASSERT_EQ(source->not_read().size(), 1U);
  EXPECT_EQ(source->not_read()[0].kind, NotReadKind::Companion);
  EXPECT_THAT(source->not_read()[0].reason, HasSubstr("fixes of an earlier run"));
  EXPECT_THAT(open_error({fixes}), HasSubstr("fixes of an earlier run"));
}

TEST(ScanSource, AppliesTheConfigToLists) {
  const TempFolder folder;
  const path list = folder.write("trees.csv", "scan,x_m,y_m\n0,1,0\n0,2,0\n0,400,0\n");
  firmware::Config config;
  config.landmark_list.order = firmware::LandmarkOrder::Nearest;
  auto source = open_scans(std::vector<path>{list}, config).value();
  EXPECT_EQ(source->next().value()->landmarks.size(), 2U);
  config.landmark_list.order = firmware::LandmarkOrder::Diameter;
  EXPECT_THAT(open_error({list}, config), HasSubstr("no column diameter_m"));
}

TEST(ScanSource, RefusesStepsThatAreNotPositive) {
  firmware::Config config;
  config.core.detection.bearing_step_rad = 0.0;
  EXPECT_THAT(open_error({"x"}, config), HasSubstr("detection.bearing_step_rad is 0"));
  config = {};
  config.point_cloud.tilt_step_rad = std::nan("");
  EXPECT_THAT(open_error({"x"}, config), HasSubstr("point_cloud.tilt_step_rad is nan"));
}

// The recorded sets, where they are installed (their licences keep them out of the project).
class RecordedScans : public testing::Test {
 protected:
  void SetUp() override {
    const char* const data = std::getenv("SLAMSENSOR_DATA");
    data_ = data != nullptr ? data : "../shared/data";
    if (!std::filesystem::is_directory(data_)) {
      GTEST_SKIP() << "no recorded data at " << data_ << "; set SLAMSENSOR_DATA to run this test";
    }
  }
  path data_;
};

TEST_F(RecordedScans, CampusCloudsHaveAScanlinePerRingAndLookAllAround) {
  auto source = open_scans(std::vector<path>{data_ / "campus_trees"}, {});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->count(), 56U);
  std::int64_t before = 0;
  for (;;) {
    const auto scan = (*source)->next();
    ASSERT_TRUE(scan) << scan.error().message;
    if (!*scan) {
      break;
    }
    EXPECT_GT((*scan)->number, before);
    before = (*scan)->number;
    EXPECT_LE((*scan)->scanlines.size(), 32U);
    EXPECT_GE((*scan)->scanlines.size(), 16U);
    for (const auto& scanline : (*scan)->scanlines) {
      EXPECT_GE(scanline.size(), 701U);
    }
  }
  EXPECT_EQ(before, 99);
}

TEST_F(RecordedScans, LandmarkListsOpen) {
  EXPECT_EQ(numbers_of({data_ / "oxford_forest"}).size(), 1200U);
  EXPECT_EQ(numbers_of({data_ / "victoria_park"}).size(), 3600U);
}

}  // namespace
}  // namespace slamsensor::tools
