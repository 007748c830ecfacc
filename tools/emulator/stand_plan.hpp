#pragma once

#include "hal/stamp.hpp"
#include "tools/world/drive.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
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

}  // namespace slamsensor::tools
