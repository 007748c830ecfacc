#pragma once

#include "firmware/output/nmea.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

namespace slamsensor::tests {

inline const firmware::Datum kDatum{47.4520576, 8.57757202, 412.35, 90.0};

inline core::Fix good_fix() {
  core::Fix fix;
  fix.time.middle_utc = std::chrono::sys_days(std::chrono::year(2025) / 7 / 14).time_since_epoch() +
                        std::chrono::hours(10) + std::chrono::minutes(15) + std::chrono::milliseconds(30'200);
  fix.status = core::FixStatus::Fix;
  fix.reason = core::FixReason::None;
  fix.pose_W.heading_rad = (90.0 - 123.45) * core::kDegree;
  fix.covariance.diagonal() << 0.045 * 0.045, 0.055 * 0.055, std::pow(0.5 * core::kDegree, 2);
  fix.matches = 8;
  fix.landmarks_seen = 11;
  fix.error_xi = 3;
  fix.map = fix.home = 1;
  fix.protection_radius_m = 0.4;
  return fix;
}

inline std::string epoch_text(const core::Fix& fix, const firmware::NmeaContext& context) {
  std::array<char, firmware::kNmeaEpochBytesMax> out{};
  const std::size_t size = firmware::format_nmea(fix, context, out);
  return {out.data(), size};
}

/// The lines of an epoch without their line ends, each of which must be there.
inline std::vector<std::string> lines(const core::Fix& fix, const firmware::NmeaContext& context) {
  std::vector<std::string> result;
  const std::string text = epoch_text(fix, context);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find("\r\n", begin);
    if (end == std::string::npos) {
      ADD_FAILURE() << "a line without an end: " << text.substr(begin);
      break;
    }
    result.push_back(text.substr(begin, end - begin));
    begin = end + 2;
  }
  return result;
}

inline std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  for (const char c : line.substr(0, line.find('*'))) {
    if (c == ',') {
      result.emplace_back();
    } else {
      result.back() += c;
    }
  }
  return result;
}

}  // namespace slamsensor::tests
