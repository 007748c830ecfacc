#pragma once

#include "hal/stamp.hpp"
#include "tools/emulator/fault.hpp"
#include "tools/emulator/head_profile.hpp"
#include "tools/world/drive.hpp"
#include "tools/world/simulate.hpp"
#include "tools/world/world_config.hpp"

#include <tl/expected.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// What moves the sensor from a stand to the next.
enum class StandChange : std::uint8_t {
  AtTimes,    ///< each stand has its time
  OnScanEnd,  ///< whoever runs the head says when a scan has ended
};

/// The sensor is lifted and put down elsewhere, whatever it is doing.
struct Kidnap {
  double at_s = 0.0;  ///< from the start of the scenario
  core::Pose2 pose_W;
};

enum class VisitKind : std::uint8_t { Stand, Kidnap };

/// Where the sensor is put.
struct Visit {
  VisitKind kind = VisitKind::Stand;
  core::Pose2 pose_W;
};

/// The places of a scenario in their order. After a kidnap the drive goes on with its next stand.
class StandPlan {
 public:
  StandPlan() = default;

  /// `stands` is not empty. The first is due at 0.
  StandPlan(std::vector<Stand> stands, std::vector<Kidnap> kidnaps, StandChange change);

  /// When the next change comes by itself; hal::kNever when none does.
  [[nodiscard]] hal::Stamp next() const noexcept;

  /// The next change when it is due at `now`.
  [[nodiscard]] std::optional<Visit> take(hal::Stamp now);

  /// The next stand, ahead of its time; nothing after the last.
  [[nodiscard]] std::optional<Visit> next_stand();

  [[nodiscard]] std::size_t stands() const noexcept { return stands_.size(); }

  /// Stands taken so far.
  [[nodiscard]] std::size_t taken() const noexcept { return stand_; }

 private:
  [[nodiscard]] hal::Stamp stand_due() const noexcept;
  [[nodiscard]] hal::Stamp kidnap_due() const noexcept;

  std::vector<Stand> stands_;
  std::vector<Kidnap> kidnaps_;
  StandChange change_ = StandChange::AtTimes;
  std::size_t stand_ = 0;
  std::size_t kidnap_ = 0;
};

/// All that an emulated head does, from its world to its faults. The same values, the same bytes.
struct Scenario {
  std::filesystem::path world_file;  ///< that the scenario's own file names; empty: the world is that file
  WorldConfig world;                 ///< its stands, when it has any, are where the sensor is put, in order
  std::uint64_t seed = 1;
  HeadProfile head;
  SweepConfig mount;  ///< height, roll and pitch of the mount; the rest is not used
  StandChange change = StandChange::AtTimes;
  DriveConfig drive;  ///< a walk by chance when there are no stands; its period is the dwell at each stand
  std::vector<Kidnap> kidnaps;
  std::vector<PlannedFault> faults;
  std::vector<FaultRate> rates;
  std::size_t truth_max = 0;  ///< readings whose truth is kept; not in the file
};

/// The scenario that the TOML file `path` describes, or, for a world file (one that names no `world`), a
/// drive through that world with the head `kind`. `kind`, when given, also replaces the scenario's own. What
/// is not named keeps its default. Every mistake is reported with file, line and column.
[[nodiscard]] tl::expected<Scenario, WorldError> load_scenario(const std::filesystem::path& path,
                                                               std::optional<HeadKind> kind = std::nullopt);

/// The same from a text; `name` stands for the file in messages, and the world is looked for in `folder`.
[[nodiscard]] tl::expected<Scenario, WorldError> parse_scenario(std::string_view toml, std::string_view name,
                                                                const std::filesystem::path& folder,
                                                                std::optional<HeadKind> kind = std::nullopt);

/// What is wrong with a scenario that was made otherwise than by the above: a fault that its device cannot
/// have, and the like.
[[nodiscard]] std::optional<WorldError> find_problem(const Scenario& scenario);

}  // namespace slamsensor::tools
