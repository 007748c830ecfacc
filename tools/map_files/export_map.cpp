#include "tools/map_files/export_map.hpp"

#include "tools/map_files/map_earth.hpp"
#include "tools/output/text_output.hpp"
#include "tools/plot/svg.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>

namespace slamsensor::tools {
namespace {

using Json = nlohmann::ordered_json;
using firmware::MapFile;

constexpr int kDegreeDecimals = 9;  // 0.1 mm
constexpr int kMetreDecimals = 4;

// GeoJSON without a "crs" is WGS 84; this one (WKT 2) says that the metres have no place on the earth.
constexpr const char* kLocalCrs =
    R"(ENGCRS["local metres: the map has no datum",EDATUM["origin of the map"],CS[Cartesian,2],)"
    R"(AXIS["x",unspecified],AXIS["y",unspecified],LENGTHUNIT["metre",1]])";

std::optional<MapEarth> earth_of(const MapFile& map) {
  return map.about.datum ? std::optional<MapEarth>(*map.about.datum) : std::nullopt;
}

double rounded(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale;
}

// --- GeoJSON ---------------------------------------------------------------------------------------------

Json coordinates(const core::Point2& point_W, const std::optional<MapEarth>& earth) {
  if (!earth) {
    return {rounded(point_W.x(), kMetreDecimals), rounded(point_W.y(), kMetreDecimals)};
  }
  const EarthPoint place = earth->on_earth(point_W);
  return {rounded(place.longitude_deg, kDegreeDecimals), rounded(place.latitude_deg, kDegreeDecimals)};
}

/// Null when it is not known.
Json sigma_json(const core::MapLandmark& landmark) {
  return landmark.sigma_m > 0.0F ? Json(rounded(static_cast<double>(landmark.sigma_m), kMetreDecimals))
                                 : Json();
}

/// Null when it is not known.
Json diameter_json(const core::MapLandmark& landmark) {
  return landmark.size.is_known() ? Json(rounded(landmark.size.diameter_m(), kMetreDecimals)) : Json();
}

Json landmark_feature(const MapFile& map, std::size_t i, const std::optional<MapEarth>& earth) {
  const core::MapLandmark& landmark = map.landmarks[i];
  const core::Point2& point_W = map.positions_W[i];
  return {{"type", "Feature"},
          {"geometry", {{"type", "Point"}, {"coordinates", coordinates(point_W, earth)}}},
          {"properties",
           {{"kind", "landmark"},
            {"id", landmark.id},
            {"xi", landmark.xi},
            {"sigma_m", sigma_json(landmark)},
            {"diameter_m", diameter_json(landmark)},
            {"sightings", landmark.sightings},
            {"first_scan", landmark.first_scan},
            {"last_scan", landmark.last_scan},
            {"x_m", rounded(point_W.x(), kMetreDecimals)},
            {"y_m", rounded(point_W.y(), kMetreDecimals)}}}};
}

Json path_feature(const MapFile& map, const std::optional<MapEarth>& earth) {
  Json line = Json::array();
  for (const core::PathPose& pose : map.path) {
    line.push_back(coordinates(pose.pose_W.translation(), earth));
  }
  return {{"type", "Feature"},
          {"geometry", {{"type", "LineString"}, {"coordinates", std::move(line)}}},
          {"properties", {{"kind", "path"}, {"poses", map.path.size()}}}};
}

std::string geojson(const MapFile& map) {
  const std::optional<MapEarth> earth = earth_of(map);
  Json root = {{"type", "FeatureCollection"}, {"name", map.about.name}};
  if (earth) {
    const firmware::Datum& datum = earth->datum();
    root["slamsensor"] = {{"frame", "WGS 84"},
                          {"datum",
                           {{"latitude_deg", datum.latitude_deg},
                            {"longitude_deg", datum.longitude_deg},
                            {"height_m", datum.height_m},
                            {"bearing_deg", datum.bearing_deg}}}};
  } else {
    root["crs"] = {{"type", "name"}, {"properties", {{"name", kLocalCrs}}}};
    root["slamsensor"] = {{"frame", "local metres: the map has no datum"}};
  }
  Json features = Json::array();
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    features.push_back(landmark_feature(map, i, earth));
  }
  if (map.path.size() >= 2) {
    features.push_back(path_feature(map, earth));
  }
  root["features"] = std::move(features);
  return root.dump(1) + '\n';
}

// --- CSV -------------------------------------------------------------------------------------------------

void append_place(std::string& out, const core::Point2& point_W, const std::optional<MapEarth>& earth) {
  if (earth) {
    const EarthPoint place = earth->on_earth(point_W);
    out += ',';
    append_fixed(out, place.latitude_deg, kDegreeDecimals);
    out += ',';
    append_fixed(out, place.longitude_deg, kDegreeDecimals);
  }
  out += '\n';
}

void append_metres(std::string& out, const core::Point2& point_W) {
  append_fixed(out, point_W.x(), kMetreDecimals);
  out += ',';
  append_fixed(out, point_W.y(), kMetreDecimals);
}

/// Empty when it is not known.
std::string sigma_text(const core::MapLandmark& landmark) {
  return landmark.sigma_m > 0.0F ? fixed_text(static_cast<double>(landmark.sigma_m), kMetreDecimals)
                                 : std::string();
}

/// Empty when it is not known.
std::string diameter_text(const core::MapLandmark& landmark) {
  return landmark.size.is_known() ? fixed_text(landmark.size.diameter_m(), kMetreDecimals) : std::string();
}

std::string csv(const MapFile& map) {
  const std::optional<MapEarth> earth = earth_of(map);
  std::string out = "kind,id,x_m,y_m,heading_deg,xi,sightings,first_scan,last_scan,sigma_m,diameter_m";
  out += earth ? ",latitude_deg,longitude_deg\n" : "\n";
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const core::MapLandmark& landmark = map.landmarks[i];
    out += "landmark,";
    append_integer(out, landmark.id);
    out += ',';
    append_metres(out, map.positions_W[i]);
    out += ',';
    for (const std::uint32_t number :
         {landmark.xi, landmark.sightings, landmark.first_scan, landmark.last_scan}) {
      out += ',';
      append_integer(out, number);
    }
    out += ',' + sigma_text(landmark) + ',' + diameter_text(landmark);
    append_place(out, map.positions_W[i], earth);
  }
  for (const core::PathPose& pose : map.path) {
    const std::string scan = std::to_string(pose.scan);
    out += "pose," + scan + ',';
    append_metres(out, pose.pose_W.translation());
    out += ',' + fixed_text(pose.pose_W.heading_rad / core::kDegree, 3) + ',' + std::to_string(pose.xi) +
           ",," + scan + ',' + scan + ",,";
    append_place(out, pose.pose_W.translation(), earth);
  }
  return out;
}

// --- GPX and KML -----------------------------------------------------------------------------------------

std::string xml_head(std::string_view root) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + std::string(root) + '\n';
}

std::string attributes(const EarthPoint& place) {
  return " lat=\"" + fixed_text(place.latitude_deg, kDegreeDecimals) + "\" lon=\"" +
         fixed_text(place.longitude_deg, kDegreeDecimals) + "\"";
}

std::string landmark_words(const core::MapLandmark& landmark) {
  const std::string sigma = sigma_text(landmark);
  const std::string diameter = diameter_text(landmark);
  return "xi " + std::to_string(landmark.xi) + ", " + (sigma.empty() ? "" : "sigma " + sigma + " m, ") +
         (diameter.empty() ? "" : "diameter " + diameter + " m, ") + "sightings " +
         std::to_string(landmark.sightings) + ", scans " + std::to_string(landmark.first_scan) + " to " +
         std::to_string(landmark.last_scan);
}

void append_named(std::string& out, const std::string& name) {
  out += "<name>";
  append_xml_text(out, name);
  out += "</name>";
}

/// Empty without a text.
std::string xml_element(const std::string& name, const std::string& text) {
  return text.empty() ? text : '<' + name + '>' + text + "</" + name + '>';
}

std::string gpx(const MapFile& map, const MapEarth& earth) {
  std::string out = xml_head(
      "<gpx version=\"1.1\" creator=\"slamsensor\" xmlns=\"http://www.topografix.com/GPX/1/1\" "
      "xmlns:slamsensor=\"urn:slamsensor:map:1\">");
  out += "<metadata>";
  append_named(out, map.about.name);
  out += "</metadata>\n";
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const core::MapLandmark& landmark = map.landmarks[i];
    out += "<wpt" + attributes(earth.on_earth(map.positions_W[i])) + ">";
    append_named(out, "landmark " + std::to_string(landmark.id));
    out += "<desc>" + landmark_words(landmark) + "</desc><type>landmark</type><extensions><slamsensor:xi>" +
           std::to_string(landmark.xi) + "</slamsensor:xi><slamsensor:sightings>" +
           std::to_string(landmark.sightings) + "</slamsensor:sightings>" +
           xml_element("slamsensor:sigma_m", sigma_text(landmark)) +
           xml_element("slamsensor:diameter_m", diameter_text(landmark)) + "</extensions></wpt>\n";
  }
  if (!map.path.empty()) {
    out += "<trk><name>path</name><trkseg>\n";
    for (const core::PathPose& pose : map.path) {
      out += "<trkpt" + attributes(earth.on_earth(pose.pose_W.translation())) + "/>\n";
    }
    out += "</trkseg></trk>\n";
  }
  return out + "</gpx>\n";
}

std::string kml_coordinates(const EarthPoint& place) {
  return fixed_text(place.longitude_deg, kDegreeDecimals) + ',' +
         fixed_text(place.latitude_deg, kDegreeDecimals);
}

/// Empty without a value.
std::string kml_data(const std::string& name, const std::string& value) {
  return value.empty() ? value : "<Data name=\"" + name + "\"><value>" + value + "</value></Data>";
}

std::string kml(const MapFile& map, const MapEarth& earth) {
  std::string out = xml_head("<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document>");
  append_named(out, map.about.name);
  out += "\n<Folder><name>landmarks</name>\n";
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const core::MapLandmark& landmark = map.landmarks[i];
    out += "<Placemark>";
    append_named(out, std::to_string(landmark.id));
    out += "<description>" + landmark_words(landmark) +
           "</description><ExtendedData><Data name=\"xi\"><value>" + std::to_string(landmark.xi) +
           "</value></Data><Data name=\"sightings\"><value>" + std::to_string(landmark.sightings) +
           "</value></Data>" + kml_data("sigma_m", sigma_text(landmark)) +
           kml_data("diameter_m", diameter_text(landmark)) + "</ExtendedData><Point><coordinates>" +
           kml_coordinates(earth.on_earth(map.positions_W[i])) + "</coordinates></Point></Placemark>\n";
  }
  out += "</Folder>\n";
  if (map.path.size() >= 2) {
    out += "<Folder><name>path</name><Placemark><name>path</name><LineString><coordinates>\n";
    for (const core::PathPose& pose : map.path) {
      out += kml_coordinates(earth.on_earth(pose.pose_W.translation())) + '\n';
    }
    out += "</coordinates></LineString></Placemark></Folder>\n";
  }
  return out + "</Document></kml>\n";
}

}  // namespace

tl::expected<std::string, std::string> export_map(const MapFile& map, ExportFormat format) {
  switch (format) {
    case ExportFormat::GeoJson:
      return geojson(map);
    case ExportFormat::Csv:
      return csv(map);
    case ExportFormat::Gpx:
    case ExportFormat::Kml:
      break;
  }
  const std::optional<MapEarth> earth = earth_of(map);
  if (!earth) {
    return tl::unexpected(
        std::string(format == ExportFormat::Gpx ? "GPX" : "KML") +
        " knows only latitude and longitude and the map has no datum; give --datum LATITUDE "
        "LONGITUDE HEIGHT BEARING, or export geojson or csv, which take local metres");
  }
  return format == ExportFormat::Gpx ? gpx(map, *earth) : kml(map, *earth);
}

}  // namespace slamsensor::tools
