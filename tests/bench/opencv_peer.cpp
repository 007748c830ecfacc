#include "tests/bench/peers.hpp"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <vector>

namespace slamsensor::bench {
namespace {

// At 180 landmarks 14 of about 3,400 pairs are right: a sample of two is right once in 60,000 draws, so that
// this many find it with 97 %. The default, 2,000, would have no chance.
constexpr std::size_t kIterations = 200'000;
constexpr double kConfidence = 0.999;
constexpr std::size_t kRefinements = 10;

// The model has a free scale: the scan shrunk to a point on one tree of the map has an inlier per landmark of
// the scan, more than the true pose. Such an answer is no pose of a sensor and counts as none.
constexpr double kScaleError = 0.1;

double scale_of(const cv::Mat& transform) {
  return std::hypot(transform.at<double>(0, 0), transform.at<double>(1, 0));
}

class OpencvPeer : public Peer {
 public:
  explicit OpencvPeer(std::span<const core::Point2> map_W) : map_W_(map_W.begin(), map_W.end()) {
    cv::setNumThreads(1);
  }

  std::optional<core::Pose2> locate(std::span<const core::Point2> scan_L) override {
    std::vector<cv::Point2d> from;
    std::vector<cv::Point2d> to;
    for (const core::Point2& seen : scan_L) {
      for (const core::Point2& mapped : map_W_) {
        from.emplace_back(seen.x(), seen.y());
        to.emplace_back(mapped.x(), mapped.y());
      }
    }
    const cv::Mat transform = cv::estimateAffinePartial2D(from, to, cv::noArray(), cv::RANSAC, kTolerance_m,
                                                          kIterations, kConfidence, kRefinements);
    if (transform.empty() || std::abs(scale_of(transform) - 1.0) > kScaleError) {
      return std::nullopt;
    }
    return core::Pose2{transform.at<double>(0, 2), transform.at<double>(1, 2),
                       std::atan2(transform.at<double>(1, 0), transform.at<double>(0, 0))};
  }

 private:
  std::vector<core::Point2> map_W_;
};

}  // namespace

std::unique_ptr<Peer> make_opencv_peer(std::span<const core::Point2> map_W) {
  return std::make_unique<OpencvPeer>(map_W);
}

}  // namespace slamsensor::bench
