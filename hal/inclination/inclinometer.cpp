#include "hal/inclination/inclinometer.hpp"

#include <cmath>

namespace slamsensor::hal {

Inclination inclination_of_up(Stamp stamp, double x, double y, double z) noexcept {
  return {stamp, std::atan2(y, z), std::atan2(-x, std::hypot(y, z))};
}

}  // namespace slamsensor::hal
