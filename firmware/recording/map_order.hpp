#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// What can be done to the maps between two scans.
enum class MapCommand : std::uint8_t {
  Reset,  ///< forget everything
  Freeze,
  Unfreeze,
  Restore,     ///< go on from a map that was saved
  DropRivals,  ///< go on with the home map alone, as after a Restore of it; never recorded
};

/// What the map was told on command while a recording ran, and before which scan that took effect.
struct MapOrder {
  MapCommand kind = MapCommand::Reset;
  std::uint32_t scan = 0;  ///< scans localised before, since the start of the recording
};

/// "reset 12", "freeze 0", "load 3": kind and scan.
[[nodiscard]] std::string text_of(const MapOrder& order);

/// The order that `text` is, or nothing.
[[nodiscard]] std::optional<MapOrder> parse_map_order(std::string_view text) noexcept;

}  // namespace slamsensor::firmware
