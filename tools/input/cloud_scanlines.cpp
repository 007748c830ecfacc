#include "tools/input/cloud_scanlines.hpp"

#include "core/detection/levelling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <string>
#include <utility>

namespace slamsensor::tools {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

using Scanline = std::vector<core::Reading>;

double pan_rad(const Eigen::Vector3d& p) {
  const double angle_rad = std::atan2(p.y(), p.x());
  const double turned_rad = angle_rad < 0.0 ? angle_rad + kTurn_rad : angle_rad;
  return turned_rad < kTurn_rad ? turned_rad : 0.0;  // a tiny negative angle rounds up to the full turn
}

core::Reading reading_of(const Eigen::Vector3d& p) {
  return {pan_rad(p), std::atan2(p.z(), p.head<2>().norm()), p.norm()};
}

// The circle in columns of one width but for the last, which the turn cuts off.
class ColumnCircle {
 public:
  explicit ColumnCircle(double step_rad)
      : step_rad_(step_rad), count_(static_cast<std::size_t>(std::ceil(kTurn_rad / step_rad))) {}

  std::size_t count() const { return count_; }

  std::size_t column_of(double angle_rad) const {
    return std::min(static_cast<std::size_t>(std::floor(angle_rad / step_rad_)), count_ - 1);
  }

  double centre_rad(std::size_t column) const {
    const double first_rad = static_cast<double>(column) * step_rad_;
    return 0.5 * (first_rad + std::min(first_rad + step_rad_, kTurn_rad));
  }

 private:
  double step_rad_;
  std::size_t count_;
};

Scanline with_absent_columns(const Scanline& scanline, const ColumnCircle& columns) {
  Scanline full;
  full.reserve(scanline.size() + columns.count());
  double tilt_rad = scanline.back().tilt_rad;  // before column 0 comes the end of the turn
  std::size_t next = 0;
  for (std::size_t column = 0; column < columns.count(); ++column) {
    const std::size_t first = next;
    for (; next < scanline.size() && columns.column_of(scanline[next].pan_rad) == column; ++next) {
      full.push_back(scanline[next]);
      tilt_rad = scanline[next].tilt_rad;
    }
    if (next == first) {
      full.push_back({columns.centre_rad(column), tilt_rad, core::Reading::kNoReturn});
    }
  }
  return full;
}

}  // namespace

tl::expected<std::vector<Scanline>, InputError> scanlines_of_cloud(const PointCloud& cloud,
                                                                   const firmware::PointCloudConfig& config,
                                                                   double bearing_step_rad,
                                                                   std::string_view name) {
  const Eigen::Matrix3d R_level_L = core::level_from_sensor({config.roll_rad, config.pitch_rad});
  std::map<std::int64_t, Scanline> by_key;
  for (const CloudPoint& point : cloud.points) {
    const core::Reading reading = reading_of(R_level_L * point.position_L);
    const std::int64_t key =
        cloud.has_ring ? std::int64_t{point.ring}
                       : static_cast<std::int64_t>(std::llround(reading.tilt_rad / config.tilt_step_rad));
    by_key[key].push_back(reading);
  }
  const ColumnCircle columns(bearing_step_rad);
  const std::size_t absent = config.absent_is_no_return ? columns.count() : 0;
  if (cloud.points.size() + by_key.size() * absent > kCloudReadingsMax) {
    return refuse(name, "makes " + std::to_string(by_key.size()) + " scanlines of " + std::to_string(absent) +
                            " columns and " + std::to_string(cloud.points.size()) + " points, more than " +
                            std::to_string(kCloudReadingsMax) +
                            " readings; check the ring field, or configure larger steps");
  }
  std::vector<Scanline> scanlines;
  scanlines.reserve(by_key.size());
  for (auto& [key, scanline] : by_key) {
    std::stable_sort(scanline.begin(), scanline.end(),
                     [](const core::Reading& a, const core::Reading& b) { return a.pan_rad < b.pan_rad; });
    scanlines.push_back(config.absent_is_no_return ? with_absent_columns(scanline, columns)
                                                   : std::move(scanline));
  }
  return scanlines;
}

}  // namespace slamsensor::tools
