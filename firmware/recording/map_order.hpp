#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// What the map was told on command while a recording ran, and before which scan that took effect.
struct MapOrder {
  enum class Kind : std::uint8_t { Reset, Freeze, Unfreeze, Load };
  Kind kind = Kind::Reset;
  std::uint32_t scan = 0;  ///< scans localised before, since the start of the recording
};

/// "reset 12", "freeze 0": kind and scan.
[[nodiscard]] std::string text_of(const MapOrder& order);

/// The order that `text` is, or nothing.
[[nodiscard]] std::optional<MapOrder> parse_map_order(std::string_view text) noexcept;

}  // namespace slamsensor::firmware
