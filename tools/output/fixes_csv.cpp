#include "tools/output/fixes_csv.hpp"

#include "core/fix_names.hpp"
#include "tools/output/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace slamsensor::tools
