#include "tools/output/trajectory_tum.hpp"

#include "tools/output/number_text.hpp"

#include <cmath>

namespace slamsensor::tools {
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

}  // namespace slamsensor::tools
