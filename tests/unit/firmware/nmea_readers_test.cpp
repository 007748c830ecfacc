#include "firmware/output/nmea.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace slamsensor::firmware {
namespace {

constexpr int kEpochs = 100;

/// A round of a circle of 50 m, every fifth epoch without a fix.
std::string track() {
  const GeoReference geo(Datum{-33.86, 151.21, 12.5, 45.0});
  NmeaContext context{.zda = true, .geo = &geo};
  std::string text;
  for (int i = 0; i < kEpochs; ++i) {
    core::Fix fix;
    fix.time.middle_utc = std::chrono::seconds(1'752'488'130 + i);
    fix.status = i % 5 == 4 ? core::FixStatus::NoFix : core::FixStatus::Fix;
    const double angle_rad = 2.0 * M_PI * i / kEpochs;
    fix.pose_W = {50.0 * std::cos(angle_rad), 50.0 * std::sin(angle_rad), angle_rad};
    fix.covariance.diagonal() << 0.01, 0.02, 1e-5;
    fix.matches = 12;
    fix.landmarks_seen = 20;
    std::array<char, kNmeaEpochBytesMax> out{};
    text.append(out.data(), format_nmea(fix, context, out));
  }
  return text;
}

// Reads every line with the checksum required, and prints: lines, fixes, headings, greatest distance from the
// origin.
constexpr const char* kReader = R"(
import sys, math, pynmea2
lines = fixes = headings = 0
far = 0.0
for line in open(sys.argv[1], newline='\r\n'):
    m = pynmea2.parse(line, check=True)
    lines += 1
    if isinstance(m, pynmea2.ProprietarySentence):
        assert m.data[1] == 'POSE' and len(m.data) == 17, line
        continue
    if m.sentence_type == 'HDT':
        headings += 1
        assert 0.0 <= m.heading < 360.0, line
    if m.sentence_type == 'GGA' and m.is_valid:
        fixes += 1
        north = (m.latitude + 33.86) * 110920.0
        east = (m.longitude - 151.21) * 92520.0
        far = max(far, math.hypot(north, east))
        assert m.num_sats == '12' and m.altitude == 12.5, line
    if m.sentence_type == 'RMC':
        assert m.datetime.year == 2025, line
print(lines, fixes, headings, round(far))
)";

TEST(NmeaReaders, Pynmea2ReadsAFormattedTrack) {
  if (std::system("/usr/bin/python3 -c 'import pynmea2' >/dev/null 2>&1") != 0) {
    GTEST_SKIP() << "SKIPPED: python3-nmea2 is not installed; its reading of our sentences was NOT tested";
  }
  const std::filesystem::path base =
      std::filesystem::temp_directory_path() / ("slamsensor_nmea_" + std::to_string(::getpid()));
  const std::string nmea = base.string() + ".nmea";
  const std::string reader = base.string() + ".py";
  std::ofstream(nmea, std::ios::binary) << track();
  std::ofstream(reader) << kReader;
  FILE* const pipe = ::popen(("/usr/bin/python3 " + reader + " " + nmea + " 2>&1").c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string output;
  std::array<char, 256> chunk{};
  while (std::fgets(chunk.data(), static_cast<int>(chunk.size()), pipe) != nullptr) {
    output += chunk.data();
  }
  EXPECT_EQ(::pclose(pipe), 0) << output;
  // 80 epochs of seven lines, 20 without HDT.
  EXPECT_EQ(output, "680 80 80 50\n");
  std::filesystem::remove(nmea);
  std::filesystem::remove(reader);
}

}  // namespace
}  // namespace slamsensor::firmware
