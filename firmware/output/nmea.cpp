#include "firmware/output/nmea.hpp"

#include "firmware/output/position_error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace slamsensor::firmware {
namespace {

constexpr int kMinuteDecimals = 7;
constexpr int kMapDecimals = 3;
constexpr double kDilutionMin = 0.01;        // some readers take 0 as absent
constexpr double kDilutionMax = 99.99;       // what receivers write without a fix
constexpr double kSigmaMax_m = 9999.0;       // written for anything larger
constexpr double kMapCoordinateMax_m = 1e7;  // no map reaches round the earth

bool has_pose(const core::Fix& fix) noexcept {
  const core::Pose2& pose = fix.pose_W;
  return fix.status != core::FixStatus::NoFix && std::isfinite(pose.heading_rad) &&
         std::abs(pose.x_m) <= kMapCoordinateMax_m && std::abs(pose.y_m) <= kMapCoordinateMax_m;
}

/// All that the sentences of an epoch share.
struct Epoch {
  Epoch(const core::Fix& the_fix, const NmeaContext& the_context) noexcept
      : fix(the_fix),
        context(the_context),
        time(nmea_time(the_fix.time.middle_utc)),
        pose_known(has_pose(the_fix)),
        error_known(usable_covariance(the_fix.covariance)) {
    if (context.geo != nullptr && pose_known && fix.status == core::FixStatus::Fix) {
      place = context.geo->locate(fix.pose_W);
    }
  }

  const core::Fix& fix;
  const NmeaContext& context;
  NmeaTime time;
  bool pose_known;
  bool error_known;
  std::optional<GeoPose> place;  ///< of a fix with a datum: then and only then there is a position to emit
};

/// A sentence of the context's talker that begins with the time of the epoch.
NmeaSentence timed_sentence(const Epoch& epoch, std::string_view type) noexcept {
  const std::array<char, 5> address = {epoch.context.talker[0], epoch.context.talker[1], type[0], type[1],
                                       type[2]};
  NmeaSentence sentence({address.data(), address.size()});
  sentence.text(epoch.time.time.text());
  return sentence;
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
double dilution(const Epoch& epoch) noexcept {
  const Eigen::Matrix3d& covariance = epoch.fix.covariance;
  const double sigma_m = std::sqrt(covariance(0, 0) + covariance(1, 1));
  return std::clamp(sigma_m / epoch.context.landmark_sigma_m, kDilutionMin, kDilutionMax);
}

void add_sigma(NmeaSentence& sentence, double sigma_m, int decimals) noexcept {
  sentence.fixed(std::min(sigma_m, kSigmaMax_m), decimals);
}

NmeaSentence rmc(const Epoch& epoch, int decimals) noexcept {
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

NmeaSentence gga(const Epoch& epoch, int decimals) noexcept {
  NmeaSentence sentence = timed_sentence(epoch, "GGA");
  if (!epoch.place) {
    return sentence.blank(4).integer(0).integer(0, 2).fixed(kDilutionMax, 2).blank(6);
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
std::optional<PositionError> geographic_error(const Epoch& epoch) noexcept {
  if (!epoch.place || !epoch.error_known) {
    return std::nullopt;
  }
  const Eigen::Matrix2d& R_EN_W = epoch.place->R_EN_W;
  const Eigen::Matrix2d covariance_W = epoch.fix.covariance.topLeftCorner<2, 2>();
  return position_error(R_EN_W * covariance_W * R_EN_W.transpose());
}

NmeaSentence gbs(const Epoch& epoch, int decimals) noexcept {
  NmeaSentence sentence = timed_sentence(epoch, "GBS");
  const std::optional<PositionError> error = geographic_error(epoch);
  if (!error) {
    return sentence.blank(7);
  }
  add_sigma(sentence, error->north_m, decimals);
  add_sigma(sentence, error->east_m, decimals);
  return sentence.blank(5);
}

NmeaSentence hdt(const Epoch& epoch, int decimals) noexcept {
  const std::array<char, 5> address = {epoch.context.talker[0], epoch.context.talker[1], 'H', 'D', 'T'};
  NmeaSentence sentence({address.data(), address.size()});
  return sentence.wrapped(epoch.place->true_heading_deg, 360, decimals).letter('T');
}

NmeaSentence gst(const Epoch& epoch, int decimals) noexcept {
  NmeaSentence sentence = timed_sentence(epoch, "GST");
  const std::optional<PositionError> error = geographic_error(epoch);
  if (!error) {
    return sentence.blank(7);
  }
  add_sigma(sentence, epoch.context.landmark_sigma_m, decimals);
  add_sigma(sentence, error->major_m, decimals);
  add_sigma(sentence, error->minor_m, decimals);
  sentence.wrapped(error->major_bearing_deg, 180, 1);
  add_sigma(sentence, error->north_m, decimals);
  add_sigma(sentence, error->east_m, decimals);
  return sentence.blank();
}

NmeaSentence zda(const Epoch& epoch, int) noexcept {
  NmeaSentence sentence = timed_sentence(epoch, "ZDA");
  sentence.integer(epoch.time.day, 2).integer(epoch.time.month, 2);
  return sentence.integer(static_cast<std::uint64_t>(std::max(epoch.time.year, 0)), 4).text("00").text("00");
}

char status_letter(const Epoch& epoch) noexcept {
  if (!epoch.pose_known) {
    return 'V';
  }
  return epoch.fix.status == core::FixStatus::Fix ? 'A' : 'U';
}

void add_map_pose(NmeaSentence& sentence, const Epoch& epoch, int decimals) noexcept {
  const core::Fix& fix = epoch.fix;
  sentence.fixed(fix.pose_W.x_m, decimals).fixed(fix.pose_W.y_m, decimals);
  sentence.wrapped(fix.pose_W.heading_rad / core::kDegree, 360, decimals);
  if (epoch.error_known) {
    const Eigen::Matrix2d covariance = fix.covariance.topLeftCorner<2, 2>();
    add_sigma(sentence, position_error(covariance).major_m, decimals);
    sentence.fixed(std::min(std::sqrt(fix.covariance(2, 2)) / core::kDegree, 360.0), std::min(decimals, 2));
  } else {
    sentence.blank(2);
  }
  sentence.integer(std::min(fix.error_xi, 9999U));
}

NmeaSentence pslma(const Epoch& epoch, int decimals) noexcept {
  const core::Fix& fix = epoch.fix;
  NmeaSentence sentence("PSLMA");
  sentence.text("POSE").text(epoch.time.time.text()).letter(status_letter(epoch));
  sentence.letter(epoch.context.mode == NmeaMode::Live ? 'A' : 'S');
  sentence.integer(static_cast<std::uint64_t>(fix.reason));
  if (epoch.pose_known) {
    add_map_pose(sentence, epoch, decimals);
  } else {
    sentence.blank(6);
  }
  return sentence.integer(std::min(fix.matches, 999U)).integer(std::min(fix.landmarks_seen, 999U));
}

/// The bytes written so far of an epoch. `out` has room for all.
class EpochWriter {
 public:
  EpochWriter(const Epoch& epoch, std::span<char> out) noexcept : epoch_(epoch), out_(out) {}

  /// Adds the sentence that `make` gives with as many decimals as the length allows.
  void add(NmeaSentence (*make)(const Epoch&, int) noexcept, int decimals) noexcept {
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
  const Epoch& epoch_;
  std::span<char> out_;
  std::size_t size_ = 0;
};

}  // namespace

NmeaContext nmea_context(const NmeaConfig& config, const GeoReference* geo, NmeaMode mode) noexcept {
  NmeaContext context;
  if (config.talker.size() == context.talker.size()) {
    std::copy(config.talker.begin(), config.talker.end(), context.talker.begin());
  }
  context.mode = mode;
  context.quality = config.quality;
  context.landmark_sigma_m = config.landmark_sigma_m;
  context.zda = config.zda;
  context.geo = geo;
  return context;
}

std::size_t format_nmea(const core::Fix& fix, const NmeaContext& context, std::span<char> out) noexcept {
  if (out.size() < kNmeaEpochBytesMax) {
    return 0;
  }
  const Epoch epoch(fix, context);
  EpochWriter writer(epoch, out);
  writer.add(rmc, kMinuteDecimals);
  writer.add(gga, kMinuteDecimals);
  writer.add(gbs, 3);
  if (epoch.place) {
    writer.add(hdt, 2);
  }
  writer.add(gst, 3);
  if (context.zda) {
    writer.add(zda, 0);
  }
  writer.add(pslma, kMapDecimals);
  return writer.size();
}

}  // namespace slamsensor::firmware
