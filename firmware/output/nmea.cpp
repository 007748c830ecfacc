#include "firmware/output/nmea.hpp"

#include "core/geometry/pose2.hpp"
#include "firmware/output/nmea_sentence.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string_view>

namespace slamsensor::firmware {
namespace {

/// Columns: east, north and up at a place, in earth-centred axes.
Eigen::Matrix3d east_north_up(double latitude_deg, double longitude_deg) {
  const double phi = latitude_deg * core::kDegree;
  const double lambda = longitude_deg * core::kDegree;
  Eigen::Matrix3d axes;
  axes.col(0) << -std::sin(lambda), std::cos(lambda), 0.0;
  axes.col(1) << -std::sin(phi) * std::cos(lambda), -std::sin(phi) * std::sin(lambda), std::cos(phi);
  axes.col(2) << std::cos(phi) * std::cos(lambda), std::cos(phi) * std::sin(lambda), std::sin(phi);
  return axes;
}

/// Map axes in (east, north), x at a true bearing (clockwise from north) and y at its left.
Eigen::Matrix2d map_axes(double bearing_deg) {
  const double beta = bearing_deg * core::kDegree;
  Eigen::Matrix2d axes;
  axes.col(0) << std::sin(beta), std::cos(beta);
  axes.col(1) << -std::cos(beta), std::sin(beta);
  return axes;
}

/// True bearing of a vector in (east, north), in [0, 360).
double bearing_deg(const Eigen::Vector2d& direction_EN) {
  const double bearing = std::atan2(direction_EN.x(), direction_EN.y()) / core::kDegree;
  const double positive = bearing < 0.0 ? bearing + 360.0 : bearing;
  return positive >= 360.0 ? 0.0 : positive;
}

/// Farthest from the map's origin that a pose is written; a longer number would not fit the sentence.
constexpr double kNmeaCoordinateMax_m = 1e6;

/// Whether `fix` has a pose that can be written.
bool has_nmea_pose(const core::Fix& fix) noexcept {
  const core::Pose2& pose = fix.pose_W;
  return fix.status != core::FixStatus::NoFix && std::isfinite(pose.heading_rad) &&
         std::abs(pose.x_m) <= kNmeaCoordinateMax_m && std::abs(pose.y_m) <= kNmeaCoordinateMax_m;
}

/// All that the sentences of an epoch share.
struct NmeaEpoch {
  NmeaEpoch(const core::Fix& the_fix, const NmeaContext& the_context) noexcept
      : fix(the_fix),
        context(the_context),
        moment(the_context.moment.value_or(NmeaMoment{.utc = the_fix.time.middle_utc})),
        time(nmea_time(moment.utc)),
        pose_known(has_nmea_pose(the_fix)),
        error_known(usable_covariance(the_fix.covariance)) {
    if (context.geo != nullptr && pose_known && fix.status == core::FixStatus::Fix && !fix.is_home_replaced) {
      place = context.geo->locate(fix.pose_W);
    }
  }

  const core::Fix& fix;
  const NmeaContext& context;
  NmeaMoment moment;
  NmeaTime time;
  bool pose_known;
  bool error_known;
  std::optional<GeoPose> place;  ///< of a fix with a datum: then and only then there is a position to emit
};

/// Appends a 1 sigma error, at most 9999 m.
void add_nmea_sigma(NmeaSentence& sentence, double sigma_m, int decimals) noexcept {
  sentence.fixed(std::min(sigma_m, 9999.0), decimals);
}

/// The detail at which the pose sentence has all of its decimals; at 0 it fits whatever it says.
constexpr int kNmeaPoseDetailMax = 10;

constexpr double kAgeMax_s = 99'999.0;  // a longer number would not fit the sentence

char status_letter(const NmeaEpoch& epoch) noexcept {
  if (!epoch.pose_known) {
    return 'V';
  }
  return epoch.fix.status == core::FixStatus::Fix ? 'A' : 'U';
}

/// How many decimals the numbers of the pose have; kEmpty leaves one out.
constexpr int kEmpty = -1;
struct PoseDecimals {
  int place;
  int heading;
  int sigma;
  int heading_sigma;
  int age;
  int protection;
};

// As the sentence gets shorter: the age goes first, the place last.
constexpr std::array<PoseDecimals, kNmeaPoseDetailMax + 1> kDecimals = {{
    {0, 0, kEmpty, kEmpty, kEmpty, kEmpty},
    {0, 0, 0, 0, 0, 0},
    {1, 1, 1, 0, 0, 0},
    {2, 1, 1, 1, 0, 0},
    {2, 2, 1, 1, 0, 1},
    {3, 2, 1, 1, 0, 1},
    {3, 2, 2, 1, 0, 1},
    {3, 2, 3, 2, 0, 2},
    {3, 3, 3, 2, 0, 2},
    {3, 3, 3, 2, 1, 2},
    {3, 3, 3, 2, 2, 2},
}};

/// The field with its decimals, or empty.
void add_if_wanted(NmeaSentence& sentence, double value, int decimals) noexcept {
  if (decimals == kEmpty) {
    sentence.blank();
  } else {
    sentence.fixed(value, decimals);
  }
}

void add_map_pose(NmeaSentence& sentence, const NmeaEpoch& epoch, const PoseDecimals& decimals) noexcept {
  const core::Fix& fix = epoch.fix;
  sentence.fixed(fix.pose_W.x_m, decimals.place).fixed(fix.pose_W.y_m, decimals.place);
  sentence.wrapped(fix.pose_W.heading_rad / core::kDegree, 360, decimals.heading);
  if (epoch.error_known) {
    const Eigen::Matrix2d covariance = fix.covariance.topLeftCorner<2, 2>();
    add_if_wanted(sentence, std::min(position_error(covariance).major_m, 9999.0), decimals.sigma);
    const double sigma_heading_deg = std::sqrt(fix.covariance(2, 2)) / core::kDegree;
    add_if_wanted(sentence, std::min(sigma_heading_deg, 360.0), decimals.heading_sigma);
  } else {
    sentence.blank(2);
  }
  sentence.integer(std::min(fix.error_xi, 9999U));
}

/// The number of the map, and the protection radius, rounded up: it must not look smaller than it is.
void add_frame(NmeaSentence& sentence, const core::Fix& fix, int decimals) noexcept {
  sentence.integer(fix.map);
  const double radius_m = std::min(fix.protection_radius_m, 9999.0);
  if (!(radius_m > 0.0) || decimals == kEmpty) {
    sentence.blank();
    return;
  }
  constexpr std::array<double, 3> kUnits = {1.0, 10.0, 100.0};
  const double unit = kUnits[static_cast<std::size_t>(decimals)];
  sentence.fixed(std::ceil(radius_m * unit - 1e-6) / unit, decimals);
}

void add_age(NmeaSentence& sentence, const NmeaEpoch& epoch, int decimals) noexcept {
  if (!epoch.moment.age) {
    sentence.blank();
    return;
  }
  const double age_s = std::chrono::duration<double>(*epoch.moment.age).count();
  add_if_wanted(sentence, std::clamp(age_s, 0.0, kAgeMax_s), decimals);
}

NmeaSentence nmea_pose_sentence(const NmeaEpoch& epoch, int detail) noexcept {
  const core::Fix& fix = epoch.fix;
  const PoseDecimals& decimals = kDecimals[static_cast<std::size_t>(detail)];
  NmeaSentence sentence("PSLMA");
  sentence.text("POSE").text(epoch.time.time.text()).letter(status_letter(epoch));
  sentence.letter(epoch.context.mode == NmeaMode::Live ? 'A' : 'S');
  sentence.integer(static_cast<std::uint64_t>(fix.reason));
  if (epoch.pose_known) {
    add_map_pose(sentence, epoch, decimals);
  } else {
    sentence.blank(6);
  }
  sentence.integer(std::min(fix.matches, 999U)).integer(std::min(fix.landmarks_seen, 999U));
  add_age(sentence, epoch, decimals.age);
  if (epoch.pose_known) {
    add_frame(sentence, fix, decimals.protection);
  } else {
    sentence.blank(2);
  }
  return sentence;
}

constexpr int kMinuteDecimals = 7;
constexpr double kDilutionMin = 0.01;  // some readers take 0 as absent
constexpr double kDilutionMax = 99.99;

/// A sentence of the context's talker.
NmeaSentence talker_sentence(const NmeaEpoch& epoch, std::string_view type) noexcept {
  const std::array<char, 5> address = {epoch.context.talker[0], epoch.context.talker[1], type[0], type[1],
                                       type[2]};
  return NmeaSentence({address.data(), address.size()});
}

/// The same, beginning with the time of the epoch.
NmeaSentence timed_sentence(const NmeaEpoch& epoch, std::string_view type) noexcept {
  return talker_sentence(epoch, type).text(epoch.time.time.text());
}

struct QualityCode {
  std::uint64_t gga;
  char rmc;
};

QualityCode quality_code(const NmeaContext& context) noexcept {
  if (context.mode == NmeaMode::Simulated) {
    return {8, 'S'};
  }
  switch (context.quality) {
    case NmeaQuality::RtkFixed:
      return {4, 'R'};
    case NmeaQuality::RtkFloat:
      return {5, 'F'};
    case NmeaQuality::Autonomous:
      break;
  }
  return {1, 'A'};
}

void add_position(NmeaSentence& sentence, const GeoPose& place, int decimals) noexcept {
  const NmeaAngle latitude = nmea_angle(place.latitude_deg, 2, decimals);
  const NmeaAngle longitude = nmea_angle(place.longitude_deg, 3, decimals);
  sentence.text(latitude.field.text()).letter(latitude.negative ? 'S' : 'N');
  sentence.text(longitude.field.text()).letter(longitude.negative ? 'W' : 'E');
}

/// Landmark dilution of precision: sigma of the position over sigma of a landmark.
double dilution(const NmeaEpoch& epoch) noexcept {
  const Eigen::Matrix3d& covariance = epoch.fix.covariance;
  const double sigma_m = std::sqrt(covariance(0, 0) + covariance(1, 1));
  return std::clamp(sigma_m / epoch.context.landmark_sigma_m, kDilutionMin, kDilutionMax);
}

NmeaSentence rmc(const NmeaEpoch& epoch, int decimals) noexcept {
  NmeaSentence sentence = timed_sentence(epoch, "RMC");
  if (epoch.place) {
    sentence.letter('A');
    add_position(sentence, *epoch.place, decimals);
  } else {
    sentence.letter('V').blank(4);
  }
  sentence.blank(2).text(epoch.time.date.text()).blank(2);
  return sentence.letter(epoch.place ? quality_code(epoch.context).rmc : 'N');
}

NmeaSentence gga(const NmeaEpoch& epoch, int decimals) noexcept {
  NmeaSentence sentence = timed_sentence(epoch, "GGA");
  if (!epoch.place) {
    return sentence.blank(4).integer(0).integer(0, 2).blank(7);
  }
  add_position(sentence, *epoch.place, decimals);
  sentence.integer(quality_code(epoch.context).gga).integer(std::min(epoch.fix.matches, 99U), 2);
  if (epoch.error_known) {
    sentence.fixed(dilution(epoch), 2);
  } else {
    sentence.blank();
  }
  return sentence.fixed(epoch.context.geo->datum().height_m, 2)
      .letter('M')
      .fixed(0.0, 1)
      .letter('M')
      .blank(2);
}

/// The position's error on true east and north, if there is a position and its error is known.
std::optional<PositionError> geographic_error(const NmeaEpoch& epoch) noexcept {
  if (!epoch.place || !epoch.error_known) {
    return std::nullopt;
  }
  const Eigen::Matrix2d& R_EN_W = epoch.place->R_EN_W;
  const Eigen::Matrix2d covariance_W = epoch.fix.covariance.topLeftCorner<2, 2>();
  return position_error(R_EN_W * covariance_W * R_EN_W.transpose());
}

NmeaSentence gbs(const NmeaEpoch& epoch, int decimals) noexcept {
  NmeaSentence sentence = timed_sentence(epoch, "GBS");
  const std::optional<PositionError> error = geographic_error(epoch);
  if (!error) {
    return sentence.blank(7);
  }
  add_nmea_sigma(sentence, error->north_m, decimals);
  add_nmea_sigma(sentence, error->east_m, decimals);
  return sentence.blank(5);
}

NmeaSentence hdt(const NmeaEpoch& epoch, int decimals) noexcept {
  return talker_sentence(epoch, "HDT").wrapped(epoch.place->true_heading_deg, 360, decimals).letter('T');
}

NmeaSentence ths(const NmeaEpoch& epoch, int decimals) noexcept {
  NmeaSentence sentence = talker_sentence(epoch, "THS");
  if (!epoch.place) {
    return sentence.blank().letter('V');
  }
  sentence.wrapped(epoch.place->true_heading_deg, 360, decimals);
  return sentence.letter(epoch.context.mode == NmeaMode::Live ? 'A' : 'S');
}

NmeaSentence gst(const NmeaEpoch& epoch, int decimals) noexcept {
  NmeaSentence sentence = timed_sentence(epoch, "GST");
  const std::optional<PositionError> error = geographic_error(epoch);
  if (!error) {
    return sentence.blank(7);
  }
  add_nmea_sigma(sentence, epoch.context.landmark_sigma_m, decimals);
  add_nmea_sigma(sentence, error->major_m, decimals);
  add_nmea_sigma(sentence, error->minor_m, decimals);
  sentence.wrapped(error->major_bearing_deg, 180, 1);
  add_nmea_sigma(sentence, error->north_m, decimals);
  add_nmea_sigma(sentence, error->east_m, decimals);
  return sentence.blank();
}

NmeaSentence zda(const NmeaEpoch& epoch, int) noexcept {
  NmeaSentence sentence = timed_sentence(epoch, "ZDA");
  sentence.integer(epoch.time.day, 2).integer(epoch.time.month, 2);
  return sentence.integer(static_cast<std::uint64_t>(std::max(epoch.time.year, 0)), 4).text("00").text("00");
}

/// The bytes written so far of an epoch. `out` has room for all.
class EpochWriter {
 public:
  EpochWriter(const NmeaEpoch& epoch, std::span<char> out) noexcept : epoch_(epoch), out_(out) {}

  /// Adds the sentence that `make` gives with as many decimals as the length allows.
  void add(NmeaSentence (*make)(const NmeaEpoch&, int) noexcept, int decimals) noexcept {
    for (; decimals >= 0; --decimals) {
      NmeaSentence sentence = make(epoch_, decimals);
      const std::string_view line = sentence.finish();
      if (!line.empty()) {
        std::copy(line.begin(), line.end(), out_.data() + size_);
        size_ += line.size();
        return;
      }
    }
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  const NmeaEpoch& epoch_;
  std::span<char> out_;
  std::size_t size_ = 0;
};

}  // namespace

GeoReference::GeoReference(const Datum& datum)
    : datum_(datum),
      plane_(datum.latitude_deg, datum.longitude_deg, datum.height_m),
      R_plane_W_(map_axes(datum.bearing_deg)),
      R_earth_plane_(east_north_up(datum.latitude_deg, datum.longitude_deg)) {
}

GeoPose GeoReference::locate(const core::Pose2& T_W_L) const noexcept {
  const Eigen::Vector2d p_plane = R_plane_W_ * T_W_L.translation();
  GeoPose place;
  plane_.Reverse(p_plane.x(), p_plane.y(), 0.0, place.latitude_deg, place.longitude_deg, place.height_m);
  const Eigen::Matrix3d R_earth_EN = east_north_up(place.latitude_deg, place.longitude_deg);
  const Eigen::Matrix3d R_EN_plane = R_earth_EN.transpose() * R_earth_plane_;
  place.R_EN_W = R_EN_plane.topLeftCorner<2, 2>() * R_plane_W_;
  const Eigen::Vector2d forward_W(std::cos(T_W_L.heading_rad), std::sin(T_W_L.heading_rad));
  place.true_heading_deg = bearing_deg(place.R_EN_W * forward_W);
  return place;
}

PositionError position_error(const Eigen::Matrix2d& covariance_m2) noexcept {
  const double east = covariance_m2(0, 0);
  const double north = covariance_m2(1, 1);
  const double cross = 0.5 * (covariance_m2(0, 1) + covariance_m2(1, 0));
  const double mean = 0.5 * (east + north);
  const double radius = std::hypot(0.5 * (east - north), cross);  // of Mohr's circle
  // The major axis lies at angle a from north towards east with tan 2a = 2 cross / (north - east).
  double bearing_deg = 0.5 * std::atan2(2.0 * cross, north - east) * 180.0 / std::numbers::pi;
  bearing_deg += bearing_deg < 0.0 ? 180.0 : 0.0;
  PositionError error;
  error.east_m = std::sqrt(std::max(east, 0.0));
  error.north_m = std::sqrt(std::max(north, 0.0));
  error.major_m = std::sqrt(std::max(mean + radius, 0.0));
  error.minor_m = std::sqrt(std::max(mean - radius, 0.0));
  error.major_bearing_deg = bearing_deg >= 180.0 ? 0.0 : bearing_deg;
  return error;
}

bool usable_covariance(const Eigen::Matrix3d& covariance) noexcept {
  return covariance.allFinite() && covariance.diagonal().minCoeff() >= 0.0;
}

NmeaContext nmea_context(const NmeaConfig& config, const GeoReference* geo, NmeaMode mode) noexcept {
  NmeaContext context;
  if (config.talker.size() == context.talker.size()) {
    std::copy(config.talker.begin(), config.talker.end(), context.talker.begin());
  }
  context.mode = mode;
  context.quality = config.quality;
  context.landmark_sigma_m = config.landmark_sigma_m;
  context.sentences = config.sentences;
  context.zda = config.zda;
  context.geo = geo;
  return context;
}

std::size_t format_nmea(const core::Fix& fix, const NmeaContext& context, std::span<char> out) noexcept {
  if (out.size() < kNmeaEpochBytesMax) {
    return 0;
  }
  const NmeaEpoch epoch(fix, context);
  EpochWriter writer(epoch, out);
  const auto add = [&writer](bool wanted, auto* make, int decimals) {
    if (wanted) {
      writer.add(make, decimals);
    }
  };
  const NmeaSentences& wanted = context.sentences;
  add(wanted.rmc, rmc, kMinuteDecimals);
  add(wanted.gga, gga, kMinuteDecimals);
  add(wanted.gbs, gbs, 3);
  add(wanted.hdt && epoch.place, hdt, 2);
  add(wanted.ths, ths, 2);
  add(wanted.gst, gst, 3);
  add(context.zda, zda, 0);
  add(wanted.pslma, nmea_pose_sentence, kNmeaPoseDetailMax);
  return writer.size();
}

}  // namespace slamsensor::firmware
