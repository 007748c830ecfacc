#include "tests/unit/firmware/store/damage.hpp"

#include "firmware/store/map_file.hpp"

#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

namespace slamsensor::tests {
namespace {

using core::MapLandmark;
using firmware::MapFile;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Bytes text(std::string_view characters) {
  return {characters.begin(), characters.end()};
}

Bytes cut(std::size_t size) {
  Bytes bytes = sample_bytes();
  bytes.resize(size);
  return bytes;
}

Bytes flip(std::size_t byte) {
  Bytes bytes = sample_bytes();
  bytes[byte] ^= 0x10;
  return bytes;
}

void put(Bytes& bytes, std::size_t place, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes[place + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

/// Makes the checksums hold again: that of the prefix, and that of the section whose head is at `head` and
/// whose records end at `end`.
void seal_prefix(Bytes& bytes) {
  put(bytes, 24, firmware::crc32_of(std::span(bytes).first(24)), 4);
}
void seal_section(Bytes& bytes, std::size_t head, std::size_t end) {
  const std::span<const std::uint8_t> all(bytes);
  put(bytes, head + 12, firmware::crc32_of(all.subspan(head, 12), all.subspan(head + 16, end - head - 16)),
      4);
}

Bytes with_prefix(std::size_t place, std::uint64_t value, std::size_t size) {
  Bytes bytes = sample_bytes();
  put(bytes, place, value, size);
  seal_prefix(bytes);
  return bytes;
}

Bytes with_section(std::size_t head, std::size_t end, std::size_t place, std::uint64_t value) {
  Bytes bytes = sample_bytes();
  put(bytes, place, value, 4);
  seal_section(bytes, head, end);
  return bytes;
}

/// A file of the right checksums whose size is what it claims, `added` bytes longer.
Bytes longer(std::size_t added) {
  Bytes bytes = sample_bytes();
  bytes.resize(bytes.size() + added);
  put(bytes, 16, bytes.size(), 8);
  seal_prefix(bytes);
  return bytes;
}

Bytes sealed_cut(std::size_t size) {
  Bytes bytes = cut(size);
  put(bytes, 16, size, 8);
  seal_prefix(bytes);
  return bytes;
}

Bytes swapped_sections() {
  const Bytes good = sample_bytes();
  Bytes bytes(good.begin(), good.begin() + kLandHead);
  bytes.insert(bytes.end(), good.begin() + kPathHead, good.end());
  bytes.insert(bytes.end(), good.begin() + kLandHead, good.begin() + kPathHead);
  return bytes;
}

std::function<Bytes()> changed(const std::function<void(MapFile&)>& change) {
  return [change] {
    MapFile map = sample_map();
    change(map);
    return firmware::encode_map(map.about, map.state());
  };
}

std::string damaged(std::string what) {
  return std::move(what) + ": the file is damaged; use an earlier copy of it";
}

std::string not_ours(std::string what) {
  return std::move(what) + ": the map was not written by slamsensor; use an earlier copy of it";
}

}  // namespace

std::vector<Damage> damaged_files() {
  return {
      {"Empty", [] { return Bytes{}; }, "the file is empty; use an earlier copy of it"},
      {"Text", [] { return text("id,x_m,y_m\n1,0,0\n"); },
       "it begins with \"id,x_m,y\" and is not a map of slamsensor; name a .slammap file"},
      {"OneLetter", [] { return text("x"); },
       "it begins with \"x\" and is not a map of slamsensor; name a .slammap file"},
      {"Zeros", [] { return Bytes(600); },
       "it begins with \"\\x00\\x00\\x00\\x00\\x00\\x00\\x00\\x00\" and is not a map of slamsensor; name a "
       ".slammap file"},
      {"Png", [] { return text("\x89PNG\r\n\x1a\n"); },
       "it begins with \"\\x89PNG\\x0D\\x0A\\x1A\\x0A\" and is not a map of slamsensor; name a .slammap "
       "file"},
      {"TextMode",
       [] {
         Bytes bytes = sample_bytes();
         bytes.erase(bytes.begin() + 4);
         return bytes;
       },
       "byte 4: the line ends were changed, as by a transfer in text mode; copy it again, in binary mode"},
      {"CutInMagic", [] { return cut(5); }, damaged("byte 5: the file ends within its first 28 bytes")},
      {"CutInPrefix", [] { return cut(27); }, damaged("byte 27: the file ends within its first 28 bytes")},
      {"CutAfterPrefix", [] { return cut(28); }, damaged("byte 16: it claims 640 bytes and has 28")},
      {"CutInInfo", [] { return cut(100); }, damaged("byte 16: it claims 640 bytes and has 100")},
      {"CutInLandmarks", [] { return cut(300); }, damaged("byte 16: it claims 640 bytes and has 300")},
      {"CutInPath", [] { return cut(583); }, damaged("byte 16: it claims 640 bytes and has 583")},
      {"TrailingByte",
       [] {
         Bytes bytes = sample_bytes();
         bytes.push_back(0);
         return bytes;
       },
       damaged("byte 16: it claims 640 bytes and has 641")},
      {"FlippedVersion", [] { return flip(8); },
       damaged("byte 24: the checksum is 0xC424BC7A but the bytes give 0x220382E4")},
      {"FlippedSize", [] { return flip(16); },
       damaged("byte 24: the checksum is 0xC424BC7A but the bytes give 0xB89F8D51")},
      {"FlippedPrefixChecksum", [] { return flip(24); },
       damaged("byte 24: the checksum is 0xC424BC6A but the bytes give 0xC424BC7A")},
      {"FlippedTag", [] { return flip(kLandHead); },
       damaged("byte 176: section LAND should begin here, found \"\\AND\"")},
      {"FlippedRecordSize", [] { return flip(kLandHead + 8); },
       damaged("byte 180: section LAND: 5 records of 80 bytes are not of this format")},
      {"FlippedCount", [] { return flip(kPathHead + 4); },
       damaged("byte 516: section PATH claims 608 bytes; 112 are left")},
      {"FlippedWeight", [] { return flip(kInfo + 24); },
       damaged("byte 40: section INFO: the checksum is 0x0D9689BA but the bytes give 0xDF21BAF1")},
      {"FlippedName", [] { return flip(kLandHead - 1); },
       damaged("byte 40: section INFO: the checksum is 0x0D9689BA but the bytes give 0x102199DE")},
      {"FlippedPosition", [] { return flip(kLand + 40); },
       damaged("byte 188: section LAND: the checksum is 0xBEEC9D55 but the bytes give 0xCE7C21C1")},
      {"FlippedPose", [] { return flip(kEnd - 1); },
       damaged("byte 524: section PATH: the checksum is 0x57574A99 but the bytes give 0x4AE05AFD")},
      {"FlippedSectionChecksum", [] { return flip(kPathHead + 12); },
       damaged("byte 524: section PATH: the checksum is 0x57574A89 but the bytes give 0x57574A99")},
      {"SwappedSections", swapped_sections,
       damaged("byte 176: section LAND should begin here, found \"PATH\"")},
  };
}

std::vector<Damage> lying_files() {
  return {
      {"NewerVersion", [] { return with_prefix(8, 6, 4); },
       "byte 8: the format is version 6; this program reads version 5: install a newer slamsensor"},
      {"VersionZero", [] { return with_prefix(8, 0, 4); }, damaged("byte 8: there is no format version 0")},
      {"OlderVersion", [] { return with_prefix(8, 2, 4); }, damaged("byte 8: there is no format version 2")},
      {"FiveSections", [] { return with_prefix(12, 5, 4); },
       damaged("byte 12: it claims 5 sections; version 5 has 4")},
      {"HugeSize", [] { return with_prefix(16, UINT64_MAX, 8); },
       damaged("byte 16: it claims 18446744073709551615 bytes and has 640")},
      {"BytesBehind", [] { return longer(7); }, damaged("byte 640: 7 bytes stand behind the last section")},
      {"NoSections", [] { return sealed_cut(28); },
       damaged("byte 28: the file ends where section INFO should begin")},
      {"HalfASectionHead", [] { return sealed_cut(kLandHead + 9); },
       damaged("byte 176: the file ends where section LAND should begin")},
      {"NoPath", [] { return sealed_cut(kPathHead); },
       damaged("byte 512: the file ends where section PATH should begin")},
      {"MillionsOfLandmarks", [] { return with_section(kLandHead, kPathHead, kLandHead + 4, 0xFFFFFFFF); },
       damaged("byte 180: section LAND claims 274877906880 bytes; 448 are left")},
      {"TwoInfos", [] { return with_section(kInfoHead, kLandHead, kInfoHead + 4, 2); },
       damaged("byte 32: section INFO: 2 records of 132 bytes are not of this format")},
      {"HugeInfo", [] { return with_section(kInfoHead, kLandHead, kInfoHead + 8, 0xFFFFFFF0); },
       damaged("byte 32: section INFO claims 4294967280 bytes; 596 are left")},
      {"LongName", [] { return with_section(kInfoHead, kLandHead, kLandHead - 11, 0xFFFF); },
       damaged("byte 44: section INFO: its fields do not make up its 132 bytes")},
      {"NoSuchDatumFlag", [] { return with_section(kInfoHead, kLandHead, kInfo + 88, 0xC30002); },
       damaged("byte 44: section INFO: its fields do not make up its 132 bytes")},
  };
}

std::vector<Damage> flawed_maps() {
  return {
      {"NameWithPath", changed([](MapFile& m) { m.about.name = "../../etc/x"; }),
       not_ours("byte 44: section INFO: the name \"../../etc/x\" is none that a map can have")},
      {"NoName", changed([](MapFile& m) { m.about.name.clear(); }),
       not_ours("byte 44: section INFO: the name \"\" is none that a map can have")},
      {"TimeBefore1970", changed([](MapFile& m) { m.about.saved_utc_s = -1; }),
       not_ours("byte 44: section INFO: a time is not between the years 1970 and 9999")},
      {"TimeAfter9999", changed([](MapFile& m) { m.about.created_utc_s = INT64_MAX; }),
       not_ours("byte 44: section INFO: a time is not between the years 1970 and 9999")},
      {"DatumNan", changed([](MapFile& m) { m.about.datum->height_m = kNan; }),
       not_ours("byte 44: section INFO: the datum is no place on the earth")},
      {"DatumBeyondThePole", changed([](MapFile& m) { m.about.datum->latitude_deg = 90.5; }),
       not_ours("byte 44: section INFO: the datum is no place on the earth")},
      {"NoLandmarks", changed([](MapFile& m) {
         m.landmarks.clear();
         m.positions_W.clear();
       }),
       "it holds 0 landmarks; a place is found from three or more: it is of no use"},
      {"TwoLandmarks", changed([](MapFile& m) {
         m.landmarks.resize(2);
         m.positions_W.resize(2);
       }),
       "it holds 2 landmarks; a place is found from three or more: it is of no use"},
      {"IdTwice", changed([](MapFile& m) { m.landmarks[2].id = 1; }),
       not_ours("landmark 2 (id 1): its id is not larger than the one before")},
      {"IdToCome", changed([](MapFile& m) { m.numbers.next_id = 8; }),
       not_ours("landmark 4 (id 8): its id was not given out yet")},
      {"PositionNan", changed([](MapFile& m) { m.positions_W[1].x() = kNan; }),
       not_ours("landmark 1 (id 1): its position is not a place within 65 km of the origin")},
      {"PositionInfinite", changed([](MapFile& m) { m.positions_W[4].y() = HUGE_VAL; }),
       not_ours("landmark 4 (id 8): its position is not a place within 65 km of the origin")},
      {"PositionFar", changed([](MapFile& m) { m.positions_W[0].y() = 1e6; }),
       not_ours("landmark 0 (id 0): its position is not a place within 65 km of the origin")},
      {"ParentToCome", changed([](MapFile& m) { m.landmarks[3].parents[0] = 77; }),
       not_ours("landmark 3 (id 5): its parents are not three other landmarks that triangulated it")},
      {"ParentsInACircle", changed([](MapFile& m) {
         m.landmarks[3].parents = {0, 1, 8};
       }),
       not_ours("landmark 3 (id 5): a parent is not nearer to the origin (xi) than it is")},
      {"NeverSeen", changed([](MapFile& m) { m.landmarks[0].sightings = 0; }),
       not_ours("landmark 0 (id 0): it was never seen")},
      {"SigmaNegative", changed([](MapFile& m) { m.landmarks[3].sigma_m = -1.0F; }),
       not_ours("landmark 3 (id 5): its sigma is not a length")},
      {"SizeNan", changed([](MapFile& m) { m.landmarks[2].size.ln_diameter = NAN; }),
       not_ours("landmark 2 (id 2): its diameter is none that can be measured")},
      {"SeenInTheFuture", changed([](MapFile& m) { m.numbers.scans = 39; }),
       not_ours("landmark 3 (id 5): it was last seen before it was first seen, or in a scan that is still to "
                "come")},
      {"PathBackwards", changed([](MapFile& m) { m.path[2].scan = 3; }),
       not_ours("pose 2 of the path: its scan is not later than the one before, or is still to come")},
      {"PoseNan", changed([](MapFile& m) { m.path[1].pose_W.heading_rad = kNan; }),
       not_ours("pose 1 of the path: it is not a finite pose")},
  };
}

}  // namespace slamsensor::tests
