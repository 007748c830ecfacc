#include "firmware/output/nmea.hpp"

#include "firmware/output/nmea_epoch.hpp"
#include "firmware/output/nmea_pose.hpp"
#include "firmware/output/position_error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace slamsensor::firmware {
namespace {

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
