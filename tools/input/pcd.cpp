#include "tools/input/pcd.hpp"

#include "core/detection/levelling.hpp"
#include "tools/input/pcd_header.hpp"
#include "tools/input/scan_source.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <liblzf/lzf.h>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace slamsensor::tools {
namespace {

/// One field of all points of a cloud, as bytes: the value of point i starts `first_bytes + i * step_bytes`
/// into `bytes`.
struct PcdColumn {
  std::string_view bytes;
  std::size_t first_bytes = 0;
  std::size_t step_bytes = 0;
  PcdType type = PcdType::Float;
  std::size_t size_bytes = 0;

  /// The value of point `i` as a double (exact but for 64-bit integers beyond 2^53); NaN when it is not
  /// within `bytes`.
  [[nodiscard]] double value(std::size_t i) const;
};

static_assert(std::endian::native == std::endian::little, "PCD files are little-endian and read as they are");

template <typename T>
double load(std::string_view bytes) {
  T value{};
  std::memcpy(&value, bytes.data(), sizeof value);
  return static_cast<double>(value);
}

double load_signed(std::string_view bytes) {
  switch (bytes.size()) {
    case 1:
      return load<std::int8_t>(bytes);
    case 2:
      return load<std::int16_t>(bytes);
    case 4:
      return load<std::int32_t>(bytes);
    default:
      return load<std::int64_t>(bytes);
  }
}

double load_unsigned(std::string_view bytes) {
  switch (bytes.size()) {
    case 1:
      return load<std::uint8_t>(bytes);
    case 2:
      return load<std::uint16_t>(bytes);
    case 4:
      return load<std::uint32_t>(bytes);
    default:
      return load<std::uint64_t>(bytes);
  }
}

double PcdColumn::value(std::size_t i) const {
  const std::size_t at = first_bytes + i * step_bytes;
  if (at > bytes.size() || size_bytes > bytes.size() - at) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const std::string_view one = bytes.substr(at, size_bytes);
  switch (type) {
    case PcdType::Signed:
      return load_signed(one);
    case PcdType::Unsigned:
      return load_unsigned(one);
    case PcdType::Float:
      break;
  }
  return size_bytes == sizeof(float) ? load<float>(one) : load<double>(one);
}

/// The column of `field` in points of `stride_bytes` that follow each other (DATA binary).
PcdColumn column_of_points(std::string_view bytes, const PcdField& field, std::size_t stride_bytes) {
  return {bytes, field.offset_bytes, stride_bytes, field.type, field.size_bytes};
}

/// The column of `field` in fields that follow each other, all points of the first before the second's (what
/// binary_compressed unpacks to); `first_bytes` is where it starts.
PcdColumn column_of_fields(std::string_view bytes, const PcdField& field, std::size_t first_bytes) {
  return {bytes, first_bytes, field.total_bytes(), field.type, field.size_bytes};
}

using Status = tl::expected<void, InputError>;

constexpr std::size_t kPackedSizesBytes = 8;  // two numbers before packed data

// The values of a point that matter; ring is 0 without a ring field.
struct RawPoint {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double ring = 0.0;
};

// How far apart two floats are at the sensor's place in the cloud's frame; 0 where coordinates are more
// exact.
double float_spacing_m(const PcdHeader& header) {
  const auto is_float = [&](std::size_t field) {
    return header.fields[field].type == PcdType::Float && header.fields[field].size_bytes == sizeof(float);
  };
  if (header.data == PcdData::Ascii || !(is_float(header.x) || is_float(header.y) || is_float(header.z))) {
    return 0.0;
  }
  const auto farthest_m = static_cast<float>(header.T_cloud_L.translation().cwiseAbs().maxCoeff());
  return static_cast<double>(std::nextafter(farthest_m, std::numeric_limits<float>::max()) - farthest_m);
}

// Whether a place is the sensor's own, as it is where nothing came back. The place and VIEWPOINT are rounded:
// as their texts are, and as floats, whose rounding grows with the distance to the origin of the cloud's
// frame.
bool is_at_sensor(double reach_m, const PcdHeader& header) {
  constexpr double kTextRounding = 1e-6;
  constexpr double kTextRoundingMax_m = 1e-3;
  const double of_text_m =
      std::min(kTextRounding * header.T_cloud_L.translation().norm(), kTextRoundingMax_m);
  return reach_m <= std::max(of_text_m, float_spacing_m(header));
}

// A remark on coordinates that are too coarse for what they are; empty when they are not.
std::string remark_on_floats(const PcdHeader& header, std::string_view name) {
  constexpr double kCoarse_m = 0.01;
  const double spacing_m = float_spacing_m(header);
  if (spacing_m <= kCoarse_m) {
    return {};
  }
  return std::string(name) + ": its coordinates are floats of 4 bytes, which are " + shown(spacing_m) +
         " m apart at its VIEWPOINT, so the scan is that coarse; write SIZE 8, or points relative to the "
         "sensor";
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
                   " bytes follow the points that the header declares; they are not read" +
                   (cloud.remark.empty() ? "" : "\n  " + cloud.remark);
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

/// Three bytes of LZF stand for at most 264: nothing expands by more than this.
constexpr std::size_t kLzfExpansionMax = 88;

/// The `size_bytes` bytes that `packed` stands for in the LZF format; nothing when they are not exactly that
/// many. A size beyond what `packed` could expand to is refused before it is allocated.
std::optional<std::vector<char>> unpack_lzf(std::string_view packed, std::size_t size_bytes) {
  if (size_bytes / kLzfExpansionMax > packed.size()) {
    return std::nullopt;
  }
  std::vector<char> bytes(size_bytes);
  if (packed.empty()) {
    return bytes;
  }
  const unsigned unpacked = lzf_decompress(packed.data(), static_cast<unsigned>(packed.size()), bytes.data(),
                                           static_cast<unsigned>(bytes.size()));
  return unpacked == size_bytes && unpacked > 0 ? std::optional(std::move(bytes)) : std::nullopt;
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
  cloud.remark = remark_on_floats(*header, name);
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

namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

using Scanline = std::vector<core::Reading>;

double pan_rad(const Eigen::Vector3d& p) {
  const double angle_rad = std::atan2(p.y(), p.x());
  const double turned_rad = angle_rad < 0.0 ? angle_rad + kTurn_rad : angle_rad;
  return turned_rad < kTurn_rad ? turned_rad : 0.0;  // a tiny negative angle rounds up to the full turn
}

core::Reading reading_of(const Eigen::Vector3d& p) {
  return {pan_rad(p), std::atan2(p.z(), p.head<2>().norm()), p.norm()};
}

// The circle in columns of one width but for the last, which the turn cuts off.
class ColumnCircle {
 public:
  explicit ColumnCircle(double step_rad)
      : step_rad_(step_rad), count_(static_cast<std::size_t>(std::ceil(kTurn_rad / step_rad))) {}

  std::size_t count() const { return count_; }

  std::size_t column_of(double angle_rad) const {
    return std::min(static_cast<std::size_t>(std::floor(angle_rad / step_rad_)), count_ - 1);
  }

  double centre_rad(std::size_t column) const {
    const double first_rad = static_cast<double>(column) * step_rad_;
    return 0.5 * (first_rad + std::min(first_rad + step_rad_, kTurn_rad));
  }

 private:
  double step_rad_;
  std::size_t count_;
};

Scanline with_absent_columns(const Scanline& scanline, const ColumnCircle& columns) {
  Scanline full;
  full.reserve(scanline.size() + columns.count());
  double tilt_rad = scanline.back().tilt_rad;  // before column 0 comes the end of the turn
  std::size_t next = 0;
  for (std::size_t column = 0; column < columns.count(); ++column) {
    const std::size_t first = next;
    for (; next < scanline.size() && columns.column_of(scanline[next].pan_rad) == column; ++next) {
      full.push_back(scanline[next]);
      tilt_rad = scanline[next].tilt_rad;
    }
    if (next == first) {
      full.push_back({columns.centre_rad(column), tilt_rad, core::Reading::kNoReturn});
    }
  }
  return full;
}

}  // namespace

tl::expected<std::vector<Scanline>, InputError> scanlines_of_cloud(const PointCloud& cloud,
                                                                   const firmware::PointCloudConfig& config,
                                                                   double bearing_step_rad,
                                                                   std::string_view name) {
  const Eigen::Matrix3d R_level_L = core::level_from_sensor({config.roll_rad, config.pitch_rad});
  std::map<std::int64_t, Scanline> by_key;
  for (const CloudPoint& point : cloud.points) {
    const core::Reading reading = reading_of(R_level_L * point.position_L);
    const std::int64_t key =
        cloud.has_ring ? std::int64_t{point.ring}
                       : static_cast<std::int64_t>(std::llround(reading.tilt_rad / config.tilt_step_rad));
    by_key[key].push_back(reading);
  }
  const ColumnCircle columns(bearing_step_rad);
  const std::size_t absent = config.absent_is_no_return ? columns.count() : 0;
  if (cloud.points.size() + by_key.size() * absent > kCloudReadingsMax) {
    return refuse(name, "makes " + std::to_string(by_key.size()) + " scanlines of " + std::to_string(absent) +
                            " columns and " + std::to_string(cloud.points.size()) + " points, more than " +
                            std::to_string(kCloudReadingsMax) +
                            " readings; check the ring field, or configure larger steps");
  }
  std::vector<Scanline> scanlines;
  scanlines.reserve(by_key.size());
  for (auto& [key, scanline] : by_key) {
    std::stable_sort(scanline.begin(), scanline.end(),
                     [](const core::Reading& a, const core::Reading& b) { return a.pan_rad < b.pan_rad; });
    scanlines.push_back(config.absent_is_no_return ? with_absent_columns(scanline, columns)
                                                   : std::move(scanline));
  }
  return scanlines;
}

}  // namespace slamsensor::tools
