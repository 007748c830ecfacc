#pragma once

#include "tools/world/drive.hpp"
#include "tools/world/sweep.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

namespace slamsensor::tools {

/// How far a simulation has come; `scans_done` of `scans` are on disk.
struct SimulateProgress {
  std::uint32_t scans_done = 0;
  std::uint32_t scans = 0;
};

struct SimulateOptions {
  std::filesystem::path world;              ///< world file (TOML)
  std::filesystem::path out;                ///< folder; made when it does not exist
  std::optional<std::uint64_t> world_seed;  ///< instead of the world file's
  std::uint64_t seed = 1;                   ///< of the drive and of everything the rangefinder does by chance
  SweepConfig sweep;
  DriveConfig drive;
  std::function<void(const SimulateProgress&)> on_progress;  ///< after every scan; may be empty
};

struct SimulateSummary {
  std::uint32_t scans = 0;
  std::uint64_t readings = 0;
  std::uint64_t returns = 0;   ///< readings with a range
  std::uint32_t objects = 0;   ///< in the world, and in stems.csv
  std::uint32_t unplaced = 0;  ///< that found no room
};

/// Drives a simulated sensor through a world and writes into `out`: `scan_0001.csv` and on
/// (`pan_deg,tilt_deg,range_m`; an empty range is no return), `truth.tum` (`t x y z qx qy qz qw`: scan number
/// and pose of the sensor, roll and pitch errors included, in the world frame, which is the map frame) and
/// `stems.csv`
/// (`id,x_m,y_m,radius_m,height_m,kind`: every tree, bush, rock and post). Equal options give equal bytes.
/// Refused when the world or an option is not valid, a file cannot be written, or `out` holds scans that
/// would be mixed with these.
[[nodiscard]] tl::expected<SimulateSummary, WorldError> simulate(const SimulateOptions& options);

}  // namespace slamsensor::tools
