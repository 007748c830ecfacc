#include "tools/input/pcd.hpp"

#include "tools/input/input_scan.hpp"
#include "tools/input/lzf.hpp"
#include "tools/input/pcd_header.hpp"
#include "tools/input/pcd_values.hpp"
#include "tools/input/text.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace slamsensor::tools {
namespace {

using Status = tl::expected<void, InputError>;

constexpr std::size_t kPackedSizesBytes = 8;  // two numbers before packed data

// The values of a point that matter; ring is 0 without a ring field.
struct RawPoint {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double ring = 0.0;
};

// Whether a place is the sensor's own, as it is where nothing came back. The rounding of a float grows with
// the distance between the sensor and the origin of the cloud's frame.
bool is_at_sensor(double reach_m, const PcdHeader& header) {
  constexpr double kFloatRounding = 1e-6;
  return reach_m <= kFloatRounding * header.T_cloud_L.translation().norm();
}

// Takes a point into the cloud, or counts it as one without direction. What is wrong with it, if anything.
std::optional<std::string> take_point(const RawPoint& raw, const PcdHeader& header, PointCloud& cloud) {
  const Eigen::Vector3d position_cloud(raw.x_m, raw.y_m, raw.z_m);
  if (position_cloud.hasNaN() || position_cloud.isZero(0.0)) {
    ++cloud.points_skipped;
    return std::nullopt;
  }
  const Eigen::Vector3d position_L = header.T_cloud_L.inverse() * position_cloud;
  const double reach_m = position_L.norm();
  if (!(reach_m <= kInputReach_m)) {
    return "lies at (" + shown(raw.x_m) + ", " + shown(raw.y_m) + ", " + shown(raw.z_m) + "), beyond " +
           shown(kInputReach_m) + " m from the sensor; write NaN where nothing came back";
  }
  if (is_at_sensor(reach_m, header)) {
    ++cloud.points_skipped;
    return std::nullopt;
  }
  if (!(raw.ring >= 0.0 && raw.ring <= kRingMax && raw.ring == std::floor(raw.ring))) {
    return "has ring " + shown(raw.ring) + "; allowed is a whole number from 0 to " +
           std::to_string(kRingMax);
  }
  cloud.points.push_back({position_L, static_cast<std::uint32_t>(raw.ring)});
  return std::nullopt;
}

Status refuse_size(const PcdHeader& header, std::string_view name, std::uint64_t wanted,
                   std::uint64_t found) {
  return refuse(name, std::to_string(header.points) + " points of " + std::to_string(header.stride_bytes) +
                          " bytes need " + std::to_string(wanted) + " bytes after byte " +
                          std::to_string(header.data_offset_bytes) + ", but " + std::to_string(found) +
                          " follow; the file is cut short");
}

// Zeros and line ends behind the points are what the writers of binary files leave; other bytes are worth a
// remark.
void remark_on_rest(std::string_view rest, std::string_view name, PointCloud& cloud) {
  constexpr std::string_view kLeftByWriters("\0 \t\r\n", 5);
  if (rest.find_first_not_of(kLeftByWriters) != std::string_view::npos) {
    cloud.remark = std::string(name) + ": " + std::to_string(rest.size()) +
                   " bytes follow the points that the header declares; they are not read";
  }
}

// The word at `place` (counted over all values of a line) as a number; NaN stays NaN.
tl::expected<double, InputError> ascii_value(const std::vector<std::string_view>& words, std::size_t place,
                                             std::string_view name, std::size_t line) {
  const std::optional<double> value = parse_number(words[place]);
  if (!value) {
    return refuse_line(name, line,
                       "value " + std::to_string(place + 1) + " is " + in_quotes(words[place]) +
                           "; allowed is a number, or nan where nothing came back");
  }
  return *value;
}

tl::expected<RawPoint, InputError> ascii_point(const PcdHeader& header,
                                               const std::vector<std::string_view>& words,
                                               std::string_view name, std::size_t line) {
  RawPoint raw;
  std::array<std::pair<std::size_t, double*>, 4> wanted{{{header.x, &raw.x_m},
                                                         {header.y, &raw.y_m},
                                                         {header.z, &raw.z_m},
                                                         {header.ring.value_or(header.x), nullptr}}};
  if (header.ring) {
    wanted[3].second = &raw.ring;
  }
  for (const auto& [field, target] : wanted) {
    if (target == nullptr) {
      continue;
    }
    const auto value = ascii_value(words, header.fields[field].first_value, name, line);
    if (!value) {
      return tl::unexpected(value.error());
    }
    *target = *value;
  }
  return raw;
}

// Parts a line into the values of a point.
Status split_values(std::string_view line, std::size_t values, std::string_view name, std::size_t number,
                    std::vector<std::string_view>& words) {
  words.clear();
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    if (words.size() == values) {
      return refuse_line(name, number, "has more than the " + std::to_string(values) + " values of a point");
    }
    words.push_back(word);
  }
  if (words.size() < values) {
    return refuse_line(name, number,
                       "has " + std::to_string(words.size()) + " of the " + std::to_string(values) +
                           " values of a point; the file may be cut short");
  }
  return {};
}

Status read_ascii(std::string_view body, const PcdHeader& header, std::string_view name, PointCloud& cloud) {
  std::vector<std::string_view> words;
  std::size_t points = 0;
  LineReader lines(body, header.data_line);
  for (; points < header.points && lines.next(); ++points) {
    if (auto split = split_values(lines.line(), header.values, name, lines.number(), words); !split) {
      return split;
    }
    const auto raw = ascii_point(header, words, name, lines.number());
    if (!raw) {
      return tl::unexpected(raw.error());
    }
    if (const auto problem = take_point(*raw, header, cloud)) {
      return refuse_line(name, lines.number(), "the point " + *problem);
    }
  }
  if (points < header.points) {
    return refuse(name, "holds " + std::to_string(points) + " of the " + std::to_string(header.points) +
                            " points that the header declares; the file is cut short");
  }
  remark_on_rest(body.substr(lines.consumed_bytes()), name, cloud);
  return {};
}

// The columns that a cloud is made of.
struct Columns {
  PcdColumn x;
  PcdColumn y;
  PcdColumn z;
  std::optional<PcdColumn> ring;
};

template <typename ColumnOf>
Columns columns_of(const PcdHeader& header, ColumnOf&& column_of) {
  Columns columns{column_of(header.x), column_of(header.y), column_of(header.z), std::nullopt};
  if (header.ring) {
    columns.ring = column_of(*header.ring);
  }
  return columns;
}

Status read_columns(const Columns& columns, const PcdHeader& header, std::string_view name,
                    PointCloud& cloud) {
  cloud.points.reserve(header.points);  // the file was found to hold them
  for (std::size_t i = 0; i < header.points; ++i) {
    const RawPoint raw{columns.x.value(i), columns.y.value(i), columns.z.value(i),
                       columns.ring ? columns.ring->value(i) : 0.0};
    if (const auto problem = take_point(raw, header, cloud)) {
      const std::string where =
          header.data == PcdData::Binary
              ? " at byte " + std::to_string(header.data_offset_bytes + i * header.stride_bytes)
              : " of the packed data";
      return refuse(name, "point " + std::to_string(i) + where + " " + *problem);
    }
  }
  return {};
}

Status read_binary(std::string_view body, const PcdHeader& header, std::string_view name, PointCloud& cloud) {
  const std::uint64_t wanted = std::uint64_t{header.points} * header.stride_bytes;
  if (body.size() < wanted) {
    return refuse_size(header, name, wanted, body.size());
  }
  remark_on_rest(body.substr(wanted), name, cloud);
  const auto column = [&](std::size_t field) {
    return column_of_points(body, header.fields[field], header.stride_bytes);
  };
  return read_columns(columns_of(header, column), header, name, cloud);
}

// Bytes of the fields before `field`, for all points; padding counts only where it was packed too.
std::size_t bytes_before(const PcdHeader& header, std::size_t field, bool padding_packed) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < field; ++i) {
    if (padding_packed || !header.fields[i].is_padding()) {
      bytes += header.fields[i].total_bytes() * header.points;
    }
  }
  return bytes;
}

// The two sizes before the packed data, checked against what is there.
struct PackedSizes {
  std::size_t packed_bytes = 0;
  std::size_t unpacked_bytes = 0;
};

tl::expected<PackedSizes, InputError> packed_sizes(std::string_view body, const PcdHeader& header,
                                                   std::string_view name) {
  std::array<std::uint32_t, 2> sizes{};
  static_assert(sizeof sizes == kPackedSizesBytes);
  if (body.size() < sizeof sizes) {
    return refuse(name, "ends in the sizes of the packed data at byte " +
                            std::to_string(header.data_offset_bytes) + "; the file is cut short");
  }
  std::memcpy(sizes.data(), body.data(), sizeof sizes);
  if (sizes[0] > body.size() - sizeof sizes) {
    return refuse(name, "declares " + std::to_string(sizes[0]) + " bytes of packed data at byte " +
                            std::to_string(header.data_offset_bytes) + ", but " +
                            std::to_string(body.size() - sizeof sizes) + " follow; the file is cut short");
  }
  return PackedSizes{sizes[0], sizes[1]};
}

Status read_compressed(std::string_view body, const PcdHeader& header, std::string_view name,
                       PointCloud& cloud) {
  const auto sizes = packed_sizes(body, header, name);
  if (!sizes) {
    return tl::unexpected(sizes.error());
  }
  // The Point Cloud Library packs no padding; others pack whole points.
  const std::uint64_t with_padding = std::uint64_t{header.points} * header.stride_bytes;
  const std::uint64_t without_padding = bytes_before(header, header.fields.size(), false);
  if (sizes->unpacked_bytes != with_padding && sizes->unpacked_bytes != without_padding) {
    return refuse(name, "declares " + std::to_string(sizes->unpacked_bytes) +
                            " bytes of unpacked data, but " + std::to_string(header.points) +
                            " points need " + std::to_string(without_padding) + "; the file is damaged");
  }
  const auto unpacked =
      unpack_lzf(body.substr(kPackedSizesBytes, sizes->packed_bytes), sizes->unpacked_bytes);
  if (!unpacked) {
    return refuse(name, "the packed data from byte " +
                            std::to_string(header.data_offset_bytes + kPackedSizesBytes) + " is not LZF of " +
                            std::to_string(sizes->unpacked_bytes) + " bytes; the file is damaged");
  }
  remark_on_rest(body.substr(kPackedSizesBytes + sizes->packed_bytes), name, cloud);
  const std::string_view bytes(unpacked->data(), unpacked->size());
  const bool padding_packed = sizes->unpacked_bytes == with_padding;
  const auto column = [&](std::size_t field) {
    return column_of_fields(bytes, header.fields[field], bytes_before(header, field, padding_packed));
  };
  return read_columns(columns_of(header, column), header, name, cloud);
}

}  // namespace

tl::expected<PointCloud, InputError> parse_pcd(std::string_view bytes, std::string_view name) {
  const auto header = parse_pcd_header(bytes, name);
  if (!header) {
    return tl::unexpected(header.error());
  }
  PointCloud cloud;
  cloud.has_ring = header->ring.has_value();
  const std::string_view body = bytes.substr(header->data_offset_bytes);
  const auto read = header->data == PcdData::Ascii    ? read_ascii
                    : header->data == PcdData::Binary ? read_binary
                                                      : read_compressed;
  if (header->points == 0) {
    // A scan that saw nothing. Writers of packed data differ in whether two sizes follow.
    const bool has_sizes = header->data == PcdData::BinaryCompressed && body.size() >= kPackedSizesBytes;
    remark_on_rest(body.substr(has_sizes ? kPackedSizesBytes : 0), name, cloud);
    return cloud;
  }
  if (Status status = read(body, *header, name, cloud); !status) {
    return tl::unexpected(std::move(status.error()));
  }
  return cloud;
}

}  // namespace slamsensor::tools
