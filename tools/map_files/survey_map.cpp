#include "tools/map_files/survey_map.hpp"

#include "core/graph/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <unordered_map>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr double kOnePlace_m = 0.01;
constexpr std::int64_t kIdMax = std::int64_t{1} << 30;

/// The middle of the points, their longitudes taken about the first, so that 180 deg is no wall.
firmware::Datum middle_of(const std::vector<SurveyPoint>& points) {
  const double turn = 360.0;
  const double first_deg = points.front().place.longitude_deg;
  double latitude_deg = 0.0;
  double beside_deg = 0.0;
  for (const SurveyPoint& point : points) {
    latitude_deg += point.place.latitude_deg;
    beside_deg += std::remainder(point.place.longitude_deg - first_deg, turn);
  }
  const auto count = static_cast<double>(points.size());
  const auto rounded = [](double degrees) { return std::round(degrees * 1e7) / 1e7; };
  firmware::Datum datum;  // x towards east
  datum.latitude_deg = rounded(latitude_deg / count);
  datum.longitude_deg = rounded(std::remainder(first_deg + beside_deg / count, turn));
  return datum;
}

/// Finds a point that stands where another one does already.
class Places {
 public:
  bool is_new(const core::Point2& point) {
    const auto cell_x = std::llround(std::floor(point.x() / kOnePlace_m));
    const auto cell_y = std::llround(std::floor(point.y() / kOnePlace_m));
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto found = points_.find({cell_x + dx, cell_y + dy});
        if (found != points_.end() && (found->second - point).norm() < kOnePlace_m) {
          return false;
        }
      }
    }
    points_.try_emplace({cell_x, cell_y}, point);
    return true;
  }

 private:
  struct Hash {
    std::size_t operator()(const std::pair<std::int64_t, std::int64_t>& cell) const {
      const std::uint64_t mixed = static_cast<std::uint64_t>(cell.first) * 0x9E3779B97F4A7C15U;
      return std::hash<std::uint64_t>()(mixed ^ static_cast<std::uint64_t>(cell.second));
    }
  };
  std::unordered_map<std::pair<std::int64_t, std::int64_t>, core::Point2, Hash> points_;
};

bool have_own_ids(const std::vector<SurveyPoint>& points) {
  std::set<std::int64_t> ids;
  return std::all_of(points.begin(), points.end(), [&](const SurveyPoint& point) {
    return point.id && *point.id <= kIdMax && ids.insert(*point.id).second;
  });
}

std::string out_of_reach_text(const core::Point2& point_W, SurveyFrame frame, const core::Point2& first_m) {
  std::string text = "it stands at x " + shown(point_W.x()) + " m, y " + shown(point_W.y()) +
                     " m; a map reaches " + shown(core::kLatticeReach_m) + " m from its origin: ";
  return text + (frame == SurveyFrame::LocalMetres
                     ? "name an origin near the survey, such as --origin " + shown(first_m.x()) + ' ' +
                           shown(first_m.y())
                     : std::string("name a datum near the survey with --datum, or take the point out"));
}

}  // namespace

tl::expected<SurveyMap, InputError> map_of_survey(const Survey& survey, std::string_view name,
                                                  const SurveyMapWishes& wishes) {
  SurveyMap made;
  const bool is_local = survey.frame == SurveyFrame::LocalMetres;
  firmware::MapAbout& about = made.map.about;
  about.datum = wishes.datum ? wishes.datum : survey.datum;
  about.frozen = wishes.frozen;
  if (!is_local && !about.datum) {
    about.datum = middle_of(survey.points);
    made.is_datum_of_points = true;
  }
  std::optional<MapEarth> earth;
  if (!is_local) {
    earth.emplace(*about.datum);
  }
  made.are_ids_kept = have_own_ids(survey.points);
  Places places;
  std::vector<std::pair<std::uint32_t, core::Point2>> landmarks;
  for (const SurveyPoint& point : survey.points) {
    const core::Point2 point_W = is_local ? point.local_m - wishes.origin_m : earth->in_map(point.place);
    if (!core::on_lattice(point_W)) {
      return refuse_line(name, point.line,
                         out_of_reach_text(point_W, survey.frame, survey.points[0].local_m));
    }
    if (!places.is_new(point_W)) {
      ++made.at_one_place;
      continue;
    }
    const auto next = static_cast<std::uint32_t>(landmarks.size());
    landmarks.emplace_back(made.are_ids_kept ? static_cast<std::uint32_t>(*point.id) : next, point_W);
  }
  if (landmarks.size() < 3) {
    return refuse(name, "holds " + std::to_string(landmarks.size()) +
                            " landmarks at different places; a place is found from three or more");
  }
  std::sort(landmarks.begin(), landmarks.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [id, point_W] : landmarks) {
    core::MapLandmark landmark;
    landmark.id = id;
    landmark.sightings = landmark.chances = 1;
    made.map.landmarks.push_back(landmark);
    made.map.positions_W.push_back(point_W);
  }
  made.map.numbers.next_id = landmarks.back().first + 1;
  made.map.numbers.scans = 1;
  return made;
}

}  // namespace slamsensor::tools
