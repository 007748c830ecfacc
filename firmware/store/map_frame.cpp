#include "firmware/store/map_frame.hpp"

#include "firmware/store/byte_cursor.hpp"
#include "firmware/store/map_names.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace slamsensor::firmware {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Outcome = tl::expected<void, MapFileError>;

tl::unexpected<MapFileError> refuse(MapProblem problem, std::string message) {
  return tl::unexpected(MapFileError{problem, std::move(message)});
}

std::string crc_text(std::uint32_t crc) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "0x%08X", crc);
  return text.data();
}

std::string crc_mismatch(std::uint32_t told, std::uint32_t found) {
  return "the checksum is " + crc_text(told) + " but the bytes give " + crc_text(found);
}

Outcome check_magic(Bytes file) {
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

/// Whether prefix and size are sound, and the version is the one that is known.
Outcome check_prefix(Bytes file) {
  if (const Outcome magic = check_magic(file); !magic) {
    return magic;
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
  if (version < kMapVersion) {
    return damaged(8, "there is no format version " + std::to_string(version));
  }
  if (sections != kMapSectionTags.size()) {
    return damaged(12, "it claims " + std::to_string(sections) + " sections; version " +
                           std::to_string(version) + " has " + std::to_string(kMapSectionTags.size()));
  }
  if (size != file.size()) {
    return damaged(16, "it claims " + std::to_string(size) + " bytes and has " + std::to_string(file.size()));
  }
  return {};
}

/// The section at `begin`, when its head and checksum are sound.
tl::expected<MapFrameSection, MapFileError> read_section(Bytes file, std::size_t begin, MapSection wanted) {
  const std::string name(kMapSectionTags[static_cast<std::size_t>(wanted)]);
  const Bytes rest = file.subspan(begin);
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
  const std::uint32_t fixed = record_bytes_of(wanted);
  if (fixed != 0 ? section.record_bytes != fixed : section.records != 1) {
    return damaged(begin + 4, "section " + name + ": " + std::to_string(section.records) + " records of " +
                                  std::to_string(section.record_bytes) + " bytes are not of version " +
                                  std::to_string(kMapVersion));
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

tl::expected<MapFrame, MapFileError> read_frame(Bytes bytes) {
  if (const Outcome prefix = check_prefix(bytes); !prefix) {
    return tl::unexpected(prefix.error());
  }
  MapFrame frame;
  std::size_t begin = kMapPrefixBytes;
  for (std::uint32_t s = 0; s < kMapSectionTags.size(); ++s) {
    auto section = read_section(bytes, begin, static_cast<MapSection>(s));
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
