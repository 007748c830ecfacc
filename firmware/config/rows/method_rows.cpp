#include "core/limits.hpp"
#include "firmware/config/rows/setting_path.hpp"
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

// Names of the enumerators, in their order.
constexpr std::string_view kPoints[] = {"hull_centroid", "reading_mean"};
constexpr std::string_view kFits[] = {"least_squares", "robust"};
constexpr std::string_view kRanks[] = {"significance", "matches"};
constexpr std::string_view kRules[] = {"evidence", "paper"};
constexpr std::string_view kSearches[] = {"fast", "paper"};
constexpr std::string_view kUpdates[] = {"paper", "mean"};

constexpr Section kSections[] = {
    {"mount",
     "Where the sensor sits on what carries it. Fixes and maps are the carrier's; all 0: the sensor's own."},
    {"detection", "Landmark detection: from the readings of a scan to at most landmarks_max points."},
    {"association", "Data association: which scan landmark is which map landmark, no pose known."},
    {"acceptance", "When an associated pose is believed."},
    {"mapping", "Hypotheses, and how the map follows what was seen."},
    {"capacities", "What memory is taken for at start; 'slamsensor memory' prints the plan."},
};

constexpr auto kCore = &Config::core;
constexpr auto kMount = &core::Config::mount;
constexpr auto kDetection = &core::Config::detection;
constexpr auto kAssociation = &core::Config::association;
constexpr auto kAcceptance = &core::Config::acceptance;
constexpr auto kMapping = &core::Config::mapping;
constexpr auto kCapacities = &core::Config::capacities;

// clang-format off
constexpr Setting kSettings[] = {
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
    {"detection.landmarks_max", "", "m_k: the heaviest landmarks of a scan that are kept.",
     integer<kCore, kDetection, &DetectionConfig::landmarks_max>(3, core::kScanLandmarksMax)},
    {"detection.point", "", "What stands for a landmark: the centroid of its cells' hull, or the mean of its readings.",
     choice<kCore, kDetection, &DetectionConfig::point>(kPoints)},

    {"association.tolerance_m", "m", "epsilon: edge lengths and landmark places agree within it.",
     real<kCore, kAssociation, &AssociationConfig::tolerance_m>(0.01, 20.0)},
    {"association.search", "", "By an index of triangles (fast), or by the correspondence graph (paper).",
     choice<kCore, kAssociation, &AssociationConfig::search>(kSearches)},
    {"association.index_neighbours", "", "Fast search: neighbours that a landmark forms triangles with; fewer take less memory.",
     integer<kCore, kAssociation, &AssociationConfig::index_neighbours>(3, 8)},
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
    {"association.landmarks_min", "", "A scan with fewer landmarks is not searched.",
     integer<kCore, kAssociation, &AssociationConfig::landmarks_min>(3, core::kScanLandmarksMax)},

    {"acceptance.rule", "", "The evidence for and against a pose (product), or the largest W wins (paper; overlap is assumed).",
     choice<kCore, kAcceptance, &AcceptanceConfig::rule>(kRules)},
    {"acceptance.risk", "", "Expected wrong fixes per scan that are taken.",
     real<kCore, kAcceptance, &AcceptanceConfig::risk>(1e-12, 0.1)},
    {"acceptance.copy_size_m", "m", "The largest thing that comes in copies; 0: 15 m in a map in the making.",
     real<kCore, kAcceptance, &AcceptanceConfig::copy_size_m>(0.0, 1000.0)},
    {"acceptance.elsewhere_m", "m", "A pose farther from the answer than this is elsewhere: one of the two is wrong.",
     real<kCore, kAcceptance, &AcceptanceConfig::elsewhere_m>(0.001, 1000.0)},
    {"acceptance.elsewhere_deg", "deg", "So is a pose turned by more than this.",
     degrees<kCore, kAcceptance, &AcceptanceConfig::elsewhere_rad>(0.001, 180.0)},

    {"mapping.hypotheses_max", "", "Lambda_max: hypotheses kept, each with a map of its own.",
     integer<kCore, kMapping, &MappingConfig::hypotheses_max>(1, core::kHypothesesMax)},
    {"mapping.update", "", "A matched landmark moves to its newly seen place (Algorithm 1), or to its sightings' mean.",
     choice<kCore, kMapping, &MappingConfig::update>(kUpdates)},
    {"mapping.propagate_corrections", "", "A moved landmark's correction also moves those triangulated from it.",
     boolean<kCore, kMapping, &MappingConfig::propagate_corrections>()},
    {"mapping.prune_share", "", "Landmarks seen in a smaller share of their chances are forgotten; 0 is never.",
     real<kCore, kMapping, &MappingConfig::prune_share>(0.0, 1.0)},
    {"mapping.prune_chances_min", "", "But not before this many chances.",
     integer<kCore, kMapping, &MappingConfig::prune_chances_min>(1, 1'000'000)},

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
};
// clang-format on

}  // namespace

SettingRows method_rows() {
  return {kSections, kSettings};
}

}  // namespace slamsensor::firmware
