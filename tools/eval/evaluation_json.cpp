#include "tools/eval/evaluation_report.hpp"

#include <nlohmann/json.hpp>

namespace slamsensor::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

Json tenths_json(const AlignedErrors& errors) {
  Json list = Json::array();
  for (const TenthError& tenth : errors.tenths) {
    Json entry;
    entry["fixes"] = tenth.fixes;
    entry["ate_rms_m"] = tenth.fixes > 0 ? Json(tenth.rms_m) : Json(nullptr);
    entry["ate_max_m"] = tenth.fixes > 0 ? Json(tenth.max_m) : Json(nullptr);
    list.push_back(entry);
  }
  return list;
}

Json worst_json(const FixError& worst) {
  Json json;
  json["t"] = worst.t;
  json["distance_m"] = worst.distance_m;
  json["heading_deg"] = worst.heading_rad * kDegreesPerRadian;
  return json;
}

Json errors_json(const std::optional<AlignedErrors>& errors) {
  if (!errors) return nullptr;
  Json json;
  json["wrong_fixes"] = errors->wrong_fixes;
  json["ate_rms_m"] = errors->ate_rms_m;
  json["ate_median_m"] = errors->ate_median_m;
  json["ate_max_m"] = errors->ate_max_m;
  json["heading_rms_deg"] = errors->heading_rms_rad * kDegreesPerRadian;
  json["heading_max_deg"] = errors->heading_max_rad * kDegreesPerRadian;
  json["worst"] = worst_json(errors->worst);
  json["tenths"] = tenths_json(*errors);
  return json;
}

}  // namespace

std::string evaluation_json(const Evaluation& evaluation) {
  Json json;
  json["scans_in_truth"] = evaluation.scans_in_truth;
  json["fixes"] = evaluation.fixes;
  json["fixes_without_truth"] = evaluation.fixes_without_truth;
  json["scans_without_fix"] = evaluation.scans_without_fix;
  json["wrong_fixes"] = evaluation.first_fix ? Json(evaluation.first_fix->wrong_fixes) : Json(nullptr);
  json["wrong_distance_m"] = evaluation.config.wrong_distance_m;
  json["wrong_heading_deg"] = evaluation.config.wrong_heading_rad * kDegreesPerRadian;
  json["time_tolerance_s"] = evaluation.config.time_tolerance_s;
  json["official_alignment"] = "first_fix";
  json["first_fix"] = errors_json(evaluation.first_fix);
  json["least_squares"] = errors_json(evaluation.least_squares);
  return json.dump(2) + "\n";
}

}  // namespace slamsensor::tools
