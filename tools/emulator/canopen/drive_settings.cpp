#include "tools/emulator/canopen/drive_settings.hpp"

#include <numbers>

namespace slamsensor::tools {

double DriveSettings::counts_per_rad() const noexcept {
  return direction * static_cast<double>(encoder_counts) * static_cast<double>(gear_turns) /
         (2.0 * std::numbers::pi);
}

CanopenHeadSettings canopen_head_settings() {
  CanopenHeadSettings settings;
  settings.tilt.node_id = 2;
  settings.tilt.serial_number = 2;
  settings.tilt.lower_limit = -53'476;
  settings.tilt.upper_limit = 35'271;
  return settings;
}

}  // namespace slamsensor::tools
