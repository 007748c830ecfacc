#include "tools/input/csv.hpp"
#include "tools/map_files/survey_points.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>

namespace slamsensor::tools {
namespace {

// National grids count up to ten thousand kilometres; what is out of the map's reach is told later, with the
// remedy of an origin.
constexpr CsvRange kGrid{-1e8, 1e8, "m"};
constexpr CsvRange kLatitude{-90.0, 90.0, "deg"};
constexpr CsvRange kLongitude{-180.0, 180.0, "deg"};

/// Two columns that say where a point is, by one of the usual pairs of names.
struct NamePair {
  std::string_view first;
  std::string_view second;
  SurveyFrame frame;
};
constexpr std::array<NamePair, 8> kPairs{{
    {"x_m", "y_m", SurveyFrame::LocalMetres},
    {"x", "y", SurveyFrame::LocalMetres},
    {"X", "Y", SurveyFrame::LocalMetres},
    {"easting", "northing", SurveyFrame::LocalMetres},
    {"latitude_deg", "longitude_deg", SurveyFrame::Wgs84},
    {"latitude", "longitude", SurveyFrame::Wgs84},
    {"lat", "lon", SurveyFrame::Wgs84},
    {"Latitude", "Longitude", SurveyFrame::Wgs84},
}};

/// The columns that one reading of a table asks for; it outlives the reader.
class SurveyTable {
 public:
  explicit SurveyTable(const SurveyColumns& wanted) : wanted_(wanted) {
    if (!wanted.x.empty()) {
      pairs_.push_back({wanted.x, wanted.y, SurveyFrame::LocalMetres});
    } else {
      pairs_.assign(kPairs.begin(), kPairs.end());
    }
    for (const NamePair& pair : pairs_) {
      columns_.push_back({pair.first, CsvNeed::Optional});
      columns_.push_back({pair.second, CsvNeed::Optional});
    }
    id_ = add("id");
    kind_ = add("kind");
    if (wanted.where) {
      where_ = add(wanted.where->first);
    }
  }

  tl::expected<Survey, InputError> read(std::string_view text, std::string_view name) {
    auto csv = CsvReader::open(text, name, columns_, CsvOthers::Ignored);
    if (!csv) {
      return tl::unexpected(std::move(csv.error()));
    }
    if (auto found = choose_pair(*csv, name); !found) {
      return tl::unexpected(std::move(found.error()));
    }
    Survey survey;
    survey.frame = pairs_[pair_].frame;
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
        "the first line names no columns x_m,y_m and no latitude_deg,longitude_deg; add a line "
        "of names, or name the columns of the file with --columns X Y");
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
    return point;
  }

  const SurveyColumns& wanted_;
  std::vector<NamePair> pairs_;
  std::vector<CsvColumn> columns_;
  std::size_t pair_ = 0;
  std::size_t id_ = 0;
  std::size_t kind_ = 0;
  std::size_t where_ = 0;
};

}  // namespace

tl::expected<Survey, InputError> parse_survey_csv(std::string_view text, std::string_view name,
                                                  const SurveyColumns& columns) {
  return SurveyTable(columns).read(text, name);
}

}  // namespace slamsensor::tools
