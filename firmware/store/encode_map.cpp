#include "firmware/store/byte_cursor.hpp"
#include "firmware/store/map_file.hpp"
#include "firmware/store/map_layout.hpp"

#include <boost/crc.hpp>

#include <algorithm>
#include <utility>

namespace slamsensor::firmware {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string_view tag_of(MapSection section) {
  return kMapSectionTags[static_cast<std::size_t>(section)];
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
  out.put(static_cast<std::uint8_t>((about.datum ? kInfoHasDatum : 0) | (about.frozen ? kInfoFrozen : 0)));
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
  const std::uint32_t fixed = record_bytes_of(section, kMapVersion);
  out.put(fixed != 0 ? fixed : static_cast<std::uint32_t>(payload.size()));
  out.put(crc32_of(head, payload));
  file.insert(file.end(), head.begin(), head.end());
  file.insert(file.end(), payload.begin(), payload.end());
}

Bytes landmark_records(const core::MapState& state) {
  Bytes records;
  records.reserve(state.landmarks.size() * record_bytes_of(MapSection::Landmarks, kMapVersion));
  ByteWriter out(records);
  for (std::size_t i = 0; i < state.landmarks.size(); ++i) {
    put_landmark(state.landmarks[i], state.positions_W[i], out);
  }
  return records;
}

Bytes path_records(const core::MapState& state) {
  Bytes records;
  records.reserve(state.path.size() * record_bytes_of(MapSection::Path, kMapVersion));
  ByteWriter out(records);
  std::for_each(state.path.begin(), state.path.end(),
                [&](const core::PathPose& pose) { put_pose(pose, out); });
  return records;
}

}  // namespace

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
  Bytes file(kMapMagic.begin(), kMapMagic.end());
  file.reserve(kMapPrefixBytes + sections.size());
  ByteWriter out(file);
  const std::uint32_t version = about.frozen ? kMapVersionFrozen : kMapVersion;
  out.put(version);
  out.put(sections_of(version));
  out.put(std::uint64_t{kMapPrefixBytes + sections.size()});
  out.put(crc32_of(file));
  file.insert(file.end(), sections.begin(), sections.end());
  return file;
}

}  // namespace slamsensor::firmware
