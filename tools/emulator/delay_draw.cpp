#include "tools/emulator/delay_draw.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {

Stamp DelayDraw::draw() {
  if (delay_.jitter == Stamp::zero()) {
    return std::max(delay_.constant, Stamp::zero());
  }
  const double sigmas = std::clamp(draw_normal(rng_), -4.0, 4.0);
  const Stamp jitter(std::llround(sigmas * static_cast<double>(delay_.jitter.count())));
  return std::max(delay_.constant + jitter, Stamp::zero());
}

}  // namespace slamsensor::tools
