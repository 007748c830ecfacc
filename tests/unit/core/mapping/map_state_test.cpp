#include "core/mapping/map_state.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

namespace slamsensor::core {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Capacities small_capacities() {
  Capacities c;
  c.map_landmarks = 6;
  c.path_poses = 3;
  return c;
}

/// A sound map that a test may break: four landmarks of the first scan, one of the second.
struct Parts {
  std::vector<MapLandmark> landmarks;
  std::vector<Point2> positions_W{{1, 0}, {0, 2}, {-3, 0}, {0, -4}, {5, 5}};
  std::vector<PathPose> path{{0, 0, {}}, {2, 1, {0.5, 0.25, -1.0}}};
  std::uint32_t next_id = 9;
  std::uint32_t scans = 3;

  Parts() {
    for (const std::uint32_t id : {0U, 1U, 2U, 5U, 8U}) {
      MapLandmark landmark;
      landmark.id = id;
      landmarks.push_back(landmark);
    }
    landmarks[4].xi = 1;
    landmarks[4].parents = {0, 2, 5};
    landmarks[4].first_scan = landmarks[4].last_scan = 2;
  }
  [[nodiscard]] MapState state() const { return {landmarks, positions_W, path, 7, 0, 0, next_id, scans}; }
};

struct Broken {
  std::string name;
  std::function<void(Parts&)> damage;
  MapFlaw flaw;
  std::size_t index;
};
void PrintTo(const Broken& broken, std::ostream* out) {
  *out << broken.name;
}

class MapStateFlaw : public testing::TestWithParam<Broken> {};

TEST_P(MapStateFlaw, IsFoundWhereItIs) {
  Parts parts;
  ASSERT_TRUE(check_map(parts.state(), small_capacities()).ok());
  GetParam().damage(parts);
  const MapCheck check = check_map(parts.state(), small_capacities());
  EXPECT_EQ(check.flaw, GetParam().flaw);
  EXPECT_EQ(check.index, GetParam().index);
}

std::vector<Broken> all_broken() {
  using enum MapFlaw;
  return {
      {"TwoLandmarks", [](Parts& p) { p.landmarks.resize(2); }, TooFewLandmarks, 2},
      {"SevenLandmarks", [](Parts& p) { p.landmarks.resize(7); }, TooManyLandmarks, 7},
      {"FourPoses", [](Parts& p) { p.path.resize(4); }, TooManyPoses, 4},
      {"APositionMissing", [](Parts& p) { p.positions_W.pop_back(); }, PositionCount, 4},
      {"IdsTwice", [](Parts& p) { p.landmarks[3].id = 2; }, IdOrder, 3},
      {"IdsUnsorted", [](Parts& p) { p.landmarks[1].id = 4; }, IdOrder, 2},
      {"IdToCome", [](Parts& p) { p.next_id = 8; }, NextId, 4},
      {"PositionNan", [](Parts& p) { p.positions_W[2].y() = kNan; }, Position, 2},
      {"PositionFar", [](Parts& p) { p.positions_W[0].x() = -65'001.0; }, Position, 0},
      {"OriginWithParents",
       [](Parts& p) {
         p.landmarks[1].parents = {0, 2, 5};
       },
       Parents, 1},
      {"Orphan", [](Parts& p) { p.landmarks[4].parents = MapLandmark{}.parents; }, Parents, 4},
      {"OwnParent", [](Parts& p) { p.landmarks[4].parents[1] = 8; }, Parents, 4},
      {"ParentTwice",
       [](Parts& p) {
         p.landmarks[4].parents = {0, 2, 2};
       },
       Parents, 4},
      {"ParentToCome", [](Parts& p) { p.landmarks[4].parents[2] = 9; }, Parents, 4},
      {"ParentAsFar",
       [](Parts& p) {
         p.landmarks[3].xi = 1;
         p.landmarks[3].parents = {0, 1, 2};
       },
       ParentXi, 4},
      {"NoSighting", [](Parts& p) { p.landmarks[0].sightings = 0; }, Sightings, 0},
      {"NoChance", [](Parts& p) { p.landmarks[0].chances = 0; }, Sightings, 0},
      {"SigmaNegative", [](Parts& p) { p.landmarks[2].sigma_m = -0.1F; }, Sigma, 2},
      {"SigmaNan", [](Parts& p) { p.landmarks[3].sigma_m = std::numeric_limits<float>::quiet_NaN(); }, Sigma,
       3},
      {"LastBeforeFirst", [](Parts& p) { p.landmarks[1].first_scan = 1; }, LandmarkScans, 1},
      {"LastToCome", [](Parts& p) { p.landmarks[1].last_scan = 3; }, LandmarkScans, 1},
      {"PathUnsorted", [](Parts& p) { p.path[1].scan = 0; }, PathOrder, 1},
      {"PathToCome", [](Parts& p) { p.path[1].scan = 3; }, PathOrder, 1},
      {"PathNan", [](Parts& p) { p.path[0].pose_W.heading_rad = kNan; }, PathPose, 0},
  };
}

INSTANTIATE_TEST_SUITE_P(EachFlaw, MapStateFlaw, testing::ValuesIn(all_broken()),
                         [](const auto& broken) { return broken.param.name; });

TEST(MapState, AParentThatHasLeftTheMapIsNoFlaw) {
  Parts parts;
  parts.landmarks[4].parents = {0, 2, 7};
  EXPECT_TRUE(check_map(parts.state(), small_capacities()).ok());
}

TEST(MapState, AnEmptyPathIsNoFlaw) {
  Parts parts;
  parts.path.clear();
  EXPECT_TRUE(check_map(parts.state(), small_capacities()).ok());
}

}  // namespace
}  // namespace slamsensor::core
