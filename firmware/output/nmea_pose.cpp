#include "firmware/output/nmea_pose.hpp"

#include "core/geometry/pose2.hpp"
#include "firmware/output/position_error.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

namespace slamsensor::firmware {
namespace {

constexpr double kAgeMax_s = 99'999.0;  // a longer number would not fit the sentence

char status_letter(const NmeaEpoch& epoch) noexcept {
  if (!epoch.pose_known) {
    return 'V';
  }
  return epoch.fix.status == core::FixStatus::Fix ? 'A' : 'U';
}

/// How many decimals the numbers of the pose have as its sentence gets shorter.
struct PoseDecimals {
  explicit PoseDecimals(int detail) noexcept
      : place(std::min(detail, 3)), heading_sigma(std::min(detail, 2)), age(std::max(detail - 2, 0)) {}

  int place;
  int heading_sigma;
  int age;
};

void add_map_pose(NmeaSentence& sentence, const NmeaEpoch& epoch, const PoseDecimals& decimals) noexcept {
  const core::Fix& fix = epoch.fix;
  sentence.fixed(fix.pose_W.x_m, decimals.place).fixed(fix.pose_W.y_m, decimals.place);
  sentence.wrapped(fix.pose_W.heading_rad / core::kDegree, 360, decimals.place);
  if (epoch.error_known) {
    const Eigen::Matrix2d covariance = fix.covariance.topLeftCorner<2, 2>();
    add_nmea_sigma(sentence, position_error(covariance).major_m, decimals.place);
    const double sigma_heading_deg = std::sqrt(fix.covariance(2, 2)) / core::kDegree;
    sentence.fixed(std::min(sigma_heading_deg, 360.0), decimals.heading_sigma);
  } else {
    sentence.blank(2);
  }
  sentence.integer(std::min(fix.error_xi, 9999U));
}

void add_age(NmeaSentence& sentence, const NmeaEpoch& epoch, int decimals) noexcept {
  if (!epoch.moment.age) {
    sentence.blank();
    return;
  }
  const double age_s = std::chrono::duration<double>(*epoch.moment.age).count();
  sentence.fixed(std::clamp(age_s, 0.0, kAgeMax_s), decimals);
}

}  // namespace

NmeaSentence nmea_pose_sentence(const NmeaEpoch& epoch, int detail) noexcept {
  const core::Fix& fix = epoch.fix;
  const PoseDecimals decimals(detail);
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
  return sentence;
}

}  // namespace slamsensor::firmware
