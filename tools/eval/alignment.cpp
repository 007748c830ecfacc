#include "tools/eval/alignment.hpp"

#include <Eigen/Geometry>

#include <cmath>

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

}  // namespace slamsensor::tools
