#include "tools/input/text_files.hpp"

#include "core/detection/levelling.hpp"
#include "core/graph/delaunay.hpp"
#include "tools/input/csv.hpp"
#include "tools/input/places.hpp"
#include "tools/input/scan_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>

namespace slamsensor::tools {
namespace {

enum LandmarkColumn : std::size_t { kScan, kLandmarkX, kLandmarkY, kDiameter, kWeight };
constexpr std::array<CsvColumn, 5> kLandmarkColumns{
    {{"scan"}, {"x_m"}, {"y_m"}, {"diameter_m", CsvNeed::Optional}, {"weight", CsvNeed::Optional}}};
constexpr CsvRange kPlace{-kInputReach_m, kInputReach_m, "m"};
constexpr CsvRange kDiameterRange{0.0, kInputReach_m, "m"};
constexpr CsvRange kWeightRange{0.0, std::numeric_limits<double>::max(), ""};

// Sets `target` to the row's number in `column`; leaves it when the list has no such column.
tl::expected<void, InputError> parse_into(double& target, const CsvReader& csv, std::size_t column,
                                          const CsvRange& range) {
  if (!csv.has(column)) {
    return {};
  }
  return csv.number(column, range).map([&](double value) { target = value; });
}

tl::expected<LandmarkRow, InputError> parse_landmark(const CsvReader& csv) {
  LandmarkRow row;
  const auto parsed =
      csv.whole_number(kScan, kScanNumberMax)
          .map([&](std::int64_t scan) { row.scan = scan; })
          .and_then([&] { return parse_into(row.position_L.x(), csv, kLandmarkX, kPlace); })
          .and_then([&] { return parse_into(row.position_L.y(), csv, kLandmarkY, kPlace); })
          .and_then([&] { return parse_into(row.diameter_m, csv, kDiameter, kDiameterRange); })
          .and_then([&] { return parse_into(row.weight, csv, kWeight, kWeightRange); });
  if (!parsed) {
    return tl::unexpected(parsed.error());
  }
  return row;
}

double weight_of(const LandmarkRow& row, firmware::LandmarkOrder order) {
  switch (order) {
    case firmware::LandmarkOrder::Diameter:
      return row.diameter_m;
    case firmware::LandmarkOrder::Nearest:
      return -row.position_L.norm();
    case firmware::LandmarkOrder::Weight:
      break;
  }
  return row.weight;
}

}  // namespace

tl::expected<LandmarkList, InputError> parse_landmark_csv(std::string_view text, std::string_view name) {
  auto csv = CsvReader::open(text, name, kLandmarkColumns, CsvOthers::Refused);
  if (!csv) {
    return tl::unexpected(std::move(csv.error()));
  }
  LandmarkList list;
  list.has_diameter = csv->has(kDiameter);
  list.has_weight = csv->has(kWeight);
  const auto take_row = [&] {
    return parse_landmark(*csv).map([&](const LandmarkRow& row) { list.rows.push_back(row); });
  };
  if (auto taken = for_each_row(*csv, take_row); !taken) {
    return tl::unexpected(std::move(taken.error()));
  }
  if (list.rows.empty()) {
    return refuse(name, "holds no landmark, only a header; a row scan,x_m,y_m is needed for each");
  }
  std::stable_sort(list.rows.begin(), list.rows.end(),
                   [](const LandmarkRow& a, const LandmarkRow& b) { return a.scan < b.scan; });
  return list;
}

tl::expected<void, InputError> check_landmark_columns(const LandmarkList& list, std::string_view name,
                                                      const firmware::LandmarkListConfig& config) {
  if (config.order == firmware::LandmarkOrder::Diameter && !list.has_diameter) {
    return refuse(name,
                  "has no column diameter_m, which the configured landmark order needs; add it or order by "
                  "weight or nearest");
  }
  if (config.diameter_min_m > 0.0 && !list.has_diameter) {
    return refuse(name, "has no column diameter_m for the configured least diameter of " +
                            shown(config.diameter_min_m) + " m; add it or set the minimum to 0");
  }
  if (config.weight_min > 1.0 && !list.has_weight) {
    return refuse(name, "has no column weight, so every landmark weighs 1, below the configured minimum of " +
                            shown(config.weight_min) + "; add it or lower the minimum");
  }
  return {};
}

namespace {

constexpr double kOnePlace_m = 0.001;  // nearer to each other than this no two landmarks stand

/// The heaviest of them that reach the minimums, no two at one place.
ListScan heaviest_first(std::span<const LandmarkRow> rows, const firmware::LandmarkListConfig& config,
                        const core::DetectionConfig& detection) {
  ListScan scan;
  for (const LandmarkRow& row : rows) {
    if (row.position_L.norm() <= detection.range_max_m && row.weight >= config.weight_min &&
        row.diameter_m >= config.diameter_min_m) {
      scan.landmarks.push_back({row.position_L, weight_of(row, config.order), row.diameter_m});
    }
  }
  std::stable_sort(
      scan.landmarks.begin(), scan.landmarks.end(),
      [](const core::ScanLandmark& a, const core::ScanLandmark& b) { return a.weight > b.weight; });
  Places places(kOnePlace_m);
  const auto twins =
      std::remove_if(scan.landmarks.begin(), scan.landmarks.end(),
                     [&](const core::ScanLandmark& l) { return !places.is_new(l.position_L); });
  scan.at_one_place = static_cast<std::size_t>(std::distance(twins, scan.landmarks.end()));
  scan.landmarks.erase(twins, scan.landmarks.end());
  return scan;
}

}  // namespace

ListScan select_landmarks(std::span<const LandmarkRow> rows, const firmware::LandmarkListConfig& config,
                          const core::DetectionConfig& detection) {
  ListScan scan = heaviest_first(rows, config, detection);
  std::vector<core::ScanLandmark>& landmarks = scan.landmarks;
  const std::size_t room = detection.listed_most();
  if (landmarks.size() <= room) {
    return scan;
  }
  scan.beyond_max = landmarks.size() - room;
  // Of those that weigh as much as the last one that has room, the nearest are taken.
  const double least = landmarks[room - 1].weight;
  const auto alike = std::partition_point(landmarks.begin(), landmarks.end(),
                                          [&](const core::ScanLandmark& l) { return l.weight > least; });
  std::stable_sort(alike,
                   std::partition_point(alike, landmarks.end(),
                                        [&](const core::ScanLandmark& l) { return l.weight >= least; }),
                   [](const core::ScanLandmark& a, const core::ScanLandmark& b) {
                     return a.position_L.norm() < b.position_L.norm();
                   });
  landmarks.resize(room);
  return scan;
}

namespace {

enum ReadingColumn : std::size_t { kPan, kTilt, kRange, kRoll, kPitch };
constexpr std::array<CsvColumn, 5> kReadingColumns{{{"pan_deg"},
                                                    {"tilt_deg"},
                                                    {"range_m"},
                                                    {"roll_deg", CsvNeed::Optional},
                                                    {"pitch_deg", CsvNeed::Optional}}};

/// kNoReturn where there is no number; 0 and less, with which devices say the same, are still to be seen.
tl::expected<double, InputError> parse_range_m(const CsvReader& csv) {
  if (csv.text(kRange).empty()) {
    return core::Reading::kNoReturn;
  }
  return csv.number(kRange, {-kInputReach_m, kInputReach_m, "m, 0 or nothing when nothing came back"});
}

tl::expected<core::Reading, InputError> parse_reading(const CsvReader& csv) {
  const auto pan_deg = csv.number(kPan, {-360.0, 360.0, "deg"});
  if (!pan_deg) {
    return tl::unexpected(pan_deg.error());
  }
  const auto tilt_deg = csv.number(kTilt, {-90.0, 90.0, "deg"});
  if (!tilt_deg) {
    return tl::unexpected(tilt_deg.error());
  }
  const auto range_m = parse_range_m(csv);
  if (!range_m) {
    return tl::unexpected(range_m.error());
  }
  return core::Reading{*pan_deg * core::kDegree, *tilt_deg * core::kDegree, *range_m};
}

/// The attitude that the row holds.
tl::expected<core::Attitude, InputError> parse_attitude(const CsvReader& csv) {
  const auto roll_deg = csv.number(kRoll, {-180.0, 180.0, "deg"});
  if (!roll_deg) {
    return tl::unexpected(roll_deg.error());
  }
  const auto pitch_deg = csv.number(kPitch, {-90.0, 90.0, "deg"});
  if (!pitch_deg) {
    return tl::unexpected(pitch_deg.error());
  }
  return core::Attitude{*roll_deg * core::kDegree, *pitch_deg * core::kDegree};
}

/// Levels the readings of one file.
class RowLevelling {
 public:
  explicit RowLevelling(const firmware::LevellingConfig& config)
      : fixed_(config.source == firmware::InclinationSource::Fixed),
        level_(fixed_ ? config.fixed : core::Attitude{}) {}

  tl::expected<core::Reading, InputError> turn(const CsvReader& csv, const core::Reading& reading) {
    if (!csv.has(kRoll)) {
      return fixed_ ? level_(reading) : reading;
    }
    const auto attitude = parse_attitude(csv);
    if (!attitude) {
      return tl::unexpected(attitude.error());
    }
    return core::Levelling(*attitude)(reading);
  }

 private:
  bool fixed_;
  core::Levelling level_;
};

/// Roll and pitch come together, and a file without them is enough for settings without an inclinometer.
tl::expected<void, InputError> check_columns(const CsvReader& csv, std::string_view name,
                                             const firmware::LevellingConfig& levelling) {
  if (csv.has(kRoll) != csv.has(kPitch)) {
    return refuse(name, "has only one of the columns roll_deg and pitch_deg; both or none are needed");
  }
  if (!csv.has(kRoll) && levelling.has_inclinometer()) {
    return refuse(
        name,
        "tells no roll_deg and pitch_deg, which inclination.source asks for; set that to \"none\" for "
        "an upright sensor, or to \"fixed\"");
  }
  return {};
}

/// Tells from the rows of a file, in its order, whether they can be those of a sweep.
class SweepOrder {
 public:
  /// Whether the row begins a scanline.
  bool see(std::string_view tilt, double pan_rad) {
    const bool is_new_line = rows_ == 0 || tilt != tilt_;
    ++rows_;
    lines_ += is_new_line ? 1 : 0;
    tilts_.insert(tilt);
    const double step_rad = is_new_line ? 0.0 : pan_rad - pan_rad_;
    turns_ += step_rad * step_rad_ < 0.0 ? 1 : 0;
    step_rad_ = is_new_line || step_rad != 0.0 ? step_rad : step_rad_;
    tilt_ = tilt;
    pan_rad_ = pan_rad;
    return is_new_line;
  }

  /// What is wrong with the order, in a line; empty when nothing is.
  [[nodiscard]] std::string remark(std::string_view name) const {
    const bool is_torn = lines_ >= 2 * tilts_.size() && rows_ < kLineReadingsMin * lines_;
    const bool is_to_and_fro = turns_ > rows_ / 4;  // of rows by chance two in three are turns
    if (rows_ < kRowsMin || !(is_torn || is_to_and_fro)) {
      return {};
    }
    return std::string(name) + ": " +
           (is_torn ? std::to_string(tilts_.size()) + " tilts change " + std::to_string(lines_) +
                          " times in " + std::to_string(rows_) + " readings"
                    : "the pan turns back " + std::to_string(turns_) + " times in " + std::to_string(rows_) +
                          " readings") +
           ", which no sweep does; the order of the rows matters: sort them by tilt_deg, then by pan_deg, or "
           "keep the order in which they were measured";
  }

 private:
  static constexpr std::size_t kRowsMin = 20;
  static constexpr std::size_t kLineReadingsMin = 3;

  std::set<std::string_view> tilts_;
  std::string_view tilt_;
  double pan_rad_ = 0.0;
  double step_rad_ = 0.0;
  std::size_t rows_ = 0;
  std::size_t lines_ = 0;
  std::size_t turns_ = 0;
};

/// Takes the row of `csv` into the scan, levelled.
tl::expected<void, InputError> take_reading(const CsvReader& csv, RowLevelling& level, SweepOrder& order,
                                            ReadingsScan& scan) {
  auto reading = parse_reading(csv);
  if (!reading) {
    return tl::unexpected(std::move(reading.error()));
  }
  if (!csv.text(kRange).empty() && reading->range_m <= 0.0) {
    reading->range_m = core::Reading::kNoReturn;
    ++scan.zero_ranges;
  }
  const bool is_new_line = order.see(csv.text(kTilt), reading->pan_rad);
  auto levelled = level.turn(csv, *reading);
  if (!levelled) {
    return tl::unexpected(std::move(levelled.error()));
  }
  if (is_new_line) {
    scan.scanlines.emplace_back();
  }
  scan.scanlines.back().push_back(*levelled);
  return {};
}

}  // namespace

tl::expected<ReadingsScan, InputError> parse_readings_csv(std::string_view text, std::string_view name,
                                                          const firmware::LevellingConfig& levelling) {
  auto csv = CsvReader::open(text, name, kReadingColumns, CsvOthers::Refused);
  if (!csv) {
    return tl::unexpected(std::move(csv.error()));
  }
  if (auto checked = check_columns(*csv, name, levelling); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  RowLevelling level(levelling);
  SweepOrder order;
  ReadingsScan scan;
  const auto take_row = [&] { return take_reading(*csv, level, order, scan); };
  if (auto taken = for_each_row(*csv, take_row); !taken) {
    return tl::unexpected(std::move(taken.error()));
  }
  if (scan.scanlines.empty()) {
    return refuse(name, "holds no reading, only a header; a row pan_deg,tilt_deg,range_m is needed for each");
  }
  scan.remark = order.remark(name);
  return scan;
}

namespace {

enum MapColumn : std::size_t { kMapId, kMapX, kMapY, kMapSightings, kMapDiameter };
constexpr std::array<CsvColumn, 5> kMapColumns{
    {{"id"}, {"x_m"}, {"y_m"}, {"sightings", CsvNeed::Optional}, {"diameter_m", CsvNeed::Optional}}};
constexpr CsvRange kSightingsRange{1.0, 1e9, ""};
constexpr CsvRange kMapPlace{-core::kLatticeReach_m, core::kLatticeReach_m, "m"};

tl::expected<MapPoint, InputError> parse_map(const CsvReader& csv) {
  const auto id = csv.whole_number(kMapId, std::numeric_limits<std::int64_t>::max());
  if (!id) {
    return tl::unexpected(id.error());
  }
  const auto x_m = csv.number(kMapX, kMapPlace);
  if (!x_m) {
    return tl::unexpected(x_m.error());
  }
  const auto y_m = csv.number(kMapY, kMapPlace);
  if (!y_m) {
    return tl::unexpected(y_m.error());
  }
  MapPoint point{*id, {*x_m, *y_m}, {}, 0.0};
  if (csv.has(kMapDiameter) && !csv.text(kMapDiameter).empty()) {
    if (auto parsed = parse_into(point.diameter_m, csv, kMapDiameter, kDiameterRange); !parsed) {
      return tl::unexpected(std::move(parsed.error()));
    }
  }
  if (csv.has(kMapSightings)) {
    const auto sightings = csv.number(kMapSightings, kSightingsRange);
    if (!sightings) {
      return tl::unexpected(sightings.error());
    }
    point.sightings = static_cast<std::uint32_t>(*sightings);
  }
  return point;
}

}  // namespace

tl::expected<std::vector<MapPoint>, InputError> parse_map_csv(std::string_view text, std::string_view name) {
  auto csv = CsvReader::open(text, name, kMapColumns, CsvOthers::Ignored);
  if (!csv) {
    return tl::unexpected(std::move(csv.error()));
  }
  std::vector<MapPoint> rows;
  std::unordered_map<std::int64_t, std::size_t> line_of_id;
  const auto take_row = [&]() -> tl::expected<void, InputError> {
    auto row = parse_map(*csv);
    if (!row) {
      return tl::unexpected(std::move(row.error()));
    }
    const auto [seen, fresh] = line_of_id.try_emplace(row->id, csv->line());
    if (!fresh) {
      return refuse_line(name, csv->line(),
                         "id " + std::to_string(row->id) + " is already in line " +
                             std::to_string(seen->second) + "; give each landmark its own");
    }
    rows.push_back(*row);
    return {};
  };
  if (auto taken = for_each_row(*csv, take_row); !taken) {
    return tl::unexpected(std::move(taken.error()));
  }
  if (rows.empty()) {
    return refuse(name, "holds no landmark; a row id,x_m,y_m is needed for each");
  }
  return rows;
}

tl::expected<std::vector<MapPoint>, InputError> read_map_csv(const std::filesystem::path& path) {
  return read_file(path).and_then(
      [&](const std::string& text) { return parse_map_csv(text, path.string()); });
}

namespace {

constexpr double kLengthTolerance = 0.01;  // of a quaternion; files are written with two or more decimals
constexpr double kLevelMin = 1e-6;         // cosine of the pitch below which there is no heading to speak of

struct Row {
  TimedPose pose;
  std::size_t line = 0;
};

tl::expected<std::array<double, 8>, InputError> parse_numbers(std::string_view line, std::string_view name,
                                                              std::size_t number) {
  constexpr std::array<std::string_view, 8> kNames{"t", "x", "y", "z", "qx", "qy", "qz", "qw"};
  std::array<double, 8> values{};
  std::string_view rest = line;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string_view word = take_word(rest);
    const std::optional<double> value = parse_number(word);
    if (!value || !std::isfinite(*value)) {
      return refuse_line(name, number,
                         std::string(kNames[i]) + " is " + in_quotes(word) +
                             "; a line must hold eight finite numbers: t x y z qx qy qz qw");
    }
    values[i] = *value;
  }
  if (const std::string_view more = take_word(rest); !more.empty()) {
    return refuse_line(name, number,
                       in_quotes(more) + " follows the eight numbers t x y z qx qy qz qw; remove it");
  }
  return values;
}

// Yaw of the rotation R_z(yaw) R_y(pitch) R_x(roll); nothing when the x axis points straight up or down.
std::optional<double> yaw_rad(double qx, double qy, double qz, double qw) {
  const double forward_x = 1.0 - 2.0 * (qy * qy + qz * qz);
  const double forward_y = 2.0 * (qw * qz + qx * qy);
  if (std::hypot(forward_x, forward_y) < kLevelMin) {
    return std::nullopt;
  }
  return core::wrap_angle(std::atan2(forward_y, forward_x));
}

tl::expected<Row, InputError> parse_row(std::string_view line, std::string_view name, std::size_t number) {
  const auto values = parse_numbers(line, name, number);
  if (!values) {
    return tl::unexpected(values.error());
  }
  const auto& [t, x_m, y_m, z_m, qx, qy, qz, qw] = *values;
  const double length = std::sqrt(qx * qx + qy * qy + qz * qz + qw * qw);
  if (!(std::abs(length - 1.0) <= kLengthTolerance)) {
    return refuse_line(
        name, number,
        "the quaternion has length " + shown(length) + "; it must be 1 within 1 %, in the order qx qy qz qw");
  }
  const std::optional<double> heading_rad = yaw_rad(qx / length, qy / length, qz / length, qw / length);
  if (!heading_rad) {
    return refuse_line(name, number, "the pose points straight up or down and so has no heading; remove it");
  }
  return Row{TimedPose{t, core::Pose2{x_m, y_m, *heading_rad}}, number};
}

}  // namespace

tl::expected<std::vector<TimedPose>, InputError> parse_tum(std::string_view text, std::string_view name) {
  if (auto checked = check_encoding(text, name); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  std::vector<Row> rows;
  LineReader lines(text);
  while (lines.next()) {
    auto row = parse_row(lines.line(), name, lines.number());
    if (!row) {
      return tl::unexpected(std::move(row.error()));
    }
    rows.push_back(*row);
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.pose.t < b.pose.t; });
  std::vector<TimedPose> poses;
  poses.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && rows[i].pose.t == rows[i - 1].pose.t) {
      return refuse_line(
          name, rows[i].line,
          "t has the same value as in line " + std::to_string(rows[i - 1].line) + "; remove one");
    }
    poses.push_back(rows[i].pose);
  }
  return poses;
}

tl::expected<std::vector<TimedPose>, InputError> read_tum(const std::filesystem::path& path) {
  return read_file(path).and_then([&](const std::string& text) { return parse_tum(text, path.string()); });
}

}  // namespace slamsensor::tools
