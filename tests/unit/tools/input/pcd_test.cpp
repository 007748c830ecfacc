#include "tools/input/pcd.hpp"

#include "tests/unit/tools/input/pcd_writer.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

std::string error_of(const std::string& bytes) {
  const auto cloud = parse_pcd(bytes, "c.pcd");
  return cloud ? "" : cloud.error().message;
}

PointCloud cloud_of(const std::string& bytes) {
  auto cloud = parse_pcd(bytes, "c.pcd");
  EXPECT_TRUE(cloud) << cloud.error().message;
  return cloud ? *cloud : PointCloud();
}

std::string xyz_bytes(std::initializer_list<float> values) {
  std::string bytes;
  for (const float value : values) {
    append_value(bytes, value);
  }
  return bytes;
}

TEST(Pcd, ReadsAscii) {
  const PointCloud cloud =
      cloud_of(pcd_file("z ring _ x y", "4 2 1 4 4", "F U U F F", "1 1 2 1 1", 3, "ascii",
                        "3 7 0 0 1 2\n\nnan 0 0 0 nan nan\r\n -6 8 9 9 4.5e0 +5 \n\n"));
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_TRUE(cloud.has_ring);
  EXPECT_EQ(cloud.points_skipped, 1U);
  EXPECT_EQ(cloud.points[0].position_L, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(cloud.points[0].ring, 7U);
  EXPECT_EQ(cloud.points[1].position_L, Eigen::Vector3d(4.5, 5, -6));
}

TEST(Pcd, RefusesAsciiThatDoesNotFitItsHeader) {
  EXPECT_THAT(error_of(pcd_xyz(2, "ascii", "1 2 3\n")), HasSubstr("1 of the 2 points"));
  EXPECT_THAT(error_of(pcd_xyz(1, "ascii", "1 2\n")),
              AllOf(HasSubstr("c.pcd:12"), HasSubstr("2 of the 3 values")));
  EXPECT_THAT(error_of(pcd_xyz(1, "ascii", "1 2 3 4\n")), HasSubstr("more than the 3 values"));
  EXPECT_THAT(error_of(pcd_xyz(1, "ascii", "1 2 3x\n")), HasSubstr("value 3 is '3x'"));
  EXPECT_THAT(error_of(pcd_xyz(1, "ascii", "1 inf 3\n")), AllOf(HasSubstr("c.pcd:12"), HasSubstr("inf")));
  EXPECT_THAT(error_of(pcd_xyz(1, "ascii", "1 10001 3\n")), HasSubstr("beyond 10000 m"));
  EXPECT_THAT(error_of(pcd_xyz(20'000'000, "ascii", "1 2 3\n")), HasSubstr("1 of the 20000000"));
}

TEST(Pcd, ReadsEveryTypeOfBinaryField) {
  std::string body;
  append_value<std::int8_t>(body, -1);
  append_value<std::uint16_t>(body, 65000 / 10);
  append_value<std::int64_t>(body, -3);
  append_value<std::uint32_t>(body, 4);
  const PointCloud whole =
      cloud_of(pcd_file("x y z ring", "1 2 8 4", "I U I U", "1 1 1 1", 1, "binary", body));
  ASSERT_EQ(whole.points.size(), 1U);
  EXPECT_EQ(whole.points[0].position_L, Eigen::Vector3d(-1, 6500, -3));
  EXPECT_EQ(whole.points[0].ring, 4U);

  body.clear();
  append_value<double>(body, 0.1);
  append_value<std::int16_t>(body, -300);
  append_value<std::uint8_t>(body, 200);
  append_value<float>(body, 12.0F);
  const PointCloud mixed =
      cloud_of(pcd_file("x y z ring", "8 2 1 4", "F I U F", "1 1 1 1", 1, "binary", body));
  ASSERT_EQ(mixed.points.size(), 1U);
  EXPECT_EQ(mixed.points[0].position_L, Eigen::Vector3d(0.1, -300, 200));
  EXPECT_EQ(mixed.points[0].ring, 12U);
}

TEST(Pcd, SkipsAndCountsPointsWithoutDirection) {
  const PointCloud cloud =
      cloud_of(pcd_xyz(4, "binary", xyz_bytes({kNan, 1, 1, 0, 0, 0, 1, 2, 3, 1, 2, kNan})));
  EXPECT_EQ(cloud.points.size(), 1U);
  EXPECT_EQ(cloud.points_skipped, 3U);
  EXPECT_FALSE(cloud.has_ring);
}

TEST(Pcd, RefusesBinaryThatDoesNotFitItsHeader) {
  const std::string two = xyz_bytes({1, 2, 3, 4, 5, 6});
  EXPECT_THAT(error_of(pcd_xyz(3, "binary", two)), AllOf(HasSubstr("3 points of 12 bytes need 36 bytes"),
                                                         HasSubstr("24 follow"), HasSubstr("cut short")));
  EXPECT_THAT(error_of(pcd_xyz(20'000'000, "binary", two)), HasSubstr("need 240000000 bytes"));
}

TEST(Pcd, RefusesAbsurdValuesAndSaysWhere) {
  const std::string bytes = pcd_xyz(2, "binary", xyz_bytes({1, 2, 3, 4, kInf, 6}));
  EXPECT_THAT(error_of(bytes), HasSubstr("point 1 at byte " + std::to_string(bytes.size() - 12)));
  EXPECT_THAT(error_of(pcd_xyz(1, "binary", xyz_bytes({0, 0, -10001}))), HasSubstr("(0, 0, -10001)"));
  EXPECT_THAT(error_of(pcd_xyz(1, "binary", xyz_bytes({3e38F, 3e38F, 3e38F}))), HasSubstr("beyond 10000 m"));
  const auto ring_error = [](const std::string& ring) {
    return error_of(pcd_file("x y z ring", "4 4 4 4", "F F F F", "1 1 1 1", 1, "ascii", "1 2 3 " + ring));
  };
  for (const char* ring : {"-1", "1.5", "65536", "nan", "inf"}) {
    EXPECT_THAT(ring_error(ring), AllOf(HasSubstr("ring"), HasSubstr("0 to 65535"))) << ring;
  }
  EXPECT_EQ(ring_error("65535"), "");
}

TEST(Pcd, ReadsCompressedWithPaddingPackedOrNot) {
  std::string fields;
  for (const float x : {1.0F, 2.0F}) append_value(fields, x);
  for (const std::uint16_t ring : {std::uint16_t{3}, std::uint16_t{4}}) append_value(fields, ring);
  std::string rest;
  for (const float value : {5.0F, 6.0F, 7.0F, 8.0F}) append_value(rest, value);
  const std::string unpadded = fields + rest;
  const std::string padded = fields + std::string(6, 'p') + rest;
  for (const std::string& packed : {unpadded, padded}) {
    const PointCloud cloud = cloud_of(pcd_file("x ring _ y z", "4 2 1 4 4", "F U U F F", "1 1 3 1 1", 2,
                                               "binary_compressed", compressed_body(packed)));
    ASSERT_EQ(cloud.points.size(), 2U);
    EXPECT_EQ(cloud.points[0].position_L, Eigen::Vector3d(1, 5, 7));
    EXPECT_EQ(cloud.points[1].position_L, Eigen::Vector3d(2, 6, 8));
    EXPECT_EQ(cloud.points[1].ring, 4U);
  }
}

TEST(Pcd, RefusesCompressedThatDoesNotFit) {
  const std::string fields = xyz_bytes({1, 2, 3, 4, 5, 6});
  const std::string body = compressed_body(fields);
  EXPECT_THAT(error_of(pcd_xyz(2, "binary_compressed", "1234567")), HasSubstr("ends in the sizes"));
  EXPECT_THAT(error_of(pcd_xyz(2, "binary_compressed", body.substr(0, body.size() - 1))),
              AllOf(HasSubstr("bytes of packed data"), HasSubstr("cut short")));
  EXPECT_THAT(error_of(pcd_xyz(3, "binary_compressed", body)),
              HasSubstr("declares 24 bytes of unpacked data"));
  std::string bent = body;
  bent[8] = '\x3F';  // the first token becomes a copy from before the start
  EXPECT_THAT(error_of(pcd_xyz(2, "binary_compressed", bent)), HasSubstr("is not LZF of 24 bytes"));
  std::string bomb;
  append_value<std::uint32_t>(bomb, 2);
  append_value<std::uint32_t>(bomb, 240'000'000);
  EXPECT_THAT(error_of(pcd_xyz(20'000'000, "binary_compressed", bomb + "ab")), HasSubstr("is not LZF"));
}

TEST(Pcd, AsciiBinaryAndCompressedGiveTheSameCloud) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> lattice(-800, 800);  // eighths, exact as text and as float
    std::string ascii, points, columns[3];
    for (int i = 0; i < 300; ++i) {
      for (std::string& column : columns) {
        const double value = lattice(random) / 8.0;
        ascii += std::to_string(value) + " ";
        append_value(points, static_cast<float>(value));
        append_value(column, static_cast<float>(value));
      }
      ascii += "\n";
    }
    const PointCloud a = cloud_of(pcd_xyz(300, "ascii", ascii));
    const PointCloud b = cloud_of(pcd_xyz(300, "binary", points));
    const PointCloud c =
        cloud_of(pcd_xyz(300, "binary_compressed", compressed_body(columns[0] + columns[1] + columns[2])));
    ASSERT_EQ(a.points.size() + a.points_skipped, 300U);
    ASSERT_EQ(b.points.size(), a.points.size());
    ASSERT_EQ(c.points.size(), a.points.size());
    for (std::size_t i = 0; i < a.points.size(); ++i) {
      EXPECT_EQ(a.points[i].position_L, b.points[i].position_L);
      EXPECT_EQ(a.points[i].position_L, c.points[i].position_L);
    }
  }
}

TEST(Pcd, ReadsWhatIsDeclaredWhateverTheWriterLeftBehindIt) {
  const std::string points = xyz_bytes({1, 2, 3, 4, 5, 6});
  const std::string columns = xyz_bytes({1, 4, 2, 5, 3, 6});
  const std::string page(4096 - points.size(), '\0');
  for (const std::string& left : {std::string("\n"), page, std::string("\r\n"), page + "\n"}) {
    for (const std::string& bytes :
         {pcd_xyz(2, "binary", points + left), pcd_xyz(2, "ascii", "1 2 3\n4 5 6\n" + left),
          pcd_xyz(2, "binary_compressed", compressed_body(columns) + left)}) {
      const PointCloud cloud = cloud_of(bytes);
      ASSERT_EQ(cloud.points.size(), 2U);
      EXPECT_EQ(cloud.points[1].position_L, Eigen::Vector3d(4, 5, 6));
      EXPECT_EQ(cloud.remark, "");
    }
  }
}

TEST(Pcd, RemarksOnMoreThanIsDeclared) {
  const std::string points = xyz_bytes({1, 2, 3});
  for (const std::string& bytes :
       {pcd_xyz(1, "binary", points + points), pcd_xyz(1, "ascii", "1 2 3\n  4 5 6 7 8\n"),
        pcd_xyz(1, "binary_compressed", compressed_body(points) + std::string(12, 'x'))}) {
    const PointCloud cloud = cloud_of(bytes);
    EXPECT_EQ(cloud.points.size(), 1U);
    EXPECT_THAT(cloud.remark, AllOf(HasSubstr("c.pcd: 12 bytes follow"), HasSubstr("not read")));
  }
}

TEST(Pcd, PaddingWithoutBytesIsSkipped) {
  const std::string fields = "x _ y z _";
  const PointCloud ascii =
      cloud_of(pcd_file(fields, "4 1 4 4 1", "F U F F U", "1 0 1 1 0", 1, "ascii", "1 2 3\n"));
  const PointCloud binary = cloud_of(
      pcd_file(fields, "4 1 4 4 1", "F U F F U", "1 0 1 1 3", 1, "binary", xyz_bytes({1, 2, 3}) + "pad"));
  const PointCloud packed = cloud_of(pcd_file(fields, "4 1 4 4 1", "F U F F U", "1 0 1 1 0", 1,
                                              "binary_compressed", compressed_body(xyz_bytes({1, 2, 3}))));
  for (const PointCloud& cloud : {ascii, binary, packed}) {
    ASSERT_EQ(cloud.points.size(), 1U);
    EXPECT_EQ(cloud.points[0].position_L, Eigen::Vector3d(1, 2, 3));
  }
}

TEST(Pcd, ACloudWithoutAPointIsACloud) {
  std::string sizes;
  append_value<std::uint64_t>(sizes, 0);
  for (const auto& [data, body] : {std::pair("ascii", std::string()),
                                   {"ascii", "\n"},
                                   {"binary", ""},
                                   {"binary", std::string(4096, '\0')},
                                   {"binary_compressed", ""},
                                   {"binary_compressed", sizes}}) {
    const PointCloud cloud = cloud_of(pcd_xyz(0, data, body));
    EXPECT_TRUE(cloud.points.empty()) << data;
    EXPECT_EQ(cloud.remark, "") << data;
  }
  EXPECT_EQ(cloud_of(pcd_xyz(2, "ascii", "nan nan nan\n0 0 0\n")).points_skipped, 2U);
}

// A cloud as registration leaves it: the file's points are in the map, VIEWPOINT says where the sensor was.
TEST(Pcd, TakesThePointsIntoTheFrameOfTheSensor) {
  const Eigen::Isometry3d T_cloud_L = Eigen::Translation3d(410'000.5, -3.0, 12.25) *
                                      Eigen::AngleAxisd(2.0, Eigen::Vector3d(1, -2, 5).normalized());
  const Eigen::Quaterniond q(T_cloud_L.rotation());
  std::string text = pcd_file("x y z", "8 8 8", "F F F", "1 1 1", 4, "binary", "");
  const std::string none = "VIEWPOINT 0 0 0 1 0 0 0";
  std::ostringstream viewpoint;
  viewpoint.precision(17);
  viewpoint << "VIEWPOINT 410000.5 -3 12.25 " << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z();
  text.replace(text.find(none), none.size(), viewpoint.str());
  const std::vector<Eigen::Vector3d> positions_L{{5, 0, 0}, {-1, 7, 2.5}, {0, 0, 0}};
  for (const Eigen::Vector3d& p : positions_L) {
    for (const double coordinate : Eigen::Vector3d(T_cloud_L * p)) {
      append_value(text, coordinate);
    }
  }
  text += std::string(24, '\0');  // nothing came back, and the point was not moved with the others
  const PointCloud cloud = cloud_of(text);
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_EQ(cloud.points_skipped, 2U) << "a point at the sensor's own place came from nowhere";
  EXPECT_TRUE(cloud.points[0].position_L.isApprox(positions_L[0], 1e-9));
  EXPECT_TRUE(cloud.points[1].position_L.isApprox(positions_L[1], 1e-9));
}

constexpr double kNorthing_m = 6'094'000.5;

std::string at_northing(std::string file) {
  const std::string none = "VIEWPOINT 0 0 0 1 0 0 0";
  return file.replace(file.find(none), none.size(), "VIEWPOINT 0 6094000.5 0 1 0 0 0");
}

TEST(Pcd, NearPointsCountFarFromTheOriginOfTheirFrame) {
  std::string binary;
  for (const double coordinate : {0.25, kNorthing_m + 3.0, 0.5, 0.0, kNorthing_m, 0.0}) {
    append_value(binary, coordinate);
  }
  const std::string ascii = "0.25 6094003.5 0.5\n0 6094000.5 0\n";
  for (const auto& [data, body] : {std::pair("binary", binary), std::pair("ascii", ascii)}) {
    const PointCloud cloud =
        cloud_of(at_northing(pcd_file("x y z", "8 8 8", "F F F", "1 1 1", 2, data, body)));
    ASSERT_EQ(cloud.points.size(), 1U) << data;
    EXPECT_EQ(cloud.points_skipped, 1U) << data;
    EXPECT_TRUE(cloud.points[0].position_L.isApprox(Eigen::Vector3d(0.25, 3.0, 0.5), 1e-9)) << data;
    EXPECT_EQ(cloud.remark, "") << data;
  }
}

TEST(Pcd, SaysWhereFloatsAreTooCoarseForTheirPlace) {
  std::string body;
  for (const double coordinate : {0.25, kNorthing_m + 3.0, 0.5, 0.0, kNorthing_m, 0.0}) {
    append_value(body, static_cast<float>(coordinate));
  }
  const PointCloud cloud =
      cloud_of(at_northing(pcd_file("x y z", "4 4 4", "F F F", "1 1 1", 2, "binary", body)));
  EXPECT_EQ(cloud.points.size(), 1U);
  EXPECT_EQ(cloud.points_skipped, 1U);
  EXPECT_THAT(cloud.remark, AllOf(HasSubstr("0.5 m apart"), HasSubstr("SIZE 8")));
}

TEST(Pcd, AnOrganisedCloudIsMovedToo) {
  std::string text = pcd_xyz(4, "ascii", "2 3 4\nnan nan nan\n1 4 4\n1 3 6\n");
  for (const auto& [from, to] : {std::pair("WIDTH 4", "WIDTH 2"),
                                 {"HEIGHT 1", "HEIGHT 2"},
                                 {"VIEWPOINT 0 0 0 1 0 0 0", "VIEWPOINT 1 3 4 0 0 0 1"}}) {
    text.replace(text.find(from), std::string(from).size(), to);
  }
  const PointCloud cloud = cloud_of(text);
  ASSERT_EQ(cloud.points.size(), 3U);
  EXPECT_EQ(cloud.points[0].position_L, Eigen::Vector3d(-1, 0, 0)) << "turned by half a turn about z";
  EXPECT_EQ(cloud.points[1].position_L, Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(cloud.points[2].position_L, Eigen::Vector3d(0, 0, 2));
}

TEST(Pcd, EveryTruncationIsRefused) {
  const std::string whole = pcd_xyz(2, "binary", xyz_bytes({1, 2, 3, 4, 5, 6}));
  const std::string packed = pcd_xyz(2, "binary_compressed", compressed_body(xyz_bytes({1, 2, 3, 4, 5, 6})));
  for (const std::string& bytes : {whole, packed}) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_NE(error_of(bytes.substr(0, size)), "") << size;
    }
  }
}

}  // namespace
}  // namespace slamsensor::tools
