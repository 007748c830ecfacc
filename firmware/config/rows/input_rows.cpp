#include "firmware/config/rows/setting_path.hpp"
#include "firmware/config/rows/setting_rows.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;

// Names of the enumerators, in their order.
constexpr std::string_view kOrders[] = {"weight", "diameter", "nearest"};

constexpr Section kSections[] = {
    {"point_cloud", "How a point cloud becomes scanlines."},
    {"landmark_list", "How a list of landmarks becomes a scan."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"point_cloud.tilt_step_deg", "deg", "Without a ring field, points are grouped into scanlines of this height.",
     degrees<&Config::point_cloud, &PointCloudConfig::tilt_step_rad>(0.01, 10.0)},
    {"point_cloud.absent_is_no_return", "", "A column without a point was looked at and nothing came back.",
     boolean<&Config::point_cloud, &PointCloudConfig::absent_is_no_return>()},
    {"point_cloud.roll_deg", "deg", "Roll of the sensor, taken out of every point.",
     degrees<&Config::point_cloud, &PointCloudConfig::roll_rad>(-180.0, 180.0)},
    {"point_cloud.pitch_deg", "deg", "Pitch of the sensor, taken out of every point.",
     degrees<&Config::point_cloud, &PointCloudConfig::pitch_rad>(-90.0, 90.0)},

    {"landmark_list.order", "", "What makes a landmark heavy; the heaviest detection.landmarks_max are used.",
     choice<&Config::landmark_list, &LandmarkListConfig::order>(kOrders)},
    {"landmark_list.weight_min", "", "Rows of less weight are left out.",
     real<&Config::landmark_list, &LandmarkListConfig::weight_min>(0.0, 1e9)},
    {"landmark_list.diameter_min_m", "m", "Thinner landmarks are left out.",
     real<&Config::landmark_list, &LandmarkListConfig::diameter_min_m>(0.0, 100.0)},
    {"landmark_list.field_of_view_deg", "deg", "Of the sensor that saw them, centred on its forward axis; 0: not known.",
     degrees<&Config::landmark_list, &LandmarkListConfig::field_of_view_rad>(0.0, 360.0)},
    {"landmark_list.range_m", "m", "Up to which that sensor sees landmarks; 0: not known.",
     real<&Config::landmark_list, &LandmarkListConfig::range_m>(0.0, 2000.0)},
};
// clang-format on

}  // namespace

SettingRows input_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
