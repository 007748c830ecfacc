#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace slamsensor::hal {

/// `text` without the white space around it.
[[nodiscard]] std::string_view trim_iio(std::string_view text) noexcept;

/// The number that a file of sysfs holds: decimal, finite, with nothing but white space around it.
[[nodiscard]] std::optional<double> parse_iio_number(std::string_view text) noexcept;

/// Row by row, "a, b, c; d, e, f; g, h, i".
using MountMatrix = std::array<double, 9>;

/// The mount matrix that a file of sysfs holds; nothing unless it is a rotation (rows of unit length, at
/// right angles, right-handed; each within 0.01).
[[nodiscard]] std::optional<MountMatrix> parse_mount_matrix(std::string_view text) noexcept;

}  // namespace slamsensor::hal
