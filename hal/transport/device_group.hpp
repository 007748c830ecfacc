#pragma once

#include "hal/fixed_text.hpp"

namespace slamsensor::hal {

using DeviceGroup = FixedText<32>;

/// The name by which /proc/devices knows the character device at `path` ("ttyUSB"), as systemd's
/// DeviceAllow=char- takes it; empty when there is none. Takes no memory.
[[nodiscard]] DeviceGroup device_group(const char* path) noexcept;

}  // namespace slamsensor::hal
