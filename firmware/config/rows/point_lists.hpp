#pragma once

#include "hal/rangefinder/point_laser.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What a point laser sends instead of a distance, as the configuration writes it: "65535=none",
/// "DE02=fault". Behind the equals sign: none, weak, saturated or fault.
namespace slamsensor::firmware::rows {

[[nodiscard]] std::optional<hal::PointCode> parse_point_code(std::string_view item);
/// The text has 1 to 32 characters of ASCII; it may hold an equals sign itself.
[[nodiscard]] std::optional<hal::PointText> parse_point_text(std::string_view item);

/// Those items that can be parsed.
[[nodiscard]] std::vector<hal::PointCode> point_codes(const std::vector<std::string>& items);
[[nodiscard]] std::vector<hal::PointText> point_texts(const std::vector<std::string>& items);

[[nodiscard]] std::vector<std::string> texts_of(const std::vector<hal::PointCode>& codes);
[[nodiscard]] std::vector<std::string> texts_of(const std::vector<hal::PointText>& texts);

}  // namespace slamsensor::firmware::rows
