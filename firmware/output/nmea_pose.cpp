#include "firmware/output/nmea_pose.hpp"

#include "core/geometry/pose2.hpp"
#include "firmware/output/position_error.hpp"

#include <algorithm>
#include <array>
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

}  // namespace

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

}  // namespace slamsensor::firmware
