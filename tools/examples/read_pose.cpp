// Prints every pose of a SLAM sensor, from LCM. In a folder with it and
// firmware/lcm/types/slamsensor_pose_t.lcm, with g++, liblcm-bin, liblcm-dev, libglib2.0-dev and pkgconf from
// Debian:
//
//   lcm-gen --cpp --cpp-std c++11 --cpp-hpath . slamsensor_pose_t.lcm
//   g++ -I. read_pose.cpp -o read_pose $(pkg-config --cflags --libs lcm)
//
// A line per pose: seconds since 1970, status, x (m), y (m), heading (degrees, counter-clockwise from the
// map's x axis), number of the map, protection radius (m); those only where there is a fix, or the better of
// two places.
#include <cmath>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <slamsensor/pose_t.hpp>

namespace {

class Reader {
 public:
  void on_pose(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
               const slamsensor::pose_t* pose) {
    const char* const status = pose->status == slamsensor::pose_t::STATUS_FIX         ? "fix"
                               : pose->status == slamsensor::pose_t::STATUS_AMBIGUOUS ? "ambiguous"
                                                                                      : "no_fix";
    std::printf("%.2f %s", static_cast<double>(pose->utime) * 1e-6, status);
    if (pose->status != slamsensor::pose_t::STATUS_NO_FIX) {
      double heading_deg = pose->heading_rad * 180.0 / M_PI;
      heading_deg += heading_deg < 0.0 ? 360.0 : 0.0;
      std::printf(" %.3f %.3f %.2f", pose->x_m, pose->y_m, heading_deg);
      std::printf(" %lld %.2f", static_cast<long long>(pose->map), pose->protection_radius_m);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
};

}  // namespace

int main() {
  lcm::LCM lcm;  // LCM_DEFAULT_URL, else the default group
  if (!lcm.good()) {
    std::fprintf(stderr, "LCM does not start: is there a route for multicast?\n");
    return 1;
  }
  Reader reader;
  lcm.subscribe("SLAMSENSOR_POSE", &Reader::on_pose, &reader)->setQueueCapacity(1000);
  while (lcm.handle() == 0) {
  }
  return 1;
}
