#include "tools/input/left_out.hpp"

#include "core/limits.hpp"

#include <algorithm>

namespace slamsensor::tools {

void LeftOut::see(const InputScan& scan) {
  see_list(scan.landmarks.size(), scan.landmarks_beyond_max);
  landmarks_at_one_place += scan.landmarks_at_one_place;
  zero_ranges += scan.zero_ranges;
}

void LeftOut::see_list(std::size_t used, std::size_t beyond_max) {
  if (beyond_max > 0) {
    landmarks_beyond_max += beyond_max;
    ++scans_beyond_max;
    landmarks_most = std::max(landmarks_most, used + beyond_max);
  }
}

void LeftOut::add(const LeftOut& other) {
  landmarks_beyond_max += other.landmarks_beyond_max;
  scans_beyond_max += other.scans_beyond_max;
  landmarks_most = std::max(landmarks_most, other.landmarks_most);
  landmarks_at_one_place += other.landmarks_at_one_place;
  zero_ranges += other.zero_ranges;
}

std::string LeftOut::text() const {
  std::string lines;
  if (landmarks_beyond_max > 0) {
    const std::size_t enough = std::min<std::size_t>(landmarks_most, core::kScanLandmarksMax);
    lines += "left out         " + std::to_string(landmarks_beyond_max) + " landmarks in " +
             std::to_string(scans_beyond_max) + " scans that list up to " + std::to_string(landmarks_most) +
             "; --set detection.landmarks_max=" + std::to_string(enough) +
             (enough < landmarks_most ? " keeps the most that a scan can have\n" : " keeps them\n");
  }
  if (landmarks_at_one_place > 0) {
    lines += "counted once     " + std::to_string(landmarks_at_one_place) +
             " landmarks within 1 mm of another one of their scan were left out\n";
  }
  if (zero_ranges > 0) {
    lines += "no return        " + std::to_string(zero_ranges) +
             " readings with a range_m of 0 or less were taken for it\n";
  }
  return lines;
}

}  // namespace slamsensor::tools
