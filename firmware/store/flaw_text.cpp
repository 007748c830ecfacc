#include "firmware/store/map_file.hpp"

#include <string>

namespace slamsensor::firmware {
namespace {

using core::MapFlaw;

std::string landmark_place(const core::MapCheck& check, const core::MapState& state) {
  return "landmark " + std::to_string(check.index) + " (id " +
         std::to_string(state.landmarks[check.index].id) + "): ";
}

/// What is wrong with one landmark or pose; null for the flaws of the whole.
const char* detail_of(MapFlaw flaw) {
  switch (flaw) {
    case MapFlaw::IdOrder:
      return "its id is not larger than the one before";
    case MapFlaw::NextId:
      return "its id was not given out yet";
    case MapFlaw::Position:
      return "its position is not a place within 65 km of the origin";
    case MapFlaw::Parents:
      return "its parents are not three other landmarks that triangulated it";
    case MapFlaw::ParentXi:
      return "a parent is not nearer to the origin (xi) than it is";
    case MapFlaw::Sightings:
      return "it was never seen";
    case MapFlaw::LandmarkScans:
      return "it was last seen before it was first seen, or in a scan that is still to come";
    case MapFlaw::PathOrder:
      return "its scan is not later than the one before, or is still to come";
    case MapFlaw::PathPose:
      return "it is not a finite pose";
    default:
      return nullptr;
  }
}

std::string counts_text(const core::MapCheck& check, const core::Capacities& capacities) {
  const std::string count = std::to_string(check.index);
  switch (check.flaw) {
    case MapFlaw::TooFewLandmarks:
      return "it holds " + count + " landmarks; a place is found from three or more: it is of no use";
    case MapFlaw::TooManyLandmarks:
      return "it holds " + count + " landmarks and there is room for " +
             std::to_string(capacities.map_landmarks) + ": raise capacities.map_landmarks to " + count;
    case MapFlaw::TooManyPoses:
      return "its path has " + count + " poses and there is room for " +
             std::to_string(capacities.path_poses) + ": raise capacities.path_poses to " + count;
    case MapFlaw::PositionCount:
      return "it has " + count + " positions, not one for each landmark";
    default:
      return {};
  }
}

}  // namespace

std::string flaw_text(const core::MapCheck& check, const core::MapState& state,
                      const core::Capacities& capacities) {
  const char* const detail = detail_of(check.flaw);
  if (detail == nullptr) {
    return counts_text(check, capacities);
  }
  const bool is_path = check.flaw == MapFlaw::PathOrder || check.flaw == MapFlaw::PathPose;
  const std::string place =
      is_path ? "pose " + std::to_string(check.index) + " of the path: " : landmark_place(check, state);
  return place + detail + ": the map was not written by slamsensor; use an earlier copy of it";
}

}  // namespace slamsensor::firmware
