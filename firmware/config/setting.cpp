#include "firmware/config/setting.hpp"

#include "core/limits.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

namespace slamsensor::firmware {
namespace {

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// Follows a chain of members for writing; an optional on the way is filled when it is empty.
template <auto kFirst, auto... kRest, typename Struct>
auto* write_path(Struct& object) {
  auto& member = object.*kFirst;
  if constexpr (sizeof...(kRest) == 0) {
    return &member;
  } else if constexpr (IsOptional<std::remove_cvref_t<decltype(member)>>::value) {
    return write_path<kRest...>(member ? *member : member.emplace());
  } else {
    return write_path<kRest...>(member);
  }
}

/// Follows a chain of members for reading; null when an optional on the way is empty.
template <auto kFirst, auto... kRest, typename Struct>
auto read_path(const Struct& object) {
  const auto& member = object.*kFirst;
  if constexpr (sizeof...(kRest) == 0) {
    return &member;
  } else if constexpr (IsOptional<std::remove_cvref_t<decltype(member)>>::value) {
    using Pointer = decltype(read_path<kRest...>(*member));
    return member ? read_path<kRest...>(*member) : Pointer{nullptr};
  } else {
    return read_path<kRest...>(member);
  }
}

template <typename T, auto... kPath>
constexpr Member<T> member_at() {
  return {[](Config& config) -> T* { return write_path<kPath...>(config); },
          [](const Config& config) -> const T* { return read_path<kPath...>(config); }};
}

template <auto... kPath>
constexpr RealSetting real(double min, double max) {
  return {member_at<double, kPath...>(), min, max, 1.0};
}

/// Degrees in the file, radians in the program.
template <auto... kPath>
constexpr RealSetting degrees(double min_deg, double max_deg) {
  return {member_at<double, kPath...>(), min_deg, max_deg, core::kDegree};
}

template <auto... kPath>
constexpr IntegerSetting integer(std::uint32_t min, std::uint32_t max) {
  return {member_at<std::uint32_t, kPath...>(), min, max};
}

template <auto... kPath>
constexpr BooleanSetting boolean() {
  return {member_at<bool, kPath...>()};
}

template <auto... kPath>
constexpr TextSetting text(std::span<const std::string_view> names) {
  return {member_at<std::string, kPath...>(), names};
}

template <auto... kPath>
constexpr ChoiceSetting choice(std::span<const std::string_view> names) {
  using Pointer = decltype(write_path<kPath...>(std::declval<Config&>()));
  using Enum = std::remove_pointer_t<Pointer>;
  static_assert(std::is_enum_v<Enum>);
  return {[](Config& config, std::size_t i) { *write_path<kPath...>(config) = static_cast<Enum>(i); },
          [](const Config& config) { return static_cast<std::size_t>(*read_path<kPath...>(config)); }, names};
}

// Names of the enumerators, in their order.
constexpr std::string_view kPoints[] = {"hull_centroid", "reading_mean"};
constexpr std::string_view kFits[] = {"least_squares", "robust"};
constexpr std::string_view kRanks[] = {"significance", "matches"};
constexpr std::string_view kRules[] = {"computed", "paper"};
constexpr std::string_view kUpdates[] = {"paper", "mean"};
constexpr std::string_view kOrders[] = {"weight", "diameter", "nearest"};
constexpr std::string_view kQualities[] = {"autonomous", "rtk_fixed", "rtk_float"};
// Talkers that gpsd and the other readers of DESIGN 4 recognise.
constexpr std::string_view kTalkers[] = {"GP", "GN", "IN", "GA", "II", "EC"};

constexpr Section kSections[] = {
    {"mount",
     "Where the sensor sits on what carries it. Fixes and maps are the carrier's; all 0: the sensor's own.",
     false},
    {"detection", "Landmark detection: from the readings of a scan to at most landmarks_max points.", false},
    {"association", "Data association: which scan landmark is which map landmark, no pose known.", false},
    {"acceptance", "When an associated pose is believed.", false},
    {"mapping", "Hypotheses, and how the map follows what was seen.", false},
    {"capacities", "What memory is taken for at start; 'slamsensor memory' prints the plan.", false},
    {"point_cloud", "How a point cloud becomes scanlines.", false},
    {"landmark_list", "How a list of landmarks becomes a scan.", false},
    {"nmea", "NMEA 0183 output.", false},
    {"datum", "Ties the map frame to the earth. Without it no latitude or longitude is ever emitted.", true},
};

constexpr auto kCore = &Config::core;
constexpr auto kMount = &core::Config::mount;
constexpr auto kDetection = &core::Config::detection;
constexpr auto kAssociation = &core::Config::association;
constexpr auto kAcceptance = &core::Config::acceptance;
constexpr auto kMapping = &core::Config::mapping;
constexpr auto kCapacities = &core::Config::capacities;
using core::AcceptanceConfig;
using core::AssociationConfig;
using core::Capacities;
using core::DetectionConfig;
using core::MappingConfig;
using core::MountConfig;

// clang-format off
const Setting kSettings[] = {
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

    {"acceptance.rule", "", "A computed bound on chance (product), or the largest W wins (paper; overlap is assumed).",
     choice<kCore, kAcceptance, &AcceptanceConfig::rule>(kRules)},
    {"acceptance.false_alarm_risk", "", "Accepted number of chance poses as good as the answer, per scan.",
     real<kCore, kAcceptance, &AcceptanceConfig::false_alarm_risk>(1e-12, 1.0)},
    {"acceptance.ambiguity_risk", "", "Accepted chance that a rival pose elsewhere is the true one.",
     real<kCore, kAcceptance, &AcceptanceConfig::ambiguity_risk>(1e-12, 1.0)},
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
    {"capacities.path_poses", "", "Poses of a hypothesis' path.",
     integer<kCore, kCapacities, &Capacities::path_poses>(1, 10'000'000)},

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

    {"nmea.talker", "", "First two letters of every sentence.",
     text<&Config::nmea, &NmeaConfig::talker>(kTalkers)},
    {"nmea.quality", "", "What a live fix calls itself: GGA quality and RMC mode 1 A, 4 R or 5 F.",
     choice<&Config::nmea, &NmeaConfig::quality>(kQualities)},
    {"nmea.zda", "", "Date and time also as a ZDA sentence, once a second.",
     boolean<&Config::nmea, &NmeaConfig::zda>()},
    {"nmea.landmark_sigma_m", "m", "1 sigma of a landmark's place: the unit of HDOP, and the RMS of GST.",
     real<&Config::nmea, &NmeaConfig::landmark_sigma_m>(0.001, 100.0)},

    {"datum.latitude_deg", "deg", "Latitude of the map's origin, WGS 84, north positive.",
     real<&Config::datum, &Datum::latitude_deg>(-90.0, 90.0)},
    {"datum.longitude_deg", "deg", "Longitude of the map's origin, east positive.",
     real<&Config::datum, &Datum::longitude_deg>(-180.0, 180.0)},
    {"datum.height_m", "m", "Height of the map's plane above the ellipsoid; the altitude of GGA.",
     real<&Config::datum, &Datum::height_m>(-1000.0, 10'000.0)},
    {"datum.bearing_deg", "deg", "True bearing of the map's x axis, clockwise from north (90: x is east, y north).",
     real<&Config::datum, &Datum::bearing_deg>(0.0, 360.0)},
};
// clang-format on

}  // namespace

std::span<const Section> sections() {
  return kSections;
}

std::span<const Setting> settings() {
  return kSettings;
}

std::optional<std::size_t> find_setting(std::string_view path) {
  const auto found = std::find_if(std::begin(kSettings), std::end(kSettings),
                                  [&](const Setting& setting) { return setting.path == path; });
  if (found == std::end(kSettings)) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - std::begin(kSettings));
}

const Section* find_section(std::string_view name) {
  const auto found = std::find_if(std::begin(kSections), std::end(kSections),
                                  [&](const Section& section) { return section.name == name; });
  return found == std::end(kSections) ? nullptr : found;
}

}  // namespace slamsensor::firmware
