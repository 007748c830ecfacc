#include "tools/output/map_info.hpp"

#include "firmware/store/map_text.hpp"
#include "tools/output/number_text.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <string_view>

namespace slamsensor::tools {
namespace {

using firmware::MapFile;

void line(std::string& out, std::string_view label, const std::string& text) {
  constexpr std::size_t kLabelWidth = 11;
  out.append(label).append(kLabelWidth - label.size(), ' ').append(text).append("\n");
}

std::string when_text(const MapFile& map) {
  const firmware::MapAbout& about = map.about;
  std::string text = firmware::utc_text(about.saved_utc_s);
  if (about.created_utc_s != 0) {
    text += ", save " + std::to_string(about.saves) + " since " + firmware::utc_text(about.created_utc_s);
  }
  return text;
}

std::string extent_text(const MapFile& map) {
  Eigen::AlignedBox2d box;
  for (const core::Point2& position_W : map.positions_W) {
    box.extend(position_W);
  }
  return "x " + fixed_text(box.min().x(), 2) + " to " + fixed_text(box.max().x(), 2) + " m, y " +
         fixed_text(box.min().y(), 2) + " to " + fixed_text(box.max().y(), 2) + " m";
}

std::string error_text(const MapFile& map) {
  std::uint32_t xi_max = 0;
  for (const core::MapLandmark& landmark : map.landmarks) {
    xi_max = std::max(xi_max, landmark.xi);
  }
  return "xi up to " + std::to_string(xi_max);
}

std::string method_text(const firmware::MapMethod& method) {
  std::string text = "tolerance ";
  append_shortest(text, method.tolerance_m);
  text += " m, depth " + std::to_string(method.depth) + ", cells of ";
  append_shortest(text, method.range_step_m);
  return text + " m by " + fixed_text(method.bearing_step_rad / core::kDegree, 3) + " deg, up to " +
         std::to_string(method.landmarks_max) + " landmarks per scan";
}

std::string datum_text(const firmware::Datum& datum) {
  return "latitude " + fixed_text(datum.latitude_deg, 7) + ", longitude " +
         fixed_text(datum.longitude_deg, 7) + ", height " + fixed_text(datum.height_m, 2) +
         " m, x axis towards " + fixed_text(datum.bearing_deg, 3) + " deg";
}

}  // namespace

std::string map_info_text(const MapFile& map, std::size_t bytes) {
  std::string text;
  line(text, "map", map.about.name);
  line(text, "file",
       "format version " + std::to_string(map.version) + ", " + std::to_string(bytes) + " bytes");
  line(text, "saved", when_text(map));
  line(text, "landmarks",
       std::to_string(map.landmarks.size()) + " from " + std::to_string(map.numbers.scans) + " scans, W " +
           std::to_string(map.numbers.weight));
  line(text, "extent", extent_text(map));
  line(text, "error", error_text(map));
  line(text, "path", std::to_string(map.path.size()) + " poses");
  if (map.version > 1) {
    line(text, "method", method_text(map.about.method));
  }
  line(text, "datum", map.about.datum ? datum_text(*map.about.datum) : "none");
  return text;
}

std::vector<MapRow> map_rows(const MapFile& map) {
  std::vector<MapRow> rows;
  rows.reserve(map.landmarks.size());
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const core::MapLandmark& landmark = map.landmarks[i];
    rows.push_back({landmark.id, map.positions_W[i], landmark.xi, landmark.sightings, landmark.first_scan,
                    landmark.last_scan});
  }
  return rows;
}

}  // namespace slamsensor::tools
