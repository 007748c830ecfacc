#include "tools/eval/evaluation.hpp"

#include "tools/eval/alignment.hpp"
#include "tools/output/number_text.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::tools {
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
  if (std::abs(best->t - t) > tolerance_s) return std::nullopt;
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

}  // namespace slamsensor::tools
