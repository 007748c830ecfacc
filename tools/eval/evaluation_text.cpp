#include "tools/eval/evaluation_report.hpp"
#include "tools/output/number_text.hpp"

#include <algorithm>
#include <string_view>

namespace slamsensor::tools {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr std::size_t kLabelWidth = 24;
constexpr std::size_t kColumnWidth = 14;

std::string number(double value, int decimals) {
  return fixed_text(value, decimals);
}

std::string time_text(double t) {
  std::string text;
  append_shortest(text, t);
  return text;
}

std::string left_in(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text;
}

std::string right_in(const std::string& text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string line(const std::string& label, const std::string& value) {
  return left_in(label, kLabelWidth) + value + "\n";
}

std::string columns(const std::string& label, const std::string& official, const std::string& other) {
  return left_in(label, kLabelWidth) + right_in(official, kColumnWidth) + right_in(other, kColumnWidth + 2) +
         "\n";
}

std::string counts(const Evaluation& evaluation) {
  std::string text = line("scans in truth", std::to_string(evaluation.scans_in_truth));
  text += line("fixes", std::to_string(evaluation.fixes));
  text += line("fixes without truth", std::to_string(evaluation.fixes_without_truth));
  text += line("scans without fix", std::to_string(evaluation.scans_without_fix));
  return text;
}

std::string metres(const std::string& label, double official_m, double other_m) {
  return columns(label, number(official_m, 3), number(other_m, 3));
}

std::string degrees(const std::string& label, double official_rad, double other_rad) {
  return columns(label, number(official_rad * kDegreesPerRadian, 3),
                 number(other_rad * kDegreesPerRadian, 3));
}

std::string totals(const Evaluation& evaluation) {
  const AlignedErrors& official = *evaluation.first_fix;
  const AlignedErrors& other = *evaluation.least_squares;
  std::string text = columns("aligned by", "first fix", "least squares");
  text += columns("", "(official)", "");
  text += columns("wrong fixes", std::to_string(official.wrong_fixes), std::to_string(other.wrong_fixes));
  text += metres("ATE rms (m)", official.ate_rms_m, other.ate_rms_m);
  text += metres("ATE median (m)", official.ate_median_m, other.ate_median_m);
  text += metres("ATE max (m)", official.ate_max_m, other.ate_max_m);
  text += degrees("heading rms (deg)", official.heading_rms_rad, other.heading_rms_rad);
  text += degrees("heading max (deg)", official.heading_max_rad, other.heading_max_rad);
  text += columns("worst fix at t", time_text(official.worst.t), time_text(other.worst.t));
  text += metres("  its distance (m)", official.worst.distance_m, other.worst.distance_m);
  text += degrees("  its heading (deg)", official.worst.heading_rad, other.worst.heading_rad);
  return text;
}

std::string tenth_line(std::size_t index, const TenthError& official, const TenthError& other) {
  const std::string label = "tenth " + right_in(std::to_string(index + 1), 2) + ", " +
                            std::to_string(official.fixes) + (official.fixes == 1 ? " fix" : " fixes");
  if (official.fixes == 0) return columns(label, "-", "-");
  return metres(label, official.rms_m, other.rms_m);
}

std::string tenths(const Evaluation& evaluation) {
  std::string text = "ATE rms (m) in tenths of the run\n";
  for (std::size_t i = 0; i < evaluation.first_fix->tenths.size(); ++i) {
    text += tenth_line(i, evaluation.first_fix->tenths[i], evaluation.least_squares->tenths[i]);
  }
  return text;
}

std::string wrong_rule(const EvaluationConfig& config) {
  std::string text = "A fix is wrong when it is more than ";
  append_shortest(text, config.wrong_distance_m);
  text += " m or ";
  append_general(text, config.wrong_heading_rad * kDegreesPerRadian, 6);
  return text + " deg from the truth. The first fix defines the map frame.\n";
}

}  // namespace

std::string evaluation_text(const Evaluation& evaluation) {
  std::string text = counts(evaluation);
  if (has_nothing_in_common(evaluation)) {
    text += "No fix has a time of the truth within ";
    append_shortest(text, evaluation.config.time_tolerance_s);
    return text +
           " s: nothing to compare. Check that both files count time alike, or allow more with "
           "--time-tolerance.\n";
  }
  if (!evaluation.first_fix) {
    return text + "There is no fix to compare.\n";
  }
  return text + "\n" + totals(evaluation) + "\n" + tenths(evaluation) + "\n" + wrong_rule(evaluation.config);
}

}  // namespace slamsensor::tools
