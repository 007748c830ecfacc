#include "tools/output/result_files.hpp"

#include "core/fix.hpp"
#include "firmware/store/map_names.hpp"
#include "tools/output/text_output.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace slamsensor::tools {
namespace {

constexpr int kMetreDecimals = 6;
constexpr int kRadianDecimals = 9;
constexpr std::string_view kHeading =
    "scan,status,reason,search_end,x_m,y_m,heading_rad,sigma_x_m,sigma_y_m,sigma_heading_rad,corr_x_y,"
    "corr_x_heading,corr_y_heading,error_xi,matches,landmarks_seen,landmarks_in_map,expected_false_alarms,"
    "weight_best,weight_runner_up,jumps,map,home,protection_radius_m,sigma_near_m,t_s,milliseconds\n";
constexpr std::string_view kNoPose = ",,,,,,,,,,";

void append_pose(std::string& out, const core::Pose2& pose) {
  out += ',';
  append_fixed(out, pose.x_m, kMetreDecimals);
  out += ',';
  append_fixed(out, pose.y_m, kMetreDecimals);
  out += ',';
  append_fixed(out, pose.heading_rad, kRadianDecimals);
}

bool is_variance(double value) {
  return std::isfinite(value) && value >= 0.0;
}

void append_sigma(std::string& out, double variance, int decimals) {
  out += ',';
  if (is_variance(variance)) append_fixed(out, std::sqrt(variance), decimals);
}

// Zero when either quantity is known exactly, as is the origin of the map.
void append_correlation(std::string& out, const Eigen::Matrix3d& covariance, int row, int column) {
  out += ',';
  const double a = covariance(row, row);
  const double b = covariance(column, column);
  const double both = covariance(row, column);
  if (!is_variance(a) || !is_variance(b) || !std::isfinite(both)) return;
  append_fixed(out, a > 0.0 && b > 0.0 ? both / (std::sqrt(a) * std::sqrt(b)) : 0.0, kMetreDecimals);
}

void append_uncertainty(std::string& out, const core::Fix& fix) {
  append_sigma(out, fix.covariance(0, 0), kMetreDecimals);
  append_sigma(out, fix.covariance(1, 1), kMetreDecimals);
  append_sigma(out, fix.covariance(2, 2), kRadianDecimals);
  append_correlation(out, fix.covariance, 0, 1);
  append_correlation(out, fix.covariance, 0, 2);
  append_correlation(out, fix.covariance, 1, 2);
  out += ',';
  append_integer(out, fix.error_xi);
}

void append_counts(std::string& out, const core::Fix& fix) {
  for (const std::uint32_t count : {fix.matches, fix.landmarks_seen, fix.landmarks_in_map}) {
    out += ',';
    append_integer(out, count);
  }
  out += ',';
  append_general(out, fix.expected_false_alarms, 6);
  for (const std::uint64_t count : {fix.weight_best, fix.weight_runner_up, std::uint64_t{fix.jumps}}) {
    out += ',';
    append_integer(out, count);
  }
}

/// The map that the pose lies in, the home map, and how far off the pose may be.
void append_frame(std::string& out, const core::Fix& fix) {
  out += ',';
  append_integer(out, core::has_pose(fix) ? fix.map : 0);
  out += ',';
  append_integer(out, fix.home);
  out += ',';
  if (core::has_pose(fix)) append_fixed(out, fix.protection_radius_m, kMetreDecimals);
  append_sigma(out,
               core::has_pose(fix) ? std::max(fix.covariance_near(0, 0), fix.covariance_near(1, 1))
                                   : std::numeric_limits<double>::quiet_NaN(),
               kMetreDecimals);
}

void append_row(std::string& out, const FixRow& row, MeasuredTimes times) {
  append_integer(out, row.scan);
  for (const std::string_view name :
       {to_string(row.fix.status), to_string(row.fix.reason), to_string(row.fix.search_end)}) {
    out += ',';
    out += name;
  }
  if (core::has_pose(row.fix)) {
    append_pose(out, row.fix.pose_W);
    append_uncertainty(out, row.fix);
  } else {
    out += kNoPose;
  }
  append_counts(out, row.fix);
  append_frame(out, row.fix);
  out += ',';
  append_shortest(out, row.t_s);
  out += ',';
  if (times == MeasuredTimes::Written && row.milliseconds) append_fixed(out, *row.milliseconds, 3);
  out += '\n';
}

}  // namespace

std::string format_fixes(std::span<const FixRow> rows, MeasuredTimes times) {
  std::string out(kHeading);
  for (const FixRow& row : rows) append_row(out, row, times);
  return out;
}

tl::expected<void, OutputError> write_fixes(const std::filesystem::path& path, std::span<const FixRow> rows,
                                            MeasuredTimes times) {
  return write_file(path, format_fixes(rows, times));
}

namespace {

void append_row(std::string& out, const MapRow& row) {
  append_integer(out, row.id);
  out += ',';
  append_fixed(out, row.position_W.x(), 6);
  out += ',';
  append_fixed(out, row.position_W.y(), 6);
  for (const std::uint32_t count : {row.xi, row.sightings}) {
    out += ',';
    append_integer(out, count);
  }
  for (const std::int64_t scan : {row.first_scan, row.last_scan}) {
    out += ',';
    append_integer(out, scan);
  }
  out += ',';
  if (row.sigma_m > 0.0) append_fixed(out, row.sigma_m, 4);
  out += ',';
  if (row.diameter_m > 0.0) append_fixed(out, row.diameter_m, 3);
  out += '\n';
}

}  // namespace

std::string format_landmarks(std::span<const ScanRows> scans) {
  std::string out = "scan,x_m,y_m,diameter_m,weight\n";
  for (const ScanRows& scan : scans) {
    for (const core::ScanLandmark& landmark : scan.landmarks) {
      append_integer(out, scan.scan);
      out += ',';
      append_fixed(out, landmark.position_L.x(), 6);
      out += ',';
      append_fixed(out, landmark.position_L.y(), 6);
      out += ',';
      append_fixed(out, landmark.diameter_m, 4);
      out += ',';
      append_shortest(out, landmark.weight);
      out += '\n';
    }
  }
  return out;
}

std::string format_map(std::span<const MapRow> rows) {
  std::string out = "id,x_m,y_m,xi,sightings,first_scan,last_scan,sigma_m,diameter_m\n";
  for (const MapRow& row : rows) append_row(out, row);
  return out;
}

tl::expected<void, OutputError> write_map(const std::filesystem::path& path, std::span<const MapRow> rows) {
  return write_file(path, format_map(rows));
}

namespace {

void append_pose(std::string& out, const TimedPose& timed) {
  const double half_rad = 0.5 * core::wrap_angle(timed.pose.heading_rad);
  append_shortest(out, timed.t);
  out += ' ';
  append_fixed(out, timed.pose.x_m, 6);
  out += ' ';
  append_fixed(out, timed.pose.y_m, 6);
  out += " 0.000000 0.000000000 0.000000000 ";
  append_fixed(out, std::sin(half_rad), 9);
  out += ' ';
  append_fixed(out, std::cos(half_rad), 9);
  out += '\n';
}

}  // namespace

std::vector<TimedPose> trajectory_of(std::span<const FixRow> rows) {
  std::vector<TimedPose> poses;
  // A frame that was given up for a better one cannot be compared with it.
  const std::uint32_t home = rows.empty() ? 0 : rows.back().fix.home;
  for (const FixRow& row : rows) {
    if (row.fix.status == core::FixStatus::Fix && row.fix.home == home)
      poses.push_back({row.t_s, row.fix.pose_W});
  }
  return poses;
}

std::string format_trajectory(std::span<const TimedPose> poses) {
  std::string out;
  for (const TimedPose& timed : poses) append_pose(out, timed);
  return out;
}

tl::expected<void, OutputError> write_trajectory(const std::filesystem::path& path,
                                                 std::span<const TimedPose> poses) {
  return write_file(path, format_trajectory(poses));
}

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
  line(text, "file", std::to_string(bytes) + " bytes");
  line(text, "saved", when_text(map));
  line(text, "landmarks",
       std::to_string(map.landmarks.size()) + " from " + std::to_string(map.numbers.scans) + " scans, W " +
           std::to_string(map.numbers.weight));
  line(text, "extent", extent_text(map));
  line(text, "error", error_text(map));
  line(text, "path", std::to_string(map.path.size()) + " poses");
  line(text, "method", method_text(map.about.method));
  line(text, "mode",
       map.about.frozen ? std::string("marked frozen: a sensor localises in it and does not change it") +
                              (map.numbers.is_surveyed ? "; a survey, which leaves nothing out" : "")
                        : "a sensor may change it");
  line(text, "datum", map.about.datum ? datum_text(*map.about.datum) : "none");
  return text;
}

std::vector<MapRow> map_rows(const MapFile& map) {
  std::vector<MapRow> rows;
  rows.reserve(map.landmarks.size());
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const core::MapLandmark& landmark = map.landmarks[i];
    rows.push_back({landmark.id, map.positions_W[i], landmark.xi, landmark.sightings, landmark.first_scan,
                    landmark.last_scan, static_cast<double>(landmark.sigma_m), landmark.size.diameter_m()});
  }
  return rows;
}

}  // namespace slamsensor::tools
