#pragma once

#include "core/geometry/pose2.hpp"
#include "firmware/store/map_file.hpp"
#include "tools/input/text.hpp"
#include "tools/map_files/map_earth.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slamsensor::tools {

/// How a table of points is to be read; what is empty is found by the usual names.
struct SurveyColumns {
  std::string x;
  std::string y;
  /// Only rows whose column `first` holds `second`.
  std::optional<std::pair<std::string, std::string>> where;
};

/// A surveyed thing: where it stands and where the file says so.
struct SurveyPoint {
  core::Point2 local_m = core::Point2::Zero();  ///< meant when the survey is in local metres
  EarthPoint place;                             ///< meant when it is in latitude and longitude
  std::optional<std::int64_t> id;
  double diameter_m = 0.0;  ///< 0: not measured
  std::size_t line = 0;
};

enum class SurveyFrame : std::uint8_t { LocalMetres, Wgs84 };

struct Survey {
  SurveyFrame frame = SurveyFrame::LocalMetres;
  std::optional<firmware::Datum> datum;  ///< that the file itself names
  std::vector<SurveyPoint> points;       ///< at least one
  std::size_t passed_over = 0;   ///< rows or features that are no points of the survey: paths, other plots
  std::string degrees_not_read;  ///< the names of its columns in degrees, where those in metres are read
};

/// A table with a first line of column names: `x_m,y_m` (also x,y; easting,northing) in metres or
/// `latitude_deg,longitude_deg` (also lat,lon; latitude,longitude; lng, long), in small or capital letters,
/// maybe `id`, `diameter_m` and `kind` (rows of another kind than `landmark` are passed over). Other columns
/// are ignored. An error names file, line and remedy.
[[nodiscard]] tl::expected<Survey, InputError> parse_survey_csv(std::string_view text, std::string_view name,
                                                                const SurveyColumns& columns);

/// The points of a GeoJSON (Feature, FeatureCollection, Point, MultiPoint, GeometryCollection); other
/// geometries are passed over. Properties: `id`, `diameter_m`, `kind`, as above. WGS 84, unless the file says
/// "crs": null or names an ENGCRS, as `map export` does. An error names file, line and remedy.
[[nodiscard]] tl::expected<Survey, InputError> parse_survey_geojson(std::string_view text,
                                                                    std::string_view name);

/// Either, by the first character of the file: `{` begins a GeoJSON.
[[nodiscard]] tl::expected<Survey, InputError> read_survey(const std::filesystem::path& path,
                                                           const SurveyColumns& columns);

/// What the user says of the map to be made.
struct SurveyMapWishes {
  std::optional<firmware::Datum> datum;
  core::Point2 origin_m = core::Point2::Zero();  ///< subtracted from local metres
  bool frozen = true;
};

struct SurveyMap {
  firmware::MapFile map;            ///< without a name
  std::size_t at_one_place = 0;     ///< points left out: within a centimetre of one before them
  std::string id_problem;           ///< why the landmarks have not the ids of the survey; empty: they have
  bool is_datum_of_points = false;  ///< nobody named a datum: it is the middle of the points
};

/// A map of the points as landmarks without error (xi 0) that were seen once, and no path. Latitudes and
/// longitudes become metres about the datum: the one wished, else the file's, else the points' middle with x
/// towards east. An error names the file, the line and what to do.
[[nodiscard]] tl::expected<SurveyMap, InputError> map_of_survey(const Survey& survey, std::string_view name,
                                                                const SurveyMapWishes& wishes);

}  // namespace slamsensor::tools
