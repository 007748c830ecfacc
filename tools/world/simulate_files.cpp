#include "tools/world/simulate_files.hpp"

#include <Eigen/Geometry>

#include <charconv>
#include <numbers>

namespace slamsensor::tools {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr std::size_t kBytesPerReading = 28;

void append(std::string& text, double value, int decimals, char after) {
  char buffer[400];  // the longest double in fixed notation has 309 digits before the point
  char* const end =
      std::to_chars(buffer, buffer + sizeof(buffer), value, std::chars_format::fixed, decimals).ptr;
  text.append(buffer, end);
  text.push_back(after);
}

}  // namespace

std::string scan_file_name(std::size_t number) {
  constexpr std::size_t kDigits = 4;
  std::string digits = std::to_string(number);
  digits.insert(0, digits.size() < kDigits ? kDigits - digits.size() : 0, '0');
  return "scan_" + digits + ".csv";
}

std::string format_scan(const std::vector<std::vector<core::Reading>>& lines) {
  std::string text = "pan_deg,tilt_deg,range_m\n";
  text.reserve(lines.empty() ? text.size() : lines.size() * lines.front().size() * kBytesPerReading);
  for (const std::vector<core::Reading>& line : lines) {
    for (const core::Reading& reading : line) {
      append(text, reading.pan_rad * kDegreesPerRadian, 5, ',');
      append(text, reading.tilt_rad * kDegreesPerRadian, 5, ',');
      if (reading.has_return()) {
        append(text, reading.range_m, 3, '\n');
      } else {
        text.push_back('\n');
      }
    }
  }
  return text;
}

std::string format_truth(const World& world, const SweepConfig& sweep, std::span<const Stand> stands) {
  std::string text;
  for (std::size_t i = 0; i < stands.size(); ++i) {
    const SensorPlace place = sensor_place(world, sweep, stands[i].pose);
    const Eigen::Quaterniond q(place.R_W_L);
    append(text, static_cast<double>(i + 1), 0, ' ');
    for (const double coordinate : {place.position_W.x(), place.position_W.y(), place.position_W.z()}) {
      append(text, coordinate, 6, ' ');
    }
    append(text, q.x(), 9, ' ');
    append(text, q.y(), 9, ' ');
    append(text, q.z(), 9, ' ');
    append(text, q.w(), 9, '\n');
  }
  return text;
}

std::string format_stems(std::span<const Object> objects) {
  std::string text = "id,x_m,y_m,radius_m,height_m,kind\n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Object& object = objects[i];
    text += std::to_string(i + 1) + ',';
    append(text, object.x_m, 4, ',');
    append(text, object.y_m, 4, ',');
    append(text, object.radius_m, 4, ',');
    append(text, object.height_m, 3, ',');
    text.append(name_of(object.kind)).push_back('\n');
  }
  return text;
}

}  // namespace slamsensor::tools
