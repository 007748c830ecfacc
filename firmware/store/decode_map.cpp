#include "firmware/store/byte_cursor.hpp"
#include "firmware/store/map_file.hpp"
#include "firmware/store/map_frame.hpp"
#include "firmware/store/map_text.hpp"

#include <cmath>
#include <utility>

namespace slamsensor::firmware {
namespace {

tl::unexpected<MapFileError> refuse(MapProblem problem, std::string message) {
  return tl::unexpected(MapFileError{problem, std::move(message)});
}

Datum take_datum(ByteReader& in) {
  Datum datum;
  datum.latitude_deg = in.take_double();
  datum.longitude_deg = in.take_double();
  datum.height_m = in.take_double();
  datum.bearing_deg = in.take_double();
  return datum;
}

/// False when they are not the fields of an INFO record, neither more nor less.
bool take_info(ByteReader& in, MapFile& map) {
  const bool is_old = map.version == 1;
  std::uint8_t flags = 0;
  MapAbout& about = map.about;
  about.saves = is_old ? 0 : in.take<std::uint64_t>();
  about.created_utc_s = is_old ? 0 : in.take_signed();
  about.saved_utc_s = in.take_signed();
  map.numbers.weight = in.take<std::uint64_t>();
  map.numbers.landmarks_evicted = is_old ? 0 : in.take<std::uint64_t>();
  map.numbers.path_thinnings = is_old ? 0 : in.take<std::uint64_t>();
  map.numbers.next_id = in.take<std::uint32_t>();
  map.numbers.scans = in.take<std::uint32_t>();
  if (!is_old) {
    about.method.tolerance_m = in.take_double();
    about.method.range_step_m = in.take_double();
    about.method.bearing_step_rad = in.take_double();
    about.method.depth = in.take<std::uint32_t>();
    about.method.landmarks_max = in.take<std::uint32_t>();
    flags = in.take<std::uint8_t>();
    about.frozen = (flags & kInfoFrozen) != 0;
    if ((flags & kInfoHasDatum) != 0) {
      about.datum = take_datum(in);
    }
  }
  about.name = in.take_text();
  const bool are_flags_known =
      flags <= (kInfoHasDatum | kInfoFrozen) && about.frozen == (map.version == kMapVersionFrozen);
  return are_flags_known && !in.overran() && in.left() == 0;
}

/// What in `about` cannot be; empty when all can.
std::string impossible(const MapAbout& about) {
  if (!is_map_name(about.name)) {
    return "the name " + printable_bytes(about.name) + " is none that a map can have";
  }
  if (!is_utc(about.created_utc_s) || !is_utc(about.saved_utc_s)) {
    return "a time is not between the years 1970 and 9999";
  }
  if (const std::optional<Datum>& d = about.datum;
      d && !(std::abs(d->latitude_deg) <= 90.0 && std::abs(d->longitude_deg) <= 180.0 &&
             std::isfinite(d->height_m) && std::isfinite(d->bearing_deg))) {
    return "the datum is no place on the earth";
  }
  return {};
}

tl::expected<void, MapFileError> read_info(const MapFrameSection& section, MapFile& map) {
  ByteReader in(section.payload);
  if (!take_info(in, map)) {
    return damaged(section.begin, "section INFO: its fields do not make up its " +
                                      std::to_string(section.record_bytes) + " bytes");
  }
  if (const std::string reason = impossible(map.about); !reason.empty()) {
    return refuse(MapProblem::Flawed,
                  "byte " + std::to_string(section.begin) + ": section INFO: " + reason +
                      ": the map was not written by slamsensor; use an earlier copy of it");
  }
  return {};
}

void read_landmarks(const MapFrameSection& section, MapFile& map) {
  ByteReader in(section.payload);
  map.landmarks.resize(section.records);
  map.positions_W.resize(section.records);
  for (std::size_t i = 0; i < section.records; ++i) {
    core::MapLandmark& landmark = map.landmarks[i];
    landmark.id = in.take<std::uint32_t>();
    landmark.xi = in.take<std::uint32_t>();
    for (std::uint32_t& parent : landmark.parents) {
      parent = in.take<std::uint32_t>();
    }
    landmark.sightings = in.take<std::uint32_t>();
    landmark.chances = map.version == 1 ? landmark.sightings : in.take<std::uint32_t>();
    landmark.first_scan = in.take<std::uint32_t>();
    landmark.last_scan = in.take<std::uint32_t>();
    map.positions_W[i].x() = in.take_double();
    map.positions_W[i].y() = in.take_double();
  }
}

void read_path(const MapFrameSection& section, MapFile& map) {
  ByteReader in(section.payload);
  map.path.resize(section.records);
  for (core::PathPose& pose : map.path) {
    pose.scan = in.take<std::uint32_t>();
    pose.xi = in.take<std::uint32_t>();
    pose.pose_W.x_m = in.take_double();
    pose.pose_W.y_m = in.take_double();
    pose.pose_W.heading_rad = in.take_double();
  }
}

/// Before memory is taken for them: whether as many landmarks and poses have room.
tl::expected<void, MapFileError> check_room(const MapFrame& frame, const core::Capacities& capacities) {
  core::MapCheck check;
  if (frame.sections[2].records > capacities.path_poses) {
    check = {core::MapFlaw::TooManyPoses, frame.sections[2].records};
  }
  if (frame.sections[1].records > capacities.map_landmarks) {
    check = {core::MapFlaw::TooManyLandmarks, frame.sections[1].records};
  }
  if (!check.ok()) {
    return refuse(MapProblem::TooLarge, flaw_text(check, {}, capacities));
  }
  return {};
}

/// Which number of a map has run so far that the map could not grow, be refined and be saved for years to
/// come; empty when none has. No sensor gets there: a landmark and a scan each second fill 2^31 in 68 years,
/// and an xi of 65,536 takes as many landmarks in a row.
std::string without_head_room(const MapFile& map) {
  constexpr std::uint32_t kCountMax = std::uint32_t{1} << 31U;
  constexpr std::uint32_t kXiMax = 65'536;
  if (map.numbers.next_id > kCountMax) {
    return "the next landmark's id " + std::to_string(map.numbers.next_id) +
           " leaves no room for more landmarks";
  }
  if (map.numbers.scans > kCountMax) {
    return "the number of scans " + std::to_string(map.numbers.scans) + " leaves no room for more scans";
  }
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const core::MapLandmark& landmark = map.landmarks[i];
    if (landmark.sightings > kCountMax || landmark.chances > kCountMax || landmark.xi > kXiMax) {
      return "landmark " + std::to_string(i) + " (id " + std::to_string(landmark.id) +
             "): its sightings, chances or xi leave no room for more";
    }
  }
  for (std::size_t i = 0; i < map.path.size(); ++i) {
    if (map.path[i].xi > kXiMax) {
      return "pose " + std::to_string(i) + " of the path: its xi leaves no room for more";
    }
  }
  return {};
}

}  // namespace

tl::expected<MapFile, MapFileError> decode_map(std::span<const std::uint8_t> bytes,
                                               const core::Capacities& capacities) {
  const auto frame = read_frame(bytes);
  if (!frame) {
    return tl::unexpected(frame.error());
  }
  MapFile map;
  map.version = frame->version;
  if (auto info = read_info(frame->sections[0], map); !info) {
    return tl::unexpected(std::move(info.error()));
  }
  if (auto room = check_room(*frame, capacities); !room) {
    return tl::unexpected(std::move(room.error()));
  }
  read_landmarks(frame->sections[1], map);
  read_path(frame->sections[2], map);
  const core::MapCheck check = core::check_map(map.state(), capacities);
  if (!check.ok()) {
    const bool is_large =
        check.flaw == core::MapFlaw::TooManyLandmarks || check.flaw == core::MapFlaw::TooManyPoses;
    return refuse(is_large ? MapProblem::TooLarge : MapProblem::Flawed,
                  flaw_text(check, map.state(), capacities));
  }
  if (const std::string reason = without_head_room(map); !reason.empty()) {
    return refuse(MapProblem::Flawed,
                  reason + ": the map was not written by slamsensor; use an earlier copy of it");
  }
  return map;
}

core::MapState MapFile::state() const {
  core::MapState state = numbers;
  state.landmarks = landmarks;
  state.positions_W = positions_W;
  state.path = path;
  return state;
}

core::Capacities unlimited_capacities() {
  core::Capacities capacities;
  capacities.map_landmarks = capacities.path_poses = UINT32_MAX;
  return capacities;
}

}  // namespace slamsensor::firmware
