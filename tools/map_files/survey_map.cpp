#include "tools/map_files/survey_map.hpp"

#include "core/graph/lattice.hpp"
#include "tools/input/csv.hpp"
#include "tools/input/places.hpp"
#include "tools/input/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

namespace slamsensor::tools {
namespace {

// National grids count up to ten thousand kilometres; what is out of the map's reach is refused later, with
// the remedy of an origin.
constexpr CsvRange kGrid{-1e8, 1e8, "m"};
constexpr CsvRange kDiameter{0.0, 100.0, "m"};
constexpr CsvRange kLatitude{-90.0, 90.0, "deg"};
constexpr CsvRange kLongitude{-180.0, 180.0, "deg"};

/// Two columns that say where a point is: x and y, or latitude and longitude.
struct NamePair {
  std::string_view first;
  std::string_view second;
  SurveyFrame frame;
};
constexpr std::array<NamePair, 3> kMetrePairs{{{"x_m", "y_m", SurveyFrame::LocalMetres},
                                               {"x", "y", SurveyFrame::LocalMetres},
                                               {"easting", "northing", SurveyFrame::LocalMetres}}};
constexpr std::array<std::string_view, 3> kLatitudeNames{"latitude_deg", "latitude", "lat"};
constexpr std::array<std::string_view, 5> kLongitudeNames{"longitude_deg", "longitude", "lon", "long", "lng"};

bool is_same_name(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char one, char other) { return lower(one) == lower(other); });
}

bool is_one_of(std::string_view name, std::span<const std::string_view> names) {
  return std::any_of(names.begin(), names.end(), [&](std::string_view n) { return is_same_name(n, name); });
}

/// The usual pairs, metres first, as the first line of the table spells them.
std::vector<NamePair> pairs_in(std::span<const std::string_view> header) {
  const auto spelled = [&](auto&& is_it) {
    const auto found = std::find_if(header.begin(), header.end(), is_it);
    return found == header.end() ? std::string_view() : *found;
  };
  std::vector<NamePair> pairs;
  const auto add = [&](std::string_view first, std::string_view second, SurveyFrame frame) {
    if (!first.empty() && !second.empty()) {
      pairs.push_back({first, second, frame});
    }
  };
  for (const NamePair& pair : kMetrePairs) {
    add(spelled([&](std::string_view name) { return is_same_name(name, pair.first); }),
        spelled([&](std::string_view name) { return is_same_name(name, pair.second); }), pair.frame);
  }
  add(spelled([](std::string_view name) { return is_one_of(name, kLatitudeNames); }),
      spelled([](std::string_view name) { return is_one_of(name, kLongitudeNames); }), SurveyFrame::Wgs84);
  return pairs;
}

/// What --columns names: degrees where both names say so, in either order, else metres; nothing when one
/// alone says degrees.
std::optional<NamePair> pair_of(const SurveyColumns& wanted) {
  const auto is_degrees = [](std::string_view name) {
    return is_one_of(name, kLatitudeNames) || is_one_of(name, kLongitudeNames);
  };
  if (is_one_of(wanted.x, kLatitudeNames) && is_one_of(wanted.y, kLongitudeNames)) {
    return NamePair{wanted.x, wanted.y, SurveyFrame::Wgs84};
  }
  if (is_one_of(wanted.x, kLongitudeNames) && is_one_of(wanted.y, kLatitudeNames)) {
    return NamePair{wanted.y, wanted.x, SurveyFrame::Wgs84};
  }
  return is_degrees(wanted.x) || is_degrees(wanted.y)
             ? std::nullopt
             : std::optional(NamePair{wanted.x, wanted.y, SurveyFrame::LocalMetres});
}

/// The columns that one reading of a table asks for; it outlives the reader.
class SurveyTable {
 public:
  SurveyTable(const SurveyColumns& wanted, std::string_view text) : wanted_(wanted) {
    LineReader lines(text);
    if (!wanted.x.empty()) {
      pairs_.push_back(pair_of(wanted).value_or(NamePair{}));
    } else if (const auto header = read_csv_header(lines)) {
      pairs_ = pairs_in(header->columns);
    }
    for (const NamePair& pair : pairs_) {
      columns_.push_back({pair.first, CsvNeed::Optional});
      columns_.push_back({pair.second, CsvNeed::Optional});
    }
    id_ = add("id");
    diameter_ = add("diameter_m");
    kind_ = add("kind");
    if (wanted.where) {
      where_ = add(wanted.where->first);
    }
  }

  tl::expected<Survey, InputError> read(std::string_view text, std::string_view name) {
    if (!wanted_.x.empty() && pairs_.front().first.empty()) {
      return refuse(name, "--columns " + wanted_.x + ' ' + wanted_.y +
                              ": one of them means degrees and the other does not; name a latitude and a "
                              "longitude, or two columns in metres");
    }
    auto csv = CsvReader::open(text, name, columns_, CsvOthers::Ignored);
    if (!csv) {
      return tl::unexpected(std::move(csv.error()));
    }
    if (auto found = choose_pair(*csv, name); !found) {
      return tl::unexpected(std::move(found.error()));
    }
    Survey survey;
    survey.frame = pairs_[pair_].frame;
    if (survey.frame == SurveyFrame::LocalMetres && pairs_.back().frame == SurveyFrame::Wgs84) {
      survey.degrees_not_read = std::string(pairs_.back().first) + ' ' + std::string(pairs_.back().second);
    }
    const auto take_row = [&]() -> tl::expected<void, InputError> {
      if (!is_wanted(*csv)) {
        ++survey.passed_over;
        return {};
      }
      return point(*csv, survey.frame).map([&](const SurveyPoint& p) { survey.points.push_back(p); });
    };
    if (auto taken = for_each_row(*csv, take_row); !taken) {
      return tl::unexpected(std::move(taken.error()));
    }
    if (survey.points.empty()) {
      return refuse(name, wanted_.where ? "no row has " + wanted_.where->first + " = " +
                                              wanted_.where->second + "; look at the values of that column"
                                        : std::string("holds no point; a row is needed for each"));
    }
    return survey;
  }

 private:
  std::size_t add(std::string_view column) {
    const auto known =
        std::find_if(columns_.begin(), columns_.end(), [&](const CsvColumn& c) { return c.name == column; });
    if (known == columns_.end()) {
      columns_.push_back({column, CsvNeed::Optional});
      return columns_.size() - 1;
    }
    return static_cast<std::size_t>(known - columns_.begin());
  }

  tl::expected<void, InputError> choose_pair(const CsvReader& csv, std::string_view name) {
    if (wanted_.where && !csv.has(where_)) {
      return refuse_line(name, csv.line(),
                         "there is no column " + in_quotes(wanted_.where->first) +
                             ", which --where asks for; name one of the first line");
    }
    for (pair_ = 0; pair_ < pairs_.size(); ++pair_) {
      if (csv.has(2 * pair_) && csv.has(2 * pair_ + 1)) {
        return {};
      }
    }
    if (!wanted_.x.empty()) {
      return refuse_line(name, csv.line(),
                         "there are no columns " + in_quotes(wanted_.x) + " and " + in_quotes(wanted_.y) +
                             ", which --columns asks for");
    }
    return refuse_line(
        name, csv.line(),
        "the first line names no columns x_m,y_m (or x,y; easting,northing) and no "
        "latitude_deg,longitude_deg (or lat,lon; latitude,longitude); add a line of names, or name the "
        "columns of the file with --columns X Y");
  }

  [[nodiscard]] bool is_wanted(const CsvReader& csv) const {
    const bool is_landmark = !csv.has(kind_) || csv.text(kind_) == "landmark";
    return is_landmark && (!wanted_.where || csv.text(where_) == wanted_.where->second);
  }

  [[nodiscard]] tl::expected<SurveyPoint, InputError> point(const CsvReader& csv, SurveyFrame frame) const {
    const bool is_local = frame == SurveyFrame::LocalMetres;
    auto first = csv.number(2 * pair_, is_local ? kGrid : kLatitude);
    if (!first) {
      return tl::unexpected(std::move(first.error()));
    }
    auto second = csv.number(2 * pair_ + 1, is_local ? kGrid : kLongitude);
    if (!second) {
      return tl::unexpected(std::move(second.error()));
    }
    SurveyPoint point;
    point.line = csv.line();
    is_local ? void(point.local_m = {*first, *second}) : void(point.place = {*first, *second});
    if (csv.has(id_)) {
      if (const auto id = csv.whole_number(id_, std::numeric_limits<std::int64_t>::max())) {
        point.id = *id;
      }
    }
    if (csv.has(diameter_) && !csv.text(diameter_).empty()) {
      const auto diameter_m = csv.number(diameter_, kDiameter);
      if (!diameter_m) {
        return tl::unexpected(diameter_m.error());
      }
      point.diameter_m = *diameter_m;
    }
    return point;
  }

  const SurveyColumns& wanted_;
  std::vector<NamePair> pairs_;
  std::vector<CsvColumn> columns_;
  std::size_t pair_ = 0;
  std::size_t id_ = 0;
  std::size_t diameter_ = 0;
  std::size_t kind_ = 0;
  std::size_t where_ = 0;
};

}  // namespace

tl::expected<Survey, InputError> parse_survey_csv(std::string_view text, std::string_view name,
                                                  const SurveyColumns& columns) {
  return SurveyTable(columns, text).read(text, name);
}

tl::expected<Survey, InputError> read_survey(const std::filesystem::path& path,
                                             const SurveyColumns& columns) {
  const auto text = read_file(path);
  if (!text) {
    return tl::unexpected(text.error());
  }
  const std::string name = path.string();
  if (const auto encoding = check_encoding(*text, name); !encoding) {
    return tl::unexpected(encoding.error());
  }
  const std::size_t first = text->find_first_not_of("\xEF\xBB\xBF \t\r\n");
  const bool is_json = first != std::string::npos && (*text)[first] == '{';
  return is_json ? parse_survey_geojson(*text, name) : parse_survey_csv(*text, name, columns);
}

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

/// Why the points cannot keep the ids of the survey; empty when they can.
std::string id_problem(const std::vector<SurveyPoint>& points) {
  if (std::none_of(points.begin(), points.end(), [](const SurveyPoint& point) { return point.id; })) {
    return "the survey has none";
  }
  std::map<std::int64_t, std::size_t> lines;
  for (const SurveyPoint& point : points) {
    const std::string where = "line " + std::to_string(point.line);
    if (!point.id) {
      return where + " has no id that is a whole number";
    }
    const std::string id = "the id " + std::to_string(*point.id);
    if (*point.id > kIdMax) {
      return where + " has " + id + ", which is more than " + std::to_string(kIdMax);
    }
    if (const auto [first, is_new] = lines.emplace(*point.id, point.line); !is_new) {
      return where + " has " + id + " of line " + std::to_string(first->second) + " once more";
    }
  }
  return {};
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
  made.map.numbers.is_surveyed = wishes.frozen;
  if (!is_local && !about.datum) {
    about.datum = middle_of(survey.points);
    made.is_datum_of_points = true;
  }
  std::optional<MapEarth> earth;
  if (!is_local) {
    earth.emplace(*about.datum);
  }
  made.id_problem = id_problem(survey.points);
  const bool are_ids_kept = made.id_problem.empty();
  Places places(kOnePlace_m);
  struct Landmark {
    std::uint32_t id;
    core::Point2 point_W;
    double diameter_m;
  };
  std::vector<Landmark> landmarks;
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
    landmarks.push_back(
        {are_ids_kept ? static_cast<std::uint32_t>(*point.id) : next, point_W, point.diameter_m});
  }
  if (landmarks.size() < 3) {
    return refuse(name, "holds " + std::to_string(landmarks.size()) +
                            " landmarks at different places; a place is found from three or more");
  }
  std::sort(landmarks.begin(), landmarks.end(),
            [](const Landmark& a, const Landmark& b) { return a.id < b.id; });
  for (const auto& [id, point_W, diameter_m] : landmarks) {
    core::MapLandmark landmark;
    landmark.id = id;
    landmark.sightings = landmark.chances = 1;
    landmark.size = core::LandmarkSize::seen(diameter_m);
    made.map.landmarks.push_back(landmark);
    made.map.positions_W.push_back(point_W);
  }
  made.map.numbers.next_id = landmarks.back().id + 1;
  made.map.numbers.scans = 1;
  return made;
}

}  // namespace slamsensor::tools
