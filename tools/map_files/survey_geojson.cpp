#include "firmware/store/map_file.hpp"
#include "tools/input/text.hpp"
#include "tools/map_files/survey_map.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>

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

/// A GeoJSON with all that it may hold nests less deeply.
constexpr int kDepthMax = 32;

/// A parsed file and the line that each of its features begins in.
struct Parsed {
  Json root;
  std::vector<std::size_t> feature_lines;
};

/// The member `key` of `object`; null when there is none, or it is no object.
const Json* member(const Json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found != object.end() ? &*found : nullptr;
}

/// The text that the member `key` of `object` is; empty when it is none.
std::string text_of(const Json& object, const char* key) {
  const Json* const text = member(object, key);
  return text != nullptr && text->is_string() ? text->get<std::string>() : std::string();
}

tl::expected<Parsed, InputError> parse(std::string_view text, std::string_view name) {
  Parsed parsed;
  std::size_t line = 1;
  std::size_t too_deep_line = 0;
  bool in_features = false;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::key && depth == 1) {
      in_features = value == "features";
    } else if (event == Json::parse_event_t::object_start && depth == 2 && in_features) {
      parsed.feature_lines.push_back(line);
    }
    const bool is_too_deep = depth >= kDepthMax && (event == Json::parse_event_t::object_start ||
                                                    event == Json::parse_event_t::array_start);
    too_deep_line = is_too_deep && too_deep_line == 0 ? line : too_deep_line;
    return !is_too_deep;  // what is too deep is not kept
  };
  try {
    parsed.root =
        Json::parse(LineCounter(text.data(), &line), LineCounter(text.data() + text.size(), &line), watch);
  } catch (const Json::exception&) {
    return refuse_line(name, line, "it is no JSON from here on; export it again as GeoJSON");
  }
  if (too_deep_line > 0) {
    return refuse_line(
        name, too_deep_line,
        "it nests more than " + std::to_string(kDepthMax) +
            " objects and lists in each other, which no GeoJSON of points does; export it again");
  }
  return parsed;
}

/// Reads the geometries of one file.
class GeoJsonReader {
 public:
  GeoJsonReader(std::string_view name, Survey& survey) : name_(name), survey_(survey) {}

  tl::expected<void, InputError> feature(const Json& feature, std::size_t line) {
    line_ = line;
    const Json* const own_geometry = member(feature, "geometry");
    if (own_geometry == nullptr) {
      return fail("it is no Feature with a geometry");
    }
    const Json* const properties = member(feature, "properties");
    if (properties != nullptr && member(*properties, "kind") != nullptr &&
        text_of(*properties, "kind") != "landmark") {
      ++survey_.passed_over;
      return {};
    }
    const auto own_id = properties != nullptr ? id_of(*properties) : std::nullopt;
    id_ = own_id ? own_id : id_of(feature);
    const Json* const diameter = properties != nullptr ? member(*properties, "diameter_m") : nullptr;
    diameter_m_ = diameter != nullptr && diameter->is_number() ? diameter->get<double>() : 0.0;
    return geometry(*own_geometry);
  }

  tl::expected<void, InputError> geometry(const Json& geometry) {
    const std::string type = text_of(geometry, "type");
    if (!geometry.is_null() && type.empty()) {
      return fail("a geometry needs a \"type\" that is a text, such as \"Point\"");
    }
    if (type == "GeometryCollection") {
      return collection(geometry);
    }
    if (type != "Point" && type != "MultiPoint") {
      ++survey_.passed_over;  // a line, an area, nothing: no landmark
      return {};
    }
    const Json* const coordinates = member(geometry, "coordinates");
    if (type == "Point") {
      return point(coordinates);
    }
    if (coordinates == nullptr || !coordinates->is_array()) {
      return fail("a MultiPoint needs \"coordinates\": [[longitude, latitude], ...]");
    }
    for (const Json& one : *coordinates) {
      if (auto taken = point(&one); !taken) {
        return taken;
      }
    }
    return {};
  }

 private:
  tl::expected<void, InputError> collection(const Json& collection) {
    const Json* const geometries = member(collection, "geometries");
    if (geometries == nullptr || !geometries->is_array()) {
      return fail("a GeometryCollection needs \"geometries\": [...], a list of its geometries");
    }
    for (const Json& one : *geometries) {  // the parser has bounded how deep they nest
      if (auto taken = geometry(one); !taken) {
        return taken;
      }
    }
    return {};
  }

  tl::unexpected<InputError> fail(const std::string& what) const { return refuse_line(name_, line_, what); }

  static std::optional<std::int64_t> id_of(const Json& object) {
    const Json* const id = member(object, "id");
    const bool is_number = id != nullptr && id->is_number_unsigned() &&
                           id->get<std::uint64_t>() <= std::numeric_limits<std::int64_t>::max();
    return is_number ? std::optional(id->get<std::int64_t>()) : std::nullopt;
  }

  tl::expected<void, InputError> point(const Json* coordinates) {
    const bool is_pair = coordinates != nullptr && coordinates->is_array() && coordinates->size() >= 2 &&
                         (*coordinates)[0].is_number() && (*coordinates)[1].is_number();
    if (!is_pair) {
      return fail("a Point needs \"coordinates\": [longitude, latitude]");
    }
    const auto first = (*coordinates)[0].get<double>();
    const auto second = (*coordinates)[1].get<double>();
    SurveyPoint point;
    point.line = line_;
    point.id = id_;
    point.diameter_m = diameter_m_;
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
  double diameter_m_ = 0.0;
};

/// In which frame the coordinates are, by the member "crs": none is WGS 84, null says local metres.
tl::expected<SurveyFrame, InputError> frame_of(const Json& root, std::string_view name) {
  const Json* const crs = member(root, "crs");
  if (crs == nullptr) {
    return SurveyFrame::Wgs84;
  }
  const Json* const properties = member(*crs, "properties");
  const std::string system = properties != nullptr ? text_of(*properties, "name") : std::string();
  if (crs->is_null() || system.starts_with("ENGCRS") || system.starts_with("LOCAL_CS")) {
    return SurveyFrame::LocalMetres;
  }
  if (system.empty()) {
    return refuse(name,
                  "its \"crs\" names no coordinate system; it must be null (local metres), be left out (WGS "
                  "84), or hold \"properties\": {\"name\": ...}");
  }
  if (!system.ends_with("CRS84") && !system.ends_with("4326")) {
    return refuse(name, "its coordinates are " + in_quotes(system) +
                            "; convert it to WGS 84: ogr2ogr -t_srs EPSG:4326 out.geojson " +
                            std::string(name));
  }
  return SurveyFrame::Wgs84;
}

/// As `map export` writes it.
tl::expected<std::optional<firmware::Datum>, InputError> datum_of(const Json& root, std::string_view name) {
  const Json* const own = member(root, "slamsensor");
  const Json* const datum = own != nullptr ? member(*own, "datum") : nullptr;
  if (datum == nullptr) {
    return std::nullopt;
  }
  const auto number = [&](const char* key) {
    const Json* const value = member(*datum, key);
    return value != nullptr && value->is_number() ? value->get<double>() : std::nan("");
  };
  const firmware::Datum found{number("latitude_deg"), number("longitude_deg"), number("height_m"),
                              number("bearing_deg")};
  if (!firmware::is_on_earth(found)) {
    return refuse(name,
                  "its \"slamsensor\": {\"datum\": ...} is no place on the earth; correct it, or take it out "
                  "and name one with --datum");
  }
  return found;
}

/// The features of `root`; null when it is one geometry itself.
tl::expected<const Json*, InputError> features_of(const Json& root, std::string_view name) {
  if (text_of(root, "type") != "FeatureCollection") {
    return nullptr;
  }
  const Json* const features = member(root, "features");
  if (features == nullptr || !features->is_array()) {
    return refuse_line(name, 1, "a FeatureCollection needs \"features\": [...], a list of its features");
  }
  return features;
}

tl::expected<void, InputError> read_geometries(const Parsed& parsed, std::string_view name, Survey& survey) {
  const auto features = features_of(parsed.root, name);
  if (!features) {
    return tl::unexpected(features.error());
  }
  GeoJsonReader reader(name, survey);
  if (*features == nullptr) {
    return text_of(parsed.root, "type") == "Feature" ? reader.feature(parsed.root, 1)
                                                     : reader.geometry(parsed.root);
  }
  for (std::size_t i = 0; i < (*features)->size(); ++i) {
    const std::size_t line = i < parsed.feature_lines.size() ? parsed.feature_lines[i] : 1;
    if (auto taken = reader.feature((**features)[i], line); !taken) {
      return taken;
    }
  }
  return {};
}

tl::expected<Survey, InputError> survey_of(const Parsed& parsed, std::string_view name) {
  if (text_of(parsed.root, "type").empty()) {
    return refuse_line(name, 1, "it is no GeoJSON: an object with a \"type\" that is a text is needed");
  }
  const auto frame = frame_of(parsed.root, name);
  if (!frame) {
    return tl::unexpected(frame.error());
  }
  const auto datum = datum_of(parsed.root, name);
  if (!datum) {
    return tl::unexpected(datum.error());
  }
  Survey survey;
  survey.frame = *frame;
  survey.datum = *datum;
  if (auto taken = read_geometries(parsed, name, survey); !taken) {
    return tl::unexpected(std::move(taken.error()));
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

}  // namespace slamsensor::tools
