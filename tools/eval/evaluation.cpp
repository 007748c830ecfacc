#include "tools/eval/evaluation.hpp"

#include "tools/output/text_output.hpp"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace slamsensor::tools {
namespace {

using Points = Eigen::Matrix2Xd;

// Positions this close to their mean, root mean square, say nothing about the rotation.
constexpr double kOnePlace_m = 1e-6;

Points positions(std::span<const PosePair> pairs, core::Pose2 PosePair::*side) {
  Points points(2, static_cast<Eigen::Index>(pairs.size()));
  Eigen::Index column = 0;
  for (const PosePair& pair : pairs) points.col(column++) = (pair.*side).translation();
  return points;
}

double spread_m(const Points& points) {
  const core::Point2 mean = points.rowwise().mean();
  return std::sqrt((points.colwise() - mean).squaredNorm() / static_cast<double>(points.cols()));
}

double mean_heading_difference_rad(std::span<const PosePair> pairs) {
  double sine = 0.0;
  double cosine = 0.0;
  for (const PosePair& pair : pairs) {
    const double difference_rad = pair.truth.heading_rad - pair.estimate.heading_rad;
    sine += std::sin(difference_rad);
    cosine += std::cos(difference_rad);
  }
  return std::atan2(sine, cosine);
}

// The rotation about the origin is given; the translation that is left takes one mean onto the other.
core::Pose2 through_means(double rotation_rad, const Points& truth, const Points& estimate) {
  const core::Point2 truth_mean = truth.rowwise().mean();
  const core::Point2 turned = core::Pose2{0.0, 0.0, rotation_rad} * core::Point2(estimate.rowwise().mean());
  return {truth_mean.x() - turned.x(), truth_mean.y() - turned.y(), core::wrap_angle(rotation_rad)};
}

}  // namespace

core::Pose2 align_first(std::span<const PosePair> pairs) {
  return pairs.front().truth * pairs.front().estimate.inverse();
}

core::Pose2 align_least_squares(std::span<const PosePair> pairs) {
  const Points truth = positions(pairs, &PosePair::truth);
  const Points estimate = positions(pairs, &PosePair::estimate);
  if (spread_m(truth) < kOnePlace_m || spread_m(estimate) < kOnePlace_m) {
    return through_means(mean_heading_difference_rad(pairs), truth, estimate);
  }
  const Eigen::Matrix3d motion = Eigen::umeyama(estimate, truth, false);
  return through_means(std::atan2(motion(1, 0), motion(0, 0)), truth, estimate);
}

namespace {

using Check = tl::expected<void, EvaluationError>;

struct MatchedFix {
  double t = 0.0;
  std::size_t truth_index = 0;
};

struct Matches {
  std::vector<MatchedFix> fixes;
  std::vector<PosePair> pairs;  // one per fix
};

bool is_finite(const TimedPose& timed) {
  return std::isfinite(timed.t) && std::isfinite(timed.pose.x_m) && std::isfinite(timed.pose.y_m) &&
         std::isfinite(timed.pose.heading_rad);
}

std::vector<TimedPose> sorted_by_time(std::span<const TimedPose> poses) {
  std::vector<TimedPose> sorted(poses.begin(), poses.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.t < b.t; });
  return sorted;
}

Check check_poses(std::span<const TimedPose> poses, std::string_view name) {
  if (!std::all_of(poses.begin(), poses.end(), is_finite)) {
    return tl::unexpected(
        EvaluationError{"the " + std::string(name) +
                        " holds a value that is not a finite number; correct or remove its line"});
  }
  const std::vector<TimedPose> sorted = sorted_by_time(poses);
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end(),
                                        [](const TimedPose& a, const TimedPose& b) { return a.t == b.t; });
  if (twice == sorted.end()) return {};
  std::string message = "the " + std::string(name) + " holds two poses with the time ";
  append_shortest(message, twice->t);
  return tl::unexpected(EvaluationError{message + "; keep one of them"});
}

Check check_config(const EvaluationConfig& config) {
  for (const double limit : {config.wrong_distance_m, config.wrong_heading_rad, config.time_tolerance_s}) {
    if (!(limit >= 0.0)) {
      return tl::unexpected(
          EvaluationError{"the limits of a wrong fix and the time tolerance must be 0 or more"});
    }
  }
  return {};
}

std::optional<std::size_t> nearest(const std::vector<TimedPose>& truth, double t, double tolerance_s) {
  const auto after = std::lower_bound(truth.begin(), truth.end(), t,
                                      [](const TimedPose& pose, double time) { return pose.t < time; });
  auto best = after;
  if (after == truth.end() || (after != truth.begin() && t - std::prev(after)->t < after->t - t)) {
    if (after == truth.begin()) return std::nullopt;
    best = std::prev(after);
  }
  // Decimal times are rounded: 1.02 - 1.0 is more than 0.02.
  const double rounding_s =
      2.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(best->t), std::abs(t));
  if (std::abs(best->t - t) > tolerance_s + rounding_s) return std::nullopt;
  return static_cast<std::size_t>(best - truth.begin());
}

Matches match(const std::vector<TimedPose>& truth, std::span<const TimedPose> trajectory,
              double tolerance_s) {
  Matches matches;
  for (const TimedPose& fix : trajectory) {
    const auto index = nearest(truth, fix.t, tolerance_s);
    if (!index) continue;
    matches.fixes.push_back({fix.t, *index});
    matches.pairs.push_back({truth[*index].pose, fix.pose});
  }
  return matches;
}

std::size_t distinct_truths(const Matches& matches) {
  std::vector<std::size_t> indices;
  for (const MatchedFix& fix : matches.fixes) indices.push_back(fix.truth_index);
  std::sort(indices.begin(), indices.end());
  return static_cast<std::size_t>(std::unique(indices.begin(), indices.end()) - indices.begin());
}

FixError error_of(const MatchedFix& fix, const PosePair& pair, const core::Pose2& T_truth_map,
                  const EvaluationConfig& config) {
  const core::Pose2 placed = T_truth_map * pair.estimate;
  FixError error;
  error.t = fix.t;
  error.truth_index = fix.truth_index;
  error.distance_m = (placed.translation() - pair.truth.translation()).norm();
  error.heading_rad = core::wrap_angle(placed.heading_rad - pair.truth.heading_rad);
  error.is_wrong =
      error.distance_m > config.wrong_distance_m || std::abs(error.heading_rad) > config.wrong_heading_rad;
  return error;
}

double median_m(const std::vector<FixError>& errors) {
  std::vector<double> distances;
  for (const FixError& error : errors) distances.push_back(error.distance_m);
  std::sort(distances.begin(), distances.end());
  const std::size_t middle = distances.size() / 2;
  if (distances.size() % 2 == 1) return distances[middle];
  return 0.5 * (distances[middle - 1] + distances[middle]);
}

void fill_tenths(AlignedErrors& result, std::size_t scans_in_truth) {
  for (const FixError& error : result.fixes) {
    TenthError& tenth = result.tenths[error.truth_index * result.tenths.size() / scans_in_truth];
    ++tenth.fixes;
    tenth.rms_m += error.distance_m * error.distance_m;
    tenth.max_m = std::max(tenth.max_m, error.distance_m);
  }
  for (TenthError& tenth : result.tenths) {
    if (tenth.fixes > 0) tenth.rms_m = std::sqrt(tenth.rms_m / static_cast<double>(tenth.fixes));
  }
}

void fill_totals(AlignedErrors& result) {
  double squares_m2 = 0.0;
  double squares_rad2 = 0.0;
  result.worst = result.fixes.front();
  for (const FixError& error : result.fixes) {
    squares_m2 += error.distance_m * error.distance_m;
    squares_rad2 += error.heading_rad * error.heading_rad;
    result.heading_max_rad = std::max(result.heading_max_rad, std::abs(error.heading_rad));
    result.wrong_fixes += error.is_wrong ? 1U : 0U;
    if (error.distance_m > result.worst.distance_m) result.worst = error;
  }
  const auto count = static_cast<double>(result.fixes.size());
  result.ate_rms_m = std::sqrt(squares_m2 / count);
  result.heading_rms_rad = std::sqrt(squares_rad2 / count);
  result.ate_max_m = result.worst.distance_m;
  result.ate_median_m = median_m(result.fixes);
}

AlignedErrors errors_under(const core::Pose2& T_truth_map, const Matches& matches, std::size_t scans_in_truth,
                           const EvaluationConfig& config) {
  AlignedErrors result;
  result.T_truth_map = T_truth_map;
  for (std::size_t i = 0; i < matches.fixes.size(); ++i) {
    result.fixes.push_back(error_of(matches.fixes[i], matches.pairs[i], T_truth_map, config));
  }
  fill_totals(result);
  fill_tenths(result, scans_in_truth);
  return result;
}

}  // namespace

bool has_nothing_in_common(const Evaluation& evaluation) {
  return evaluation.fixes > 0 && evaluation.fixes_without_truth == evaluation.fixes;
}

tl::expected<Evaluation, EvaluationError> evaluate(std::span<const TimedPose> truth,
                                                   std::span<const TimedPose> trajectory,
                                                   const EvaluationConfig& config) {
  for (const Check& check :
       {check_config(config), check_poses(truth, "truth"), check_poses(trajectory, "trajectory")}) {
    if (!check) return tl::unexpected(check.error());
  }
  const Matches matches = match(sorted_by_time(truth), trajectory, config.time_tolerance_s);
  Evaluation result;
  result.config = config;
  result.scans_in_truth = truth.size();
  result.fixes = trajectory.size();
  result.fixes_without_truth = trajectory.size() - matches.fixes.size();
  result.scans_without_fix = truth.size() - distinct_truths(matches);
  if (matches.pairs.empty()) return result;
  result.first_fix = errors_under(align_first(matches.pairs), matches, truth.size(), config);
  result.least_squares = errors_under(align_least_squares(matches.pairs), matches, truth.size(), config);
  return result;
}

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

namespace {

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

std::string left_in(const std::string& text, std::size_t width) {
  return text.size() < width ? text + std::string(width - text.size(), ' ') : text;
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
