#include "tools/world/drive.hpp"

#include "tools/world/random.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

namespace slamsensor::tools {
namespace {

constexpr int kTurnsTried = 64;
constexpr double kWiderPerTurn = 0.15;  // the spread of the turn grows by this share with every blocked one
constexpr int kPlacesTried = 20'000;
constexpr double kWaySample_m = 0.5;
constexpr std::uint32_t kStandsMax = 100'000;

std::optional<WorldError> find_problem(const DriveConfig& config) {
  const auto within = [](double value, double min, double max) { return value >= min && value <= max; };
  if (config.stands < 1 || config.stands > kStandsMax) {
    return WorldError{"drive: 1 to 100000 stands, not " + std::to_string(config.stands)};
  }
  if (!within(config.step_m, 0.01, 1000.0) || !within(config.turn_sigma_rad, 0.0, 10.0) ||
      !within(config.clearance_m, 0.0, 100.0) || !within(config.margin_m, 0.0, 10'000.0)) {
    return WorldError{
        "drive: step is 0.01 to 1000 m, turn 0 to 10 rad, clearance 0 to 100 m, margin 0 to 10 km"};
  }
  if (!within(config.kidnap_share, 0.0, 1.0) || !within(config.period_s, 0.0, 1e6)) {
    return WorldError{"drive: kidnap share is 0 to 1, period 0 to 1e6 s"};
  }
  return std::nullopt;
}

bool is_inside(const AreaConfig& area, const core::Point2& p_W, double margin_m) noexcept {
  return p_W.x() >= area.x_min_m + margin_m && p_W.x() <= area.x_max_m - margin_m &&
         p_W.y() >= area.y_min_m + margin_m && p_W.y() <= area.y_max_m - margin_m;
}

bool is_way_free(const World& world, const DriveConfig& config, const core::Point2& from_W,
                 const core::Point2& to_W) noexcept {
  const auto parts = static_cast<int>(std::ceil((to_W - from_W).norm() / kWaySample_m));
  for (int i = 1; i <= parts; ++i) {
    const core::Point2 p_W = from_W + (static_cast<double>(i) / parts) * (to_W - from_W);
    if (!world.is_free(p_W, config.clearance_m)) {
      return false;
    }
  }
  return true;
}

std::optional<core::Pose2> draw_place(const World& world, const DriveConfig& config, Random& rng) {
  const AreaConfig& area = world.config().area;
  for (int i = 0; i < kPlacesTried; ++i) {
    core::Pose2 pose_W;
    pose_W.x_m = draw_uniform(rng, area.x_min_m, area.x_max_m);
    pose_W.y_m = draw_uniform(rng, area.y_min_m, area.y_max_m);
    pose_W.heading_rad = draw_uniform(rng, -std::numbers::pi, std::numbers::pi);
    if (is_inside(area, pose_W.translation(), config.margin_m) &&
        world.is_free(pose_W.translation(), config.clearance_m)) {
      return pose_W;
    }
  }
  return std::nullopt;
}

// Lifted, turned and put down within a step of some earlier stand: somewhere the sensor could know.
std::optional<core::Pose2> draw_kidnap(const World& world, const DriveConfig& config,
                                       const std::vector<Stand>& earlier, Random& rng) {
  for (int i = 0; i < kPlacesTried; ++i) {
    const auto chosen = static_cast<std::size_t>(draw_unit(rng) * static_cast<double>(earlier.size()));
    const core::Pose2 turned{0.0, 0.0, draw_uniform(rng, -std::numbers::pi, std::numbers::pi)};
    const core::Pose2 aside{config.step_m * draw_unit(rng), 0.0,
                            draw_uniform(rng, -std::numbers::pi, std::numbers::pi)};
    const core::Pose2 pose_W = earlier[chosen].pose * turned * aside;
    if (is_inside(world.config().area, pose_W.translation(), config.margin_m) &&
        world.is_free(pose_W.translation(), config.clearance_m)) {
      return pose_W;
    }
  }
  return std::nullopt;
}

std::optional<core::Pose2> draw_step(const World& world, const DriveConfig& config, const core::Pose2& from_W,
                                     Random& rng) {
  for (int i = 0; i < kTurnsTried; ++i) {
    const double turn_rad = config.turn_sigma_rad * (1.0 + kWiderPerTurn * i) * draw_normal(rng);
    core::Pose2 to_W = from_W * core::Pose2{0.0, 0.0, turn_rad};
    to_W = to_W * core::Pose2{config.step_m, 0.0, 0.0};
    if (is_inside(world.config().area, to_W.translation(), config.margin_m) &&
        is_way_free(world, config, from_W.translation(), to_W.translation())) {
      return to_W;
    }
  }
  return std::nullopt;
}

tl::expected<std::vector<Stand>, WorldError> given_stands(const World& world, const DriveConfig& config) {
  std::vector<Stand> stands;
  for (const StandConfig& given : world.config().stands) {
    if (!world.is_free(given.pose_W.translation(), 0.0)) {
      return tl::unexpected(WorldError{
          "stand " + std::to_string(stands.size() + 1) + " at (" + std::to_string(given.pose_W.x_m) + ", " +
          std::to_string(given.pose_W.y_m) + ") is inside an obstacle; move it"});
    }
    const double time_s = static_cast<double>(stands.size()) * config.period_s;
    stands.push_back(
        {{given.pose_W.x_m, given.pose_W.y_m, core::wrap_angle(given.pose_W.heading_rad)}, time_s});
  }
  return stands;
}

}  // namespace

tl::expected<std::vector<Stand>, WorldError> make_drive(const World& world, const DriveConfig& config,
                                                        std::uint64_t seed) {
  if (auto problem = find_problem(config)) {
    return tl::unexpected(std::move(*problem));
  }
  if (!world.config().stands.empty()) {
    return given_stands(world, config);
  }
  Random rng(seed);
  std::vector<Stand> stands;
  while (stands.size() < config.stands) {
    std::optional<core::Pose2> pose_W;
    const bool kidnapped = draw_unit(rng) < config.kidnap_share;
    if (!stands.empty()) {
      pose_W = kidnapped ? draw_kidnap(world, config, stands, rng)
                         : draw_step(world, config, stands.back().pose, rng);
    }
    if (!pose_W) {
      pose_W = draw_place(world, config, rng);
    }
    if (!pose_W) {
      return tl::unexpected(
          WorldError{"drive: no free place found in the world; lower its densities, or the drive's "
                     "clearance or margin"});
    }
    stands.push_back({*pose_W, static_cast<double>(stands.size()) * config.period_s});
  }
  return stands;
}

}  // namespace slamsensor::tools
