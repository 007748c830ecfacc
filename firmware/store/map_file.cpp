#include "firmware/store/map_file.hpp"

#include "firmware/store/byte_cursor.hpp"
#include "firmware/store/map_names.hpp"

#include <boost/crc.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <string>
#include <type_traits>
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
  MapAbout& about = map.about;
  about.saves = in.take<std::uint64_t>();
  about.created_utc_s = in.take_signed();
  about.saved_utc_s = in.take_signed();
  map.numbers.weight = in.take<std::uint64_t>();
  map.numbers.landmarks_evicted = in.take<std::uint64_t>();
  map.numbers.path_thinnings = in.take<std::uint64_t>();
  map.numbers.next_id = in.take<std::uint32_t>();
  map.numbers.scans = in.take<std::uint32_t>();
  about.method.tolerance_m = in.take_double();
  about.method.range_step_m = in.take_double();
  about.method.bearing_step_rad = in.take_double();
  about.method.depth = in.take<std::uint32_t>();
  about.method.landmarks_max = in.take<std::uint32_t>();
  const auto flags = in.take<std::uint8_t>();
  about.frozen = (flags & kInfoFrozen) != 0;
  map.numbers.is_surveyed = about.frozen && (flags & kInfoSurveyed) != 0;
  if ((flags & kInfoHasDatum) != 0) {
    about.datum = take_datum(in);
  }
  about.name = in.take_text();
  return flags <= (kInfoHasDatum | kInfoFrozen | kInfoSurveyed) && !in.overran() && in.left() == 0;
}

/// What in `about` cannot be; empty when all can.
std::string impossible(const MapAbout& about) {
  if (!is_map_name(about.name)) {
    return "the name " + printable_bytes(about.name) + " is none that a map can have";
  }
  if (!is_utc(about.created_utc_s) || !is_utc(about.saved_utc_s)) {
    return "a time is not between the years 1970 and 9999";
  }
  if (about.datum && !is_on_earth(*about.datum)) {
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
    landmark.chances = in.take<std::uint32_t>();
    landmark.first_scan = in.take<std::uint32_t>();
    landmark.last_scan = in.take<std::uint32_t>();
    map.positions_W[i].x() = in.take_double();
    map.positions_W[i].y() = in.take_double();
    landmark.sigma_m = std::bit_cast<float>(in.take<std::uint32_t>());
    if (section.record_bytes >= record_bytes_of(MapSection::Landmarks)) {
      landmark.size.ln_diameter = std::bit_cast<float>(in.take<std::uint32_t>());
      landmark.size.sightings = std::bit_cast<float>(in.take<std::uint32_t>());
    }
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

void read_rates(const MapFrameSection& section, MapFile& map) {
  if (section.records != 0) {
    ByteReader in(section.payload);
    core::Rates::visit_numbers(map.numbers.rates.emplace(), [&](auto& number) {
      if (in.left() == 0) {
        return;  // an older version: it stays as it starts
      }
      if constexpr (std::is_same_v<decltype(number), float&>) {
        number = std::bit_cast<float>(in.take<std::uint32_t>());
      } else {
        number = in.take_double();
      }
    });
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

using Bytes = std::vector<std::uint8_t>;

std::string_view tag_of(MapSection section) {
  return kMapSectionTags[static_cast<std::size_t>(section)];
}

std::uint8_t flags_of(const MapAbout& about, const core::MapState& state) {
  return static_cast<std::uint8_t>((about.datum ? kInfoHasDatum : 0) | (about.frozen ? kInfoFrozen : 0) |
                                   (about.frozen && state.is_surveyed ? kInfoSurveyed : 0));
}

Bytes info_record(const MapAbout& about, const core::MapState& state) {
  Bytes record;
  ByteWriter out(record);
  out.put(about.saves);
  out.put(about.created_utc_s);
  out.put(about.saved_utc_s);
  out.put(state.weight);
  out.put(state.landmarks_evicted);
  out.put(state.path_thinnings);
  out.put(state.next_id);
  out.put(state.scans);
  out.put(about.method.tolerance_m);
  out.put(about.method.range_step_m);
  out.put(about.method.bearing_step_rad);
  out.put(about.method.depth);
  out.put(about.method.landmarks_max);
  out.put(flags_of(about, state));
  if (about.datum) {
    out.put(about.datum->latitude_deg);
    out.put(about.datum->longitude_deg);
    out.put(about.datum->height_m);
    out.put(about.datum->bearing_deg);
  }
  out.put(std::string_view(about.name));
  return record;
}

void put_landmark(const core::MapLandmark& landmark, const core::Point2& position_W, ByteWriter& out) {
  out.put(landmark.id);
  out.put(landmark.xi);
  for (const std::uint32_t parent : landmark.parents) {
    out.put(parent);
  }
  out.put(landmark.sightings);
  out.put(landmark.chances);
  out.put(landmark.first_scan);
  out.put(landmark.last_scan);
  out.put(position_W.x());
  out.put(position_W.y());
  out.put(std::bit_cast<std::uint32_t>(landmark.sigma_m));
  out.put(std::bit_cast<std::uint32_t>(landmark.size.ln_diameter));
  out.put(std::bit_cast<std::uint32_t>(landmark.size.sightings));
}

void put_pose(const core::PathPose& pose, ByteWriter& out) {
  out.put(pose.scan);
  out.put(pose.xi);
  out.put(pose.pose_W.x_m);
  out.put(pose.pose_W.y_m);
  out.put(pose.pose_W.heading_rad);
}

void append_section(MapSection section, std::size_t records, const Bytes& payload, Bytes& file) {
  const std::string_view tag = tag_of(section);
  Bytes head(tag.begin(), tag.end());
  ByteWriter out(head);
  out.put(static_cast<std::uint32_t>(records));
  const std::uint32_t fixed = record_bytes_of(section);
  out.put(fixed != 0 ? fixed : static_cast<std::uint32_t>(payload.size()));
  out.put(crc32_of(head, payload));
  file.insert(file.end(), head.begin(), head.end());
  file.insert(file.end(), payload.begin(), payload.end());
}

Bytes landmark_records(const core::MapState& state) {
  Bytes records;
  records.reserve(state.landmarks.size() * record_bytes_of(MapSection::Landmarks));
  ByteWriter out(records);
  for (std::size_t i = 0; i < state.landmarks.size(); ++i) {
    put_landmark(state.landmarks[i], state.positions_W[i], out);
  }
  return records;
}

Bytes path_records(const core::MapState& state) {
  Bytes records;
  records.reserve(state.path.size() * record_bytes_of(MapSection::Path));
  ByteWriter out(records);
  std::for_each(state.path.begin(), state.path.end(),
                [&](const core::PathPose& pose) { put_pose(pose, out); });
  return records;
}

Bytes rate_record(const core::MapState& state) {
  Bytes record;
  ByteWriter out(record);
  if (state.rates) {
    core::Rates::visit_numbers(*state.rates, [&](auto number) {
      if constexpr (std::is_same_v<decltype(number), float>) {
        out.put(std::bit_cast<std::uint32_t>(number));
      } else {
        out.put(number);
      }
    });
  }
  return record;
}

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
    case MapFlaw::Sigma:
      return "its sigma is not a length";
    case MapFlaw::Size:
      return "its diameter is none that can be measured";
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
    case MapFlaw::Rates:
      return "what was learned with it has a number that cannot be: the map was not written by slamsensor; "
             "use an "
             "earlier copy of it";
    case MapFlaw::PositionCount:
      return "it has " + count + " positions, not one for each landmark";
    default:
      return {};
  }
}

}  // namespace

tl::expected<MapFile, MapFileError> decode_map(std::span<const std::uint8_t> bytes,
                                               const core::Capacities& capacities) {
  const auto frame = read_frame(bytes);
  if (!frame) {
    return tl::unexpected(frame.error());
  }
  MapFile map;
  if (auto info = read_info(frame->sections[0], map); !info) {
    return tl::unexpected(std::move(info.error()));
  }
  if (auto room = check_room(*frame, capacities); !room) {
    return tl::unexpected(std::move(room.error()));
  }
  read_landmarks(frame->sections[1], map);
  read_path(frame->sections[2], map);
  read_rates(frame->sections[3], map);
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

bool is_on_earth(const Datum& datum) noexcept {
  return std::abs(datum.latitude_deg) <= 90.0 && std::abs(datum.longitude_deg) <= 180.0 &&
         datum.height_m >= kDatumHeightMin_m && datum.height_m <= kDatumHeightMax_m &&
         std::abs(datum.bearing_deg) <= 360.0;
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

std::uint32_t crc32_of(std::span<const std::uint8_t> first, std::span<const std::uint8_t> second) {
  boost::crc_32_type crc;
  crc.process_bytes(first.data(), first.size());
  crc.process_bytes(second.data(), second.size());
  return crc.checksum();
}

Bytes encode_map(const MapAbout& about, const core::MapState& state) {
  Bytes sections;
  append_section(MapSection::Info, 1, info_record(about, state), sections);
  append_section(MapSection::Landmarks, state.landmarks.size(), landmark_records(state), sections);
  append_section(MapSection::Path, state.path.size(), path_records(state), sections);
  append_section(MapSection::Rates, state.rates ? 1 : 0, rate_record(state), sections);
  Bytes file(kMapMagic.begin(), kMapMagic.end());
  file.reserve(kMapPrefixBytes + sections.size());
  ByteWriter out(file);
  out.put(kMapVersion);
  out.put(static_cast<std::uint32_t>(kMapSectionTags.size()));
  out.put(std::uint64_t{kMapPrefixBytes + sections.size()});
  out.put(crc32_of(file));
  file.insert(file.end(), sections.begin(), sections.end());
  return file;
}

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

namespace {

using FileBytes = std::span<const std::uint8_t>;
using Outcome = tl::expected<void, MapFileError>;

std::string crc_text(std::uint32_t crc) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%08X", crc);
  return text.data();
}

std::string crc_mismatch(std::uint32_t told, std::uint32_t found) {
  return "the checksum is " + crc_text(told) + " but the bytes give " + crc_text(found);
}

Outcome check_magic(FileBytes file) {
  if (file.empty()) {
    return refuse(MapProblem::Foreign, "the file is empty; use an earlier copy of it");
  }
  const std::size_t shared = std::min(file.size(), kMapMagic.size());
  if (std::equal(kMapMagic.begin(), kMapMagic.begin() + static_cast<std::ptrdiff_t>(shared), file.begin())) {
    return {};
  }
  if (file.size() >= 4 && std::equal(kMapMagic.begin(), kMapMagic.begin() + 4, file.begin())) {
    return refuse(MapProblem::Damaged,
                  "byte 4: the line ends were changed, as by a transfer in text mode; copy it again, in "
                  "binary mode");
  }
  return refuse(MapProblem::Foreign, "it begins with " + printable_bytes(file.first(shared)) +
                                         " and is not a map of slamsensor; name a .slammap file");
}

/// The version, when prefix and size are sound and it is known.
tl::expected<std::uint32_t, MapFileError> check_prefix(FileBytes file) {
  if (const Outcome magic = check_magic(file); !magic) {
    return tl::unexpected(magic.error());
  }
  if (file.size() < kMapPrefixBytes) {
    return damaged(file.size(),
                   "the file ends within its first " + std::to_string(kMapPrefixBytes) + " bytes");
  }
  ByteReader in(file.subspan(kMapMagic.size()));
  const auto version = in.take<std::uint32_t>();
  const auto sections = in.take<std::uint32_t>();
  const auto size = in.take<std::uint64_t>();
  const auto told = in.take<std::uint32_t>();
  if (const std::uint32_t found = crc32_of(file.first(kMapPrefixBytes - 4)); found != told) {
    return damaged(kMapPrefixBytes - 4, crc_mismatch(told, found));
  }
  if (version > kMapVersion) {
    return refuse(MapProblem::TooNew, "byte 8: the format is version " + std::to_string(version) +
                                          "; this program reads version " + std::to_string(kMapVersion) +
                                          ": install a newer slamsensor");
  }
  if (version < kMapVersionOldest) {
    return damaged(8, "there is no format version " + std::to_string(version));
  }
  if (sections != sections_of(version)) {
    return damaged(12, "it claims " + std::to_string(sections) + " sections; version " +
                           std::to_string(version) + " has " + std::to_string(sections_of(version)));
  }
  if (size != file.size()) {
    return damaged(16, "it claims " + std::to_string(size) + " bytes and has " + std::to_string(file.size()));
  }
  return version;
}

/// The section at `begin`, when its head and checksum are sound.
tl::expected<MapFrameSection, MapFileError> read_section(FileBytes file, std::size_t begin, MapSection wanted,
                                                         std::uint32_t version) {
  const std::string name(kMapSectionTags[static_cast<std::size_t>(wanted)]);
  const FileBytes rest = file.subspan(begin);
  if (rest.size() < kSectionHeadBytes) {
    return damaged(begin, "the file ends where section " + name + " should begin");
  }
  if (!std::equal(name.begin(), name.end(), rest.begin())) {
    return damaged(begin, "section " + name + " should begin here, found " + printable_bytes(rest.first(4)));
  }
  ByteReader in(rest.subspan(4));
  MapFrameSection section;
  section.records = in.take<std::uint32_t>();
  section.record_bytes = in.take<std::uint32_t>();
  const auto told = in.take<std::uint32_t>();
  section.begin = begin + kSectionHeadBytes;
  const std::uint32_t fixed = record_bytes_of(wanted, version);
  if (section.records > records_max_of(wanted) ||
      (fixed != 0 ? section.record_bytes != fixed : section.records != 1)) {
    return damaged(begin + 4, "section " + name + ": " + std::to_string(section.records) + " records of " +
                                  std::to_string(section.record_bytes) + " bytes are not of this format");
  }
  const std::uint64_t size = std::uint64_t{section.records} * section.record_bytes;
  if (size > in.left()) {
    return damaged(begin + 4, "section " + name + " claims " + std::to_string(size) + " bytes; " +
                                  std::to_string(in.left()) + " are left");
  }
  section.payload = rest.subspan(kSectionHeadBytes, static_cast<std::size_t>(size));
  if (const std::uint32_t found = crc32_of(rest.first(12), section.payload); found != told) {
    return damaged(begin + 12, "section " + name + ": " + crc_mismatch(told, found));
  }
  return section;
}

}  // namespace

tl::unexpected<MapFileError> damaged(std::size_t byte, const std::string& what) {
  return refuse(MapProblem::Damaged, "byte " + std::to_string(byte) + ": " + what +
                                         ": the file is damaged; use an earlier copy of it");
}

tl::expected<MapFrame, MapFileError> read_frame(FileBytes bytes) {
  const auto version = check_prefix(bytes);
  if (!version) {
    return tl::unexpected(version.error());
  }
  MapFrame frame;
  std::size_t begin = kMapPrefixBytes;
  for (std::uint32_t s = 0; s < sections_of(*version); ++s) {
    auto section = read_section(bytes, begin, static_cast<MapSection>(s), *version);
    if (!section) {
      return tl::unexpected(std::move(section.error()));
    }
    frame.sections[s] = *section;
    begin = section->begin + section->payload.size();
  }
  if (begin != bytes.size()) {
    return damaged(begin, std::to_string(bytes.size() - begin) + " bytes stand behind the last section");
  }
  return frame;
}

}  // namespace slamsensor::firmware
