#include "tools/emulator/head_profile.hpp"

namespace slamsensor::tools {

HeadProfile head_profile(HeadKind kind) noexcept {
  HeadProfile profile;
  if (kind == HeadKind::Fast) {
    profile.ptu.unit = PanTiltModel::FastE;
    profile.ptu.baud = 115'200;
    profile.ptu.reset_s = 2.0;
    profile.rangefinder.unit = RangefinderModel::Lw20;
    profile.rangefinder.baud = 921'600;
    profile.rangefinder.rate_hz = 20'000.0;
  }
  return profile;
}

}  // namespace slamsensor::tools
