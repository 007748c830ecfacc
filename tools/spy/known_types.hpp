#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::tools {

/// The name of the LCM type of a message, by its fingerprint: "slamsensor.pose_t", "bot_core.pose_t", ...;
/// of an unknown one the fingerprint in hexadecimal, of fewer than 8 bytes "-".
[[nodiscard]] std::string lcm_type_text(std::span<const std::uint8_t> message);

/// A line "member  value" for each member of a message of a known type with fixed length; of an array as many
/// elements as fit some 60 characters. Empty for other types and for broken messages.
[[nodiscard]] std::vector<std::string> lcm_message_lines(std::span<const std::uint8_t> message);

}  // namespace slamsensor::tools
