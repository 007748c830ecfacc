#include "tools/input/readings_csv.hpp"

#include "core/config.hpp"
#include "core/detection/levelling.hpp"
#include "tools/input/csv.hpp"
#include "tools/input/input_scan.hpp"

#include <array>
#include <cstddef>

namespace slamsensor::tools {
namespace {

enum Column : std::size_t { kPan, kTilt, kRange, kRoll, kPitch };
constexpr std::array<CsvColumn, 5> kColumns{{{"pan_deg"},
                                             {"tilt_deg"},
                                             {"range_m"},
                                             {"roll_deg", CsvNeed::Optional},
                                             {"pitch_deg", CsvNeed::Optional}}};

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

/// The attitude that the row tells.
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

}  // namespace

tl::expected<std::vector<std::vector<core::Reading>>, InputError> parse_readings_csv(
    std::string_view text, std::string_view name, const firmware::LevellingConfig& levelling) {
  auto csv = CsvReader::open(text, name, kColumns, CsvOthers::Refused);
  if (!csv) {
    return tl::unexpected(std::move(csv.error()));
  }
  if (auto checked = check_columns(*csv, name, levelling); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  RowLevelling level(levelling);
  std::vector<std::vector<core::Reading>> scanlines;
  std::string_view tilt_text;
  const auto take_row = [&]() -> tl::expected<void, InputError> {
    auto reading = parse_row(*csv).and_then([&](const core::Reading& own) { return level.turn(*csv, own); });
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
