#pragma once

#include "tools/emulator/emulated_device.hpp"
#include "tools/world/random.hpp"
#include "tools/world/sweep.hpp"
#include "tools/world/world.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace slamsensor::tools {

/// The truth of one reading that went out.
struct ShotTruth {
  Stamp measured{};   ///< when the laser fired
  Stamp on_wire{};    ///< when the device began to send the reading
  HeadAngles angles;  ///< of the head when the laser fired
  Target target;      ///< what the device was given to measure
};

struct HeadSceneConfig {
  SweepConfig mount;            ///< height, roll and pitch of the mount; the rest is not used
  double drop_out_share = 0.0;  ///< chance that a shot is lost; the world's own should be 0
  std::uint64_t seed = 1;       ///< of noise and drop-outs
  std::size_t truth_max = 0;    ///< readings whose truth is kept; the oldest go first
};

/// The world as the rangefinder on a pan-tilt unit sees it: every shot goes where the unit truly points at
/// that moment, from the place where the sensor then stands.
class HeadScene final : public RangeScene {
 public:
  /// `world` outlives the scene.
  HeadScene(const World& world, const HeadSceneConfig& config);

  /// Shots go where `pointing` says from now on; it outlives the scene's use. Before: straight ahead.
  void watch(const PointingTruth& pointing) { pointing_ = &pointing; }

  /// The mount stands at `pose_W` from now on.
  void stand_at(const core::Pose2& pose_W);

  [[nodiscard]] Target shoot(Stamp at) override;
  void reported(Stamp measured, Stamp on_wire) override;

  /// Moves out the truth of the readings reported since the last call, in the order of time, at most
  /// `truth_max`.
  [[nodiscard]] std::vector<ShotTruth> take_truth();

 private:
  const World& world_;
  HeadSceneConfig config_;
  SensorPlace place_;
  const PointingTruth* pointing_ = nullptr;
  Random noise_;
  Random drop_outs_;
  std::deque<ShotTruth> pending_;  // fired and not yet reported
  std::deque<ShotTruth> truth_;
};

/// A plausible reflectance of `surface` in the near infrared, 0 to 1.
[[nodiscard]] double reflectance_of(Surface surface) noexcept;

}  // namespace slamsensor::tools
