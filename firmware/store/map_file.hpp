#pragma once

#include "core/mapping/map_state.hpp"
#include "firmware/config/sensor_config.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace slamsensor::firmware {

/// The settings that a map was made with. For the reader's information: a map may be used with others.
struct MapMethod {
  double tolerance_m = 0.0;
  double range_step_m = 0.0;
  double bearing_step_rad = 0.0;
  std::uint32_t depth = 0;
  std::uint32_t landmarks_max = 0;
};

/// What a map file says of its map. Times are seconds since 1970-01-01 UTC; 0 is unknown.
struct MapAbout {
  std::string name;
  std::int64_t created_utc_s = 0;  ///< when it was saved first
  std::int64_t saved_utc_s = 0;
  std::uint64_t saves = 0;     ///< how often, this one included
  std::optional<Datum> datum;  ///< in force at the save; the configuration's goes before it
  MapMethod method;
  bool frozen = false;  ///< a sensor that loads it only localises in it, until it is told to unfreeze
};

/// A map as a file holds it.
struct MapFile {
  MapAbout about;
  std::vector<core::MapLandmark> landmarks;
  std::vector<core::Point2> positions_W;
  std::vector<core::PathPose> path;
  core::MapState numbers;  ///< its spans are empty

  /// For Slam::restore; valid as long as this object lives unchanged.
  [[nodiscard]] core::MapState state() const;
};

/// The height of a datum, m: that of the setting datum.height_m.
inline constexpr double kDatumHeightMin_m = -1000.0;
inline constexpr double kDatumHeightMax_m = 10'000.0;

/// Whether the four numbers of `datum` can be those of a place on the earth: latitude, longitude and height
/// as in the settings, the bearing within a turn in either direction.
[[nodiscard]] bool is_on_earth(const Datum& datum) noexcept;

/// Why bytes are not taken for a map.
enum class MapProblem : std::uint8_t {
  Foreign,   ///< something else, or nothing
  TooNew,    ///< of a version that this program does not know
  Damaged,   ///< cut, or a checksum or length that does not hold
  Flawed,    ///< whole, but not a map that the method can have made
  TooLarge,  ///< a good map that the configured capacities have no room for
};

struct MapFileError {
  MapProblem problem = MapProblem::Foreign;
  std::string message;  ///< where in the file, what, and what to do; without the name of the file
};

/// The bytes of a map file. `about.name` has at most 64 characters.
[[nodiscard]] std::vector<std::uint8_t> encode_map(const MapAbout& about, const core::MapState& state);

/// The map that `bytes` hold, without a flaw (core::check_map) and within `capacities`. Takes memory in
/// proportion to bytes.size(), whatever they say.
[[nodiscard]] tl::expected<MapFile, MapFileError> decode_map(std::span<const std::uint8_t> bytes,
                                                             const core::Capacities& capacities);

/// Capacities that any map fits in.
[[nodiscard]] core::Capacities unlimited_capacities();

/// What makes `state` unusable, in words, and what to do; empty when `check` found nothing.
[[nodiscard]] std::string flaw_text(const core::MapCheck& check, const core::MapState& state,
                                    const core::Capacities& capacities);

}  // namespace slamsensor::firmware
