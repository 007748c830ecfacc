#include "tools/emulator/head_scene.hpp"

#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kPendingMax = 65'536;  // shots of a device that reports none of them
constexpr std::uint64_t kNoiseStream = 0;
constexpr std::uint64_t kDropOutStream = 1;

}  // namespace

double reflectance_of(Surface surface) noexcept {
  switch (surface) {
    case Surface::None:
      return 0.0;
    case Surface::Crown:
    case Surface::Bush:
      return 0.5;  // leaves are bright beyond the red
    case Surface::Wall:
    case Surface::Car:
      return 0.6;
    case Surface::Person:
      return 0.4;
    case Surface::Ground:
    case Surface::Post:
      return 0.2;
    case Surface::Stem:
    case Surface::Rock:
      break;
  }
  return 0.3;
}

HeadScene::HeadScene(const World& world, const HeadSceneConfig& config)
    : world_(world),
      config_(config),
      place_(sensor_place(world, config.mount, {})),
      noise_(mix_seed(config.seed, kNoiseStream)),
      drop_outs_(mix_seed(config.seed, kDropOutStream)) {
}

void HeadScene::stand_at(const core::Pose2& pose_W) {
  place_ = sensor_place(world_, config_.mount, pose_W);
}

Target HeadScene::shoot(Stamp at) {
  const HeadAngles angles = pointing_ != nullptr ? pointing_->angles_at(at) : HeadAngles{};
  const Eigen::Vector3d direction_W =
      place_.R_W_L * direction_L(angles.pan_rad, std::cos(angles.tilt_rad), std::sin(angles.tilt_rad));
  const double time_s = hal::to_seconds(at);
  const Range range = world_.cast(place_.position_W, direction_W, time_s, noise_);
  Target target;
  if (config_.drop_out_share > 0.0 && draw_unit(drop_outs_) < config_.drop_out_share) {
    target.kind = TargetKind::LostShot;
  } else if (range.has_return()) {
    target = {TargetKind::Target, range.range_m, reflectance_of(range.surface)};
  }
  if (config_.truth_max > 0) {
    pending_.push_back({at, {}, angles, target});
    if (pending_.size() > kPendingMax) {
      pending_.pop_front();
    }
  }
  return target;
}

void HeadScene::reported(Stamp measured, Stamp on_wire) {
  while (!pending_.empty() && pending_.front().measured < measured) {
    pending_.pop_front();  // never reported
  }
  if (pending_.empty() || pending_.front().measured != measured) {
    return;
  }
  truth_.push_back(pending_.front());
  truth_.back().on_wire = on_wire;
  pending_.pop_front();
  if (truth_.size() > config_.truth_max) {
    truth_.pop_front();
  }
}

std::vector<ShotTruth> HeadScene::take_truth() {
  std::vector<ShotTruth> taken(truth_.begin(), truth_.end());
  truth_.clear();
  return taken;
}

}  // namespace slamsensor::tools
