#include "tools/input/landmark_csv.hpp"

#include "tools/input/csv.hpp"
#include "tools/input/input_scan.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

namespace slamsensor::tools {
namespace {

enum Column : std::size_t { kScan, kX, kY, kDiameter, kWeight };
constexpr std::array<CsvColumn, 5> kColumns{
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

tl::expected<LandmarkRow, InputError> parse_row(const CsvReader& csv) {
  LandmarkRow row;
  const auto parsed =
      csv.whole_number(kScan, kScanNumberMax)
          .map([&](std::int64_t scan) { row.scan = scan; })
          .and_then([&] { return parse_into(row.position_L.x(), csv, kX, kPlace); })
          .and_then([&] { return parse_into(row.position_L.y(), csv, kY, kPlace); })
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
  auto csv = CsvReader::open(text, name, kColumns, CsvOthers::Refused);
  if (!csv) {
    return tl::unexpected(std::move(csv.error()));
  }
  LandmarkList list;
  list.has_diameter = csv->has(kDiameter);
  list.has_weight = csv->has(kWeight);
  const auto take_row = [&] {
    return parse_row(*csv).map([&](const LandmarkRow& row) { list.rows.push_back(row); });
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

std::vector<core::ScanLandmark> select_landmarks(std::span<const LandmarkRow> rows,
                                                 const firmware::LandmarkListConfig& config,
                                                 const core::DetectionConfig& detection) {
  std::vector<core::ScanLandmark> landmarks;
  for (const LandmarkRow& row : rows) {
    if (row.position_L.norm() <= detection.range_max_m && row.weight >= config.weight_min &&
        row.diameter_m >= config.diameter_min_m) {
      landmarks.push_back({row.position_L, weight_of(row, config.order)});
    }
  }
  std::stable_sort(
      landmarks.begin(), landmarks.end(),
      [](const core::ScanLandmark& a, const core::ScanLandmark& b) { return a.weight > b.weight; });
  landmarks.resize(std::min<std::size_t>(landmarks.size(), detection.landmarks_max));
  return landmarks;
}

}  // namespace slamsensor::tools
