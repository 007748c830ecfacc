#include "tools/input/readings_csv.hpp"

#include "core/config.hpp"
#include "tools/input/csv.hpp"
#include "tools/input/input_scan.hpp"

#include <array>
#include <cstddef>

namespace slamsensor::tools {
namespace {

enum Column : std::size_t { kPan, kTilt, kRange };
constexpr std::array<CsvColumn, 3> kColumns{{{"pan_deg"}, {"tilt_deg"}, {"range_m"}}};

tl::expected<double, InputError> parse_range_m(const CsvReader& csv) {
  if (csv.text(kRange).empty()) {
    return core::Reading::kNoReturn;
  }
  return csv.number(kRange, {0.0, kInputReach_m, "m, or nothing when nothing came back"});
}

tl::expected<core::Reading, InputError> parse_row(const CsvReader& csv) {
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

}  // namespace

tl::expected<std::vector<std::vector<core::Reading>>, InputError> parse_readings_csv(std::string_view text,
                                                                                     std::string_view name) {
  auto csv = CsvReader::open(text, name, kColumns, CsvOthers::Refused);
  if (!csv) {
    return tl::unexpected(std::move(csv.error()));
  }
  std::vector<std::vector<core::Reading>> scanlines;
  std::string_view tilt_text;
  const auto take_row = [&]() -> tl::expected<void, InputError> {
    auto reading = parse_row(*csv);
    if (!reading) {
      return tl::unexpected(std::move(reading.error()));
    }
    if (scanlines.empty() || csv->text(kTilt) != tilt_text) {
      tilt_text = csv->text(kTilt);
      scanlines.emplace_back();
    }
    scanlines.back().push_back(*reading);
    return {};
  };
  if (auto taken = for_each_row(*csv, take_row); !taken) {
    return tl::unexpected(std::move(taken.error()));
  }
  if (scanlines.empty()) {
    return refuse(name, "holds no reading, only a header; a row pan_deg,tilt_deg,range_m is needed for each");
  }
  return scanlines;
}

}  // namespace slamsensor::tools
