#pragma once

#include "firmware/config/setting.hpp"

#include <span>

namespace slamsensor::firmware {

/// Sections that belong together, with their keys in the same order. Both live as long as the program.
struct SettingRows {
  std::span<const Section> sections;
  std::span<const Setting> settings;
};

[[nodiscard]] SettingRows head_rows();
[[nodiscard]] SettingRows pan_tilt_rows();
[[nodiscard]] SettingRows rangefinder_rows();
[[nodiscard]] SettingRows point_laser_rows();
[[nodiscard]] SettingRows inclination_rows();
[[nodiscard]] SettingRows scan_rows();
[[nodiscard]] SettingRows method_rows();
[[nodiscard]] SettingRows input_rows();
[[nodiscard]] SettingRows output_rows();
[[nodiscard]] SettingRows daemon_rows();
[[nodiscard]] SettingRows gpio_rows();

}  // namespace slamsensor::firmware
