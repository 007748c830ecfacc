#include "tools/input/pcd_header.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace slamsensor::tools {
namespace {

/// The keys of a PCD header, as indices of kPcdKeys.
enum PcdKey : std::size_t {
  kVersion,
  kFields,
  kSize,
  kType,
  kCount,
  kWidth,
  kHeight,
  kViewpoint,
  kPoints,
  kData
};
inline constexpr std::array<std::string_view, 10> kPcdKeys{
    "VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

/// The line of a key.
struct PcdEntry {
  std::vector<std::string_view> words;
  std::size_t line = 0;  ///< 0: the key has not come
};

/// The lines of a header.
struct PcdEntries {
  std::array<PcdEntry, kPcdKeys.size()> of_key;
  std::size_t end_bytes = 0;  ///< where the line after DATA begins
  std::size_t last_line = 0;  ///< number of the DATA line
};

using Status = tl::expected<void, InputError>;

std::optional<std::size_t> key_of(std::string_view word) {
  if (same_but_for_case(word, "COLUMNS")) {  // what version 0.5 called FIELDS
    return kFields;
  }
  const auto found = std::find_if(kPcdKeys.begin(), kPcdKeys.end(),
                                  [&](std::string_view key) { return same_but_for_case(word, key); });
  return found == kPcdKeys.end() ? std::nullopt
                                 : std::optional(static_cast<std::size_t>(found - kPcdKeys.begin()));
}

Status take_entry(const LineReader& lines, std::string_view name, PcdEntries& entries) {
  std::string_view rest = lines.line();
  const std::string_view word = take_word(rest);
  const std::optional<std::size_t> key = key_of(word);
  if (!key) {
    return refuse_line(name, lines.number(),
                       in_quotes(word) + " is not a key of a PCD header; is this a PCD file?");
  }
  PcdEntry& entry = entries.of_key[*key];
  if (entry.line != 0) {
    return refuse_line(
        name, lines.number(),
        std::string(kPcdKeys[*key]) + " is already in line " + std::to_string(entry.line) + "; remove one");
  }
  entry.line = lines.number();
  for (std::string_view value = take_word(rest); !value.empty(); value = take_word(rest)) {
    if (entry.words.size() == kPcdFieldsMax) {
      return refuse_line(name, entry.line,
                         "has more than " + std::to_string(kPcdFieldsMax) + " values; leave fields out");
    }
    entry.words.push_back(value);
  }
  return {};
}

/// The lines that `bytes` begin with, up to DATA; keys in upper or lower case. An error when a key is unknown
/// or there twice, or no DATA line comes within kPcdHeaderBytesMax.
tl::expected<PcdEntries, InputError> read_pcd_entries(std::string_view bytes, std::string_view name) {
  if (auto checked = check_encoding(bytes, name); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  PcdEntries entries;
  LineReader lines(bytes.substr(0, kPcdHeaderBytesMax));
  while (lines.next() && (lines.ended() || lines.consumed_bytes() == bytes.size())) {
    if (auto taken = take_entry(lines, name, entries); !taken) {
      return tl::unexpected(std::move(taken.error()));
    }
    entries.end_bytes = lines.consumed_bytes();
    entries.last_line = lines.number();
    if (entries.of_key[kData].line != 0) {
      return entries;
    }
  }
  return refuse(name, "no DATA line in its first " +
                          std::to_string(std::min(bytes.size(), kPcdHeaderBytesMax)) +
                          " bytes; is this a PCD file, and is it complete?");
}

/// An error when a key that every header has is missing.
tl::expected<void, InputError> check_pcd_entries(const PcdEntries& entries, std::string_view name) {
  for (const PcdKey key : {kFields, kSize, kType, kWidth, kHeight, kPoints}) {
    if (entries.of_key[key].line == 0) {
      return refuse(name, "the header has no " + std::string(kPcdKeys[key]) + " line; add it before DATA");
    }
  }
  return {};
}

using Status = tl::expected<void, InputError>;

constexpr double kQuaternionTolerance = 0.01;  // of its length; files are written with few decimals

// The one whole number of an entry, from `min` to `max`.
tl::expected<std::uint64_t, InputError> bounded(std::string_view word, const PcdEntry& entry, PcdKey key,
                                                std::string_view name, std::uint64_t min, std::uint64_t max) {
  const std::optional<std::int64_t> value = parse_integer(word);
  if (!value || *value < 0 || static_cast<std::uint64_t>(*value) < min ||
      static_cast<std::uint64_t>(*value) > max) {
    return refuse_line(name, entry.line,
                       std::string(kPcdKeys[key]) + " is " + in_quotes(word) +
                           "; allowed is a whole number from " + std::to_string(min) + " to " +
                           std::to_string(max));
  }
  return static_cast<std::uint64_t>(*value);
}

tl::expected<std::uint64_t, InputError> single(const PcdEntries& entries, PcdKey key, std::string_view name) {
  const PcdEntry& entry = entries.of_key[key];
  if (entry.words.size() != 1) {
    return refuse_line(name, entry.line,
                       std::string(kPcdKeys[key]) + " has " + std::to_string(entry.words.size()) +
                           " values; it must have one");
  }
  return bounded(entry.words.front(), entry, key, name, 0, kPcdPointsMax);
}

tl::expected<PcdType, InputError> parse_type(std::string_view word, std::size_t size_bytes, std::size_t line,
                                             std::string_view name) {
  const bool whole_size = size_bytes == 1 || size_bytes == 2 || size_bytes == 4 || size_bytes == 8;
  if (same_but_for_case(word, "F") && (size_bytes == 4 || size_bytes == 8)) {
    return PcdType::Float;
  }
  if (same_but_for_case(word, "I") && whole_size) {
    return PcdType::Signed;
  }
  if (same_but_for_case(word, "U") && whole_size) {
    return PcdType::Unsigned;
  }
  return refuse_line(name, line,
                     "type " + in_quotes(word) + " of size " + std::to_string(size_bytes) +
                         " does not exist; there are F of 4 and 8 bytes, I and U of 1, 2, 4 and 8");
}

tl::expected<PcdField, InputError> parse_field(const PcdEntries& entries, std::size_t i,
                                               std::string_view name) {
  const PcdEntry& sizes = entries.of_key[kSize];
  const PcdEntry& types = entries.of_key[kType];
  const PcdEntry& counts = entries.of_key[kCount];
  PcdField field;
  field.name = entries.of_key[kFields].words[i];
  const auto size_bytes = bounded(sizes.words[i], sizes, kSize, name, 1, 8);
  if (!size_bytes) {
    return tl::unexpected(size_bytes.error());
  }
  field.size_bytes = *size_bytes;
  const auto type = parse_type(types.words[i], field.size_bytes, types.line, name);
  if (!type) {
    return tl::unexpected(type.error());
  }
  field.type = *type;
  if (counts.line != 0) {
    const auto count = bounded(counts.words[i], counts, kCount, name, 0, kPcdCountMax);
    if (!count) {
      return tl::unexpected(count.error());
    }
    field.count = *count;
  }
  return field;
}

Status fill_fields(const PcdEntries& entries, std::string_view name, PcdHeader& header) {
  const std::size_t fields = entries.of_key[kFields].words.size();
  for (const PcdKey key : {kSize, kType, kCount}) {
    const PcdEntry& entry = entries.of_key[key];
    if (entry.line != 0 && entry.words.size() != fields) {
      return refuse_line(name, entry.line,
                         std::string(kPcdKeys[key]) + " has " + std::to_string(entry.words.size()) +
                             " values for " + std::to_string(fields) + " fields; it must have one for each");
    }
  }
  for (std::size_t i = 0; i < fields; ++i) {
    auto field = parse_field(entries, i, name);
    if (!field) {
      return tl::unexpected(std::move(field.error()));
    }
    field->offset_bytes = header.stride_bytes;
    field->first_value = header.values;
    header.stride_bytes += field->total_bytes();  // at most kPcdFieldsMax * kPcdCountMax * 8
    header.values += field->count;
    header.fields.push_back(std::move(*field));
  }
  return {};
}

tl::expected<std::optional<std::size_t>, InputError> find_field(const PcdHeader& header, std::size_t line,
                                                                std::string_view wanted,
                                                                std::string_view name) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < header.fields.size(); ++i) {
    if (!same_but_for_case(header.fields[i].name, wanted)) {
      continue;
    }
    if (found) {
      return refuse_line(name, line, "names the field " + in_quotes(wanted) + " twice; rename one to _");
    }
    if (header.fields[i].count != 1) {
      return refuse_line(name, line,
                         "the field " + in_quotes(wanted) + " has COUNT " +
                             std::to_string(header.fields[i].count) + "; it must have 1");
    }
    found = i;
  }
  return found;
}

Status place_fields(const PcdEntries& entries, std::string_view name, PcdHeader& header) {
  const std::size_t line = entries.of_key[kFields].line;
  const std::array<std::pair<std::string_view, std::size_t*>, 3> required{
      {{"x", &header.x}, {"y", &header.y}, {"z", &header.z}}};
  for (const auto& [wanted, place] : required) {
    const auto found = find_field(header, line, wanted, name);
    if (!found) {
      return tl::unexpected(found.error());
    }
    if (!*found) {
      return refuse_line(name, line, "has no field " + in_quotes(wanted) + "; x, y and z are needed");
    }
    *place = **found;
  }
  return find_field(header, line, "ring", name).map([&](std::optional<std::size_t> ring) {
    header.ring = ring;
  });
}

Status fill_points(const PcdEntries& entries, std::string_view name, PcdHeader& header) {
  const auto width = single(entries, kWidth, name);
  const auto height = width ? single(entries, kHeight, name) : width;
  const auto points = height ? single(entries, kPoints, name) : height;
  if (!points) {
    return tl::unexpected(points.error());
  }
  // Neither product below can overflow: each factor is at most kPcdPointsMax or the bounds of the fields.
  if (*width * *height != *points) {
    return refuse_line(name, entries.of_key[kPoints].line,
                       "POINTS is " + std::to_string(*points) + ", but WIDTH x HEIGHT is " +
                           std::to_string(*width * *height) + "; they must agree");
  }
  header.points = *points;
  return {};
}

// The sensor's pose in the frame of the points: three metres and a quaternion, its real part first.
Status fill_viewpoint(const PcdEntries& entries, std::string_view name, PcdHeader& header) {
  const PcdEntry& entry = entries.of_key[kViewpoint];
  if (entry.line == 0) {
    return {};
  }
  constexpr std::size_t kNumbers = 7;
  if (entry.words.size() != kNumbers) {
    return refuse_line(name, entry.line,
                       "VIEWPOINT has " + std::to_string(entry.words.size()) +
                           " values; it must have seven: tx ty tz qw qx qy qz");
  }
  std::array<double, kNumbers> values{};
  for (std::size_t i = 0; i < kNumbers; ++i) {
    const std::optional<double> value = parse_number(entry.words[i]);
    if (!value || !(std::abs(*value) <= kPcdViewpointReach_m)) {
      return refuse_line(name, entry.line,
                         "VIEWPOINT has the value " + in_quotes(entry.words[i]) +
                             "; allowed are numbers, tx ty tz within " + shown(kPcdViewpointReach_m) + " m");
    }
    values[i] = *value;
  }
  const Eigen::Quaterniond rotation(values[3], values[4], values[5], values[6]);
  if (!(std::abs(rotation.norm() - 1.0) <= kQuaternionTolerance)) {
    return refuse_line(name, entry.line,
                       "the quaternion of VIEWPOINT has length " + shown(rotation.norm()) +
                           "; it must be 1 within 1 %, in the order qw qx qy qz (1 0 0 0 is no rotation)");
  }
  header.T_cloud_L = Eigen::Translation3d(values[0], values[1], values[2]) * rotation.normalized();
  return {};
}

Status fill_data(const PcdEntries& entries, std::string_view name, PcdHeader& header) {
  constexpr std::array<std::pair<std::string_view, PcdData>, 3> kKinds{
      {{"ascii", PcdData::Ascii},
       {"binary", PcdData::Binary},
       {"binary_compressed", PcdData::BinaryCompressed}}};
  header.data_offset_bytes = entries.end_bytes;
  header.data_line = entries.last_line + 1;
  const PcdEntry& entry = entries.of_key[kData];
  for (const auto& [word, kind] : kKinds) {
    if (entry.words.size() == 1 && same_but_for_case(entry.words.front(), word)) {
      header.data = kind;
      return {};
    }
  }
  return refuse_line(name, entry.line,
                     "DATA is " + in_quotes(entry.words.empty() ? "" : entry.words.front()) +
                         "; allowed are ascii, binary and binary_compressed");
}

}  // namespace

tl::expected<PcdHeader, InputError> parse_pcd_header(std::string_view bytes, std::string_view name) {
  auto entries = read_pcd_entries(bytes, name);
  if (!entries) {
    return tl::unexpected(std::move(entries.error()));
  }
  PcdHeader header;
  const Status status = check_pcd_entries(*entries, name)
                            .and_then([&] { return fill_fields(*entries, name, header); })
                            .and_then([&] { return place_fields(*entries, name, header); })
                            .and_then([&] { return fill_points(*entries, name, header); })
                            .and_then([&] { return fill_viewpoint(*entries, name, header); })
                            .and_then([&] { return fill_data(*entries, name, header); });
  if (!status) {
    return tl::unexpected(status.error());
  }
  return header;
}

}  // namespace slamsensor::tools
