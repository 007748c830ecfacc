#include "tools/input/text.hpp"
#include "tools/map_files/survey_points.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <iterator>

namespace slamsensor::tools {
namespace {

using Json = nlohmann::json;

/// Walks a text and counts its lines for whoever looks while a parser walks.
class LineCounter {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  LineCounter(const char* at, std::size_t* line) : at_(at), line_(line) {}
  reference operator*() const { return *at_; }
  LineCounter& operator++() {
    *line_ += *at_ == '\n' ? 1 : 0;
    ++at_;
    return *this;
  }
  bool operator==(const LineCounter& other) const { return at_ == other.at_; }
  bool operator!=(const LineCounter& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  std::size_t* line_;
};

/// A parsed file and the line that each of its features begins in.
struct Parsed {
  Json root;
  std::vector<std::size_t> feature_lines;
};

tl::expected<Parsed, InputError> parse(std::string_view text, std::string_view name) {
  Parsed parsed;
  std::size_t line = 1;
  bool in_features = false;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::key && depth == 1) {
      in_features = value == "features";
    } else if (event == Json::parse_event_t::object_start && depth == 2 && in_features) {
      parsed.feature_lines.push_back(line);
    }
    return true;
  };
  try {
    parsed.root =
        Json::parse(LineCounter(text.data(), &line), LineCounter(text.data() + text.size(), &line), watch);
  } catch (const Json::exception&) {
    return refuse_line(name, line, "it is no JSON from here on; export it again as GeoJSON");
  }
  return parsed;
}

/// Reads the geometries of one file.
class GeoJsonReader {
 public:
  GeoJsonReader(std::string_view name, Survey& survey) : name_(name), survey_(survey) {}

  tl::expected<void, InputError> feature(const Json& feature, std::size_t line) {
    line_ = line;
    if (!feature.is_object() || !feature.contains("geometry")) {
      return fail("it is no Feature with a geometry");
    }
    const Json properties = feature.value("properties", Json());
    if (properties.is_object() && properties.value("kind", Json("landmark")) != "landmark") {
      ++survey_.passed_over;
      return {};
    }
    id_.reset();
    if (properties.is_object() && properties.contains("id") && properties["id"].is_number_unsigned()) {
      id_ = properties["id"].get<std::int64_t>();
    }
    return geometry(feature["geometry"]);
  }

  tl::expected<void, InputError> geometry(const Json& geometry) {
    const std::string type = geometry.is_object() ? geometry.value("type", std::string()) : std::string();
    if (type == "Point") {
      return point(geometry.value("coordinates", Json()));
    }
    if (type == "MultiPoint") {
      const Json points = geometry.value("coordinates", Json::array());
      for (const Json& one : points) {
        if (auto taken = point(one); !taken) {
          return taken;
        }
      }
      return {};
    }
    ++survey_.passed_over;  // a line, an area, nothing: no landmark
    return {};
  }

 private:
  tl::unexpected<InputError> fail(const std::string& what) const { return refuse_line(name_, line_, what); }

  tl::expected<void, InputError> point(const Json& coordinates) {
    const bool is_pair = coordinates.is_array() && coordinates.size() >= 2 && coordinates[0].is_number() &&
                         coordinates[1].is_number();
    if (!is_pair) {
      return fail("a Point needs \"coordinates\": [longitude, latitude]");
    }
    const auto first = coordinates[0].get<double>();
    const auto second = coordinates[1].get<double>();
    SurveyPoint point;
    point.line = line_;
    point.id = id_;
    if (survey_.frame == SurveyFrame::LocalMetres) {
      point.local_m = {first, second};
    } else if (std::abs(second) <= 90.0 && std::abs(first) <= 180.0) {
      point.place = {second, first};
    } else {
      return fail("[" + shown(first) + ", " + shown(second) +
                  "] is no longitude and latitude in degrees; convert the file to WGS 84 (ogr2ogr -t_srs "
                  "EPSG:4326), or, if it is in local metres, write \"crs\": null into its first object");
    }
    survey_.points.push_back(point);
    return {};
  }

  std::string_view name_;
  Survey& survey_;
  std::size_t line_ = 1;
  std::optional<std::int64_t> id_;
};

/// The coordinate system that the file names; empty when there is none.
std::string crs_name(const Json& root) {
  const Json crs = root.value("crs", Json());
  const Json name = crs.is_object() ? crs.value("properties", Json::object()).value("name", Json()) : Json();
  return name.is_string() ? name.get<std::string>() : std::string();
}

bool is_local_crs(const Json& root) {
  const std::string name = crs_name(root);
  return (root.contains("crs") && root["crs"].is_null()) || name.starts_with("ENGCRS") ||
         name.starts_with("LOCAL_CS");
}

bool is_wgs84(const std::string& crs) {
  return crs.empty() || crs.ends_with("CRS84") || crs.ends_with("4326");
}

/// As `map export` writes it.
std::optional<firmware::Datum> datum_of(const Json& root) {
  const Json own = root.value("slamsensor", Json::object());
  const Json datum = own.is_object() ? own.value("datum", Json()) : Json();
  if (!datum.is_object()) {
    return std::nullopt;
  }
  const auto number = [&](const char* key) {
    const Json value = datum.value(key, Json());
    return value.is_number() ? value.get<double>() : std::nan("");
  };
  const firmware::Datum found{number("latitude_deg"), number("longitude_deg"), number("height_m"),
                              number("bearing_deg")};
  const bool is_place = std::abs(found.latitude_deg) <= 90.0 && std::abs(found.longitude_deg) <= 180.0 &&
                        std::isfinite(found.height_m) && std::isfinite(found.bearing_deg);
  return is_place ? std::optional(found) : std::nullopt;
}

tl::expected<Survey, InputError> survey_of(const Parsed& parsed, std::string_view name) {
  const Json& root = parsed.root;
  if (!root.is_object() || !root.contains("type")) {
    return refuse_line(name, 1, "it is no GeoJSON: an object with a \"type\" is needed");
  }
  const bool is_local = is_local_crs(root);
  if (const std::string crs = crs_name(root); !is_local && !is_wgs84(crs)) {
    return refuse(name, "its coordinates are " + in_quotes(crs) +
                            "; convert it to WGS 84: ogr2ogr -t_srs EPSG:4326 out.geojson " +
                            std::string(name));
  }
  Survey survey;
  survey.frame = is_local ? SurveyFrame::LocalMetres : SurveyFrame::Wgs84;
  survey.datum = datum_of(root);
  GeoJsonReader reader(name, survey);
  const bool is_collection = root["type"] == "FeatureCollection";
  const Json features = is_collection ? root.value("features", Json::array()) : Json::array({root});
  for (std::size_t i = 0; i < features.size(); ++i) {
    const std::size_t line = i < parsed.feature_lines.size() ? parsed.feature_lines[i] : 1;
    const bool is_feature = is_collection || root["type"] == "Feature";
    if (auto taken = is_feature ? reader.feature(features[i], line) : reader.geometry(root); !taken) {
      return tl::unexpected(std::move(taken.error()));
    }
  }
  if (survey.points.empty()) {
    return refuse(name, "holds no Point; landmarks are Points");
  }
  return survey;
}

}  // namespace

tl::expected<Survey, InputError> parse_survey_geojson(std::string_view text, std::string_view name) {
  return parse(text, name).and_then([&](const Parsed& parsed) { return survey_of(parsed, name); });
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

}  // namespace slamsensor::tools
