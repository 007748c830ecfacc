#include "core/limits.hpp"
#include "firmware/config/rows/setting_rows.hpp"

#include <string_view>

namespace slamsensor::firmware {
namespace {

using namespace rows;
using core::AcceptanceConfig;
using core::AssociationConfig;
using core::Capacities;
using core::DetectionConfig;
using core::MappingConfig;
using core::MountConfig;

// Lists of names are those of the enumerators, in their order.

constexpr std::string_view kModes[] = {"continuous", "single", "one_shot"};
constexpr auto kScanHead = &Config::scan_head;

constexpr std::string_view kPoints[] = {"hull_centroid", "reading_mean"};
constexpr std::string_view kFits[] = {"least_squares", "robust"};
constexpr std::string_view kRanks[] = {"significance", "matches"};
constexpr std::string_view kRules[] = {"evidence", "paper"};
constexpr std::string_view kSearches[] = {"fast", "paper"};
constexpr std::string_view kUpdates[] = {"paper", "mean"};
constexpr auto kCore = &Config::core;
constexpr auto kMount = &core::Config::mount;
constexpr auto kDetection = &core::Config::detection;
constexpr auto kAssociation = &core::Config::association;
constexpr auto kAcceptance = &core::Config::acceptance;
constexpr auto kMapping = &core::Config::mapping;
constexpr auto kCapacities = &core::Config::capacities;

constexpr std::string_view kOrders[] = {"weight", "diameter", "nearest"};

constexpr Section kSections[] = {
    {"scan", "What is swept, and how. Defaults: experiments I and II of the paper, 51 scanlines of 5 s."},
    {"latency", "How the constant latency between the two devices is found by the sensor itself."},
    {"motion",
     "How a scan is recognised that was not made from one place, because the carrier moved meanwhile."},
    {"mount",
     "Where the sensor sits on what carries it. Fixes and maps are the carrier's; all 0: the sensor's own."},
    {"detection", "Landmark detection: from the readings of a scan to at most landmarks_max points."},
    {"association", "Data association: which scan landmark is which map landmark, no pose known."},
    {"acceptance", "When an associated pose is believed."},
    {"mapping", "Hypotheses, and how the map follows what was seen."},
    {"capacities", "What memory is taken for at start; 'slamsensor memory' prints the plan."},
    {"point_cloud", "How a point cloud becomes scanlines."},
    {"landmark_list", "How a list of landmarks becomes a scan."},
};

// clang-format off
constexpr Setting kSettings[] = {
    {"scan.pan_min_deg", "deg", "Right end of a scanline; pan is positive to the left.",
     degrees<kScanHead, &SensorHeadConfig::scan, &ScanConfig::pan_min_rad>(-180.0, 180.0)},
    {"scan.pan_max_deg", "deg", "Left end of a scanline.",
     degrees<kScanHead, &SensorHeadConfig::scan, &ScanConfig::pan_max_rad>(-180.0, 180.0)},
    {"scan.tilt_min_deg", "deg", "Lowest scanline; tilt is positive upwards.",
     degrees<kScanHead, &SensorHeadConfig::scan, &ScanConfig::tilt_min_rad>(-90.0, 90.0)},
    {"scan.tilt_max_deg", "deg", "Highest scanline.",
     degrees<kScanHead, &SensorHeadConfig::scan, &ScanConfig::tilt_max_rad>(-90.0, 90.0)},
    {"scan.tilt_step_deg", "deg", "From one scanline to the next.",
     degrees<kScanHead, &SensorHeadConfig::scan, &ScanConfig::tilt_step_rad>(0.001, 90.0)},
    {"scan.pan_speed_deg_s", "deg/s", "Speed of a sweep; at most the unit's.",
     degrees<kScanHead, &SensorHeadConfig::scan, &ScanConfig::pan_speed_radps>(0.1, 1000.0)},
    {"scan.tilt_speed_deg_s", "deg/s", "Speed from one scanline to the next; at most the unit's.",
     degrees<kScanHead, &SensorHeadConfig::scan, &ScanConfig::tilt_speed_radps>(0.1, 1000.0)},
    {"scan.mode", "", "One scan after the other; one for each request; or one at start and then for each request.",
     choice<kScanHead, &SensorHeadConfig::scan, &ScanConfig::mode>(kModes), Apply::Live},
    {"scan.calibration_lines", "", "Even: scanlines swept at start-up at one tilt, to find the latency between the devices.",
     integer<kScanHead, &SensorHeadConfig::scan, &ScanConfig::calibration_lines>(0, 100)},
    {"scan.settle_s", "s", "From the arrival of both axes to the sweep.",
     real<kScanHead, &SensorHeadConfig::scan, &ScanConfig::settle_s>(0.0, 10.0)},
    {"scan.late_data_s", "s", "How long data of an ended line may be under way.",
     real<kScanHead, &SensorHeadConfig::scan, &ScanConfig::late_data_s>(0.0, 10.0)},
    {"scan.readings_per_line_max", "", "Room for the readings of a line; 56 bytes each.",
     integer<kScanHead, &SensorHeadConfig::scan, &ScanConfig::readings_per_line_max>(100, 2'000'000)},

    {"latency.self_calibration", "", "Whether the latency between the devices is found from opposite sweeps; else initial_s counts.",
     boolean<kScanHead, &SensorHeadConfig::latency, &LatencyConfig::self_calibration>()},
    {"latency.initial_s", "s", "Added to a reading's time until something better is known.",
     real<kScanHead, &SensorHeadConfig::latency, &LatencyConfig::initial_s>(-0.5, 0.5)},
    {"latency.range_max_m", "m", "For this, what is farther counts as no return.",
     real<kScanHead, &SensorHeadConfig::latency, &LatencyConfig::range_max_m>(1.0, 10'000.0)},

    {"motion.enabled", "", "Whether a scan during which the carrier moved is recognised and rejected.",
     boolean<kScanHead, &SensorHeadConfig::motion, &MotionConfig::enabled>()},

    {"mount.x_m", "m", "Forward from the carrier's reference point to the sensor.",
     real<kCore, kMount, &MountConfig::x_m>(-100.0, 100.0)},
    {"mount.y_m", "m", "To the left from the carrier's reference point to the sensor.",
     real<kCore, kMount, &MountConfig::y_m>(-100.0, 100.0)},
    {"mount.heading_deg", "deg", "The sensor's forward axis, counter-clockwise from the carrier's.",
     degrees<kCore, kMount, &MountConfig::heading_rad>(-360.0, 360.0)},

    {"detection.range_min_m", "m", "Nearer returns are the carrier itself: their column counts as not looked at.",
     real<kCore, kDetection, &DetectionConfig::range_min_m>(0.0, 100.0)},
    {"detection.range_max_m", "m", "d_max: a return beyond it counts as no return.",
     real<kCore, kDetection, &DetectionConfig::range_max_m>(1.0, 2000.0)},
    {"detection.range_step_m", "m", "delta_d: height of a cell of the spiderweb grid.",
     real<kCore, kDetection, &DetectionConfig::range_step_m>(0.01, 10.0)},
    {"detection.bearing_step_deg", "deg", "delta_theta: width of a cell of the spiderweb grid.",
     degrees<kCore, kDetection, &DetectionConfig::bearing_step_rad>(0.01, 10.0)},
    {"detection.tilt_min_deg", "deg", "Scanlines below this tilt are left out (up is positive).",
     degrees<kCore, kDetection, &DetectionConfig::tilt_min_rad>(-90.0, 90.0)},
    {"detection.tilt_max_deg", "deg", "Scanlines above this tilt are left out.",
     degrees<kCore, kDetection, &DetectionConfig::tilt_max_rad>(-90.0, 90.0)},
    {"detection.discard_share", "", "Share of the readings dropped at each end of a scanline; 0 for a full turn.",
     real<kCore, kDetection, &DetectionConfig::discard_share>(0.0, 0.45)},
    {"detection.landmarks_max", "", "m_k: the heaviest landmarks of a scan that are kept; 0: 30 of readings, 60 of a list.",
     integer<kCore, kDetection, &DetectionConfig::landmarks_max>(0, core::kScanLandmarksMax)},
    {"detection.point", "", "What stands for a landmark: the centroid of its cells' hull, or the mean of its readings.",
     choice<kCore, kDetection, &DetectionConfig::point>(kPoints)},

    {"association.tolerance_m", "m", "epsilon: edge lengths and landmark places agree within it.",
     real<kCore, kAssociation, &AssociationConfig::tolerance_m>(0.01, 20.0)},
    {"association.search", "", "By an index of triangles (fast), or by the correspondence graph (paper).",
     choice<kCore, kAssociation, &AssociationConfig::search>(kSearches)},
    {"association.effort_max", "", "Fast search: about the nanoseconds of work after which it gives up, whatever the clock says.",
     integer<kCore, kAssociation, &AssociationConfig::effort_max>(100'000, 1'000'000'000'000)},
    {"association.depth", "", "Edges join landmarks up to this many mesh steps apart.",
     integer<kCore, kAssociation, &AssociationConfig::depth>(1, 20)},
    {"association.order_share", "", "Share of the vertex order that is searched for triangles; 1 is exhaustive.",
     real<kCore, kAssociation, &AssociationConfig::order_share>(0.0001, 1.0)},
    {"association.fit", "", "Every match counts alike in the pose (paper), or those far off hardly count.",
     choice<kCore, kAssociation, &AssociationConfig::fit>(kFits)},
    {"association.rank", "", "The candidate that chance explains least leads, or the one with most matches (paper).",
     choice<kCore, kAssociation, &AssociationConfig::rank>(kRanks)},
    {"association.exhaust_when_unsure", "", "Go on to the end of the order when the share gave no clear answer.",
     boolean<kCore, kAssociation, &AssociationConfig::exhaust_when_unsure>()},

    {"acceptance.rule", "", "The evidence for and against a pose (product), or the largest W wins (paper; overlap is assumed).",
     choice<kCore, kAcceptance, &AcceptanceConfig::rule>(kRules)},
    {"acceptance.risk", "", "Expected wrong fixes per scan that are taken.",
     real<kCore, kAcceptance, &AcceptanceConfig::risk>(1e-12, 0.1)},
    {"acceptance.copy_size_m", "m", "The largest thing that comes in copies; 0: 15 m in a driven map, less for a short reach. Small sites need less: see the README.",
     real<kCore, kAcceptance, &AcceptanceConfig::copy_size_m>(0.0, 1000.0)},

    {"mapping.hypotheses_max", "", "Lambda_max: hypotheses kept, each with a map of its own.",
     integer<kCore, kMapping, &MappingConfig::hypotheses_max>(1, core::kHypothesesMax)},
    {"mapping.update", "", "A matched landmark moves to its newly seen place (Algorithm 1), or to its sightings' mean.",
     choice<kCore, kMapping, &MappingConfig::update>(kUpdates)},
    {"mapping.propagate_corrections", "", "A moved landmark's correction also moves those triangulated from it.",
     boolean<kCore, kMapping, &MappingConfig::propagate_corrections>()},
    {"mapping.prune_share", "", "Landmarks seen in a smaller share of their chances are forgotten; 0 is never.",
     real<kCore, kMapping, &MappingConfig::prune_share>(0.0, 1.0)},

    {"capacities.occupied_cells", "", "Cells of the spiderweb grid that a scan can occupy.",
     integer<kCore, kCapacities, &Capacities::occupied_cells>(100, 20'000'000)},
    {"capacities.scan_landmarks", "", "Landmarks of a scan that association can take.",
     integer<kCore, kCapacities, &Capacities::scan_landmarks>(3, core::kScanLandmarksMax)},
    {"capacities.map_landmarks", "", "Landmarks of a hypothesis' map.",
     integer<kCore, kCapacities, &Capacities::map_landmarks>(3, 1'000'000)},
    {"capacities.map_edges", "", "Edges of a map's graph; about 10 for a landmark at depth 2.",
     integer<kCore, kCapacities, &Capacities::map_edges>(3, 1'000'000'000)},
    {"capacities.path_poses", "", "Poses of the path that are kept.",
     integer<kCore, kCapacities, &Capacities::path_poses>(1, 10'000'000)},
    {"capacities.sightings", "", "Landmarks in scans that the refinement keeps; about 10 for a landmark.",
     integer<kCore, kCapacities, &Capacities::sightings>(100, 100'000'000)},

    {"point_cloud.tilt_step_deg", "deg", "Without a ring field, points are grouped into scanlines of this height.",
     degrees<&Config::point_cloud, &PointCloudConfig::tilt_step_rad>(0.01, 10.0)},
    {"point_cloud.absent_is_no_return", "", "A column without a point was looked at and nothing came back.",
     boolean<&Config::point_cloud, &PointCloudConfig::absent_is_no_return>()},
    {"point_cloud.roll_deg", "deg", "Roll of the sensor, taken out of every point.",
     degrees<&Config::point_cloud, &PointCloudConfig::roll_rad>(-180.0, 180.0)},
    {"point_cloud.pitch_deg", "deg", "Pitch of the sensor, taken out of every point.",
     degrees<&Config::point_cloud, &PointCloudConfig::pitch_rad>(-90.0, 90.0)},

    {"landmark_list.order", "", "What makes a landmark heavy; the heaviest detection.landmarks_max are used, of equal ones the nearest.",
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

SettingRows method_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
