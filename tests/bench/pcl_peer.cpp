#include "tests/bench/peers.hpp"

#include <cmath>
#include <cstdlib>
#include <optional>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/ia_kfpcs.h>

namespace slamsensor::bench {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

// Lengths agree within 1.414 delta: 1.3 sigma of the noise of a length (0.15 m at both ends). 0.3 m is no
// better, 0.15 m worse.
constexpr float kDelta_m = 0.2F;
// Bases tried. A base of four true landmarks comes up once in about five, of which not all are convex.
constexpr int kBases = 60;
// Decides how far apart a base's points may be: at 0.3 nearly as far as the scan's landmarks are, and not
// closer than 3 m.
constexpr float kOverlap = 0.3F;
// Of so many triangles the largest becomes the base. PCL's default, 1,000, always takes the largest of all:
// the same few bases again and again.
constexpr int kDrawsPerBase = 10;

/// Draws the same bases in every run, where PCL seeds with the time of day.
class SeededKfpcs : public pcl::registration::KFPCSInitialAlignment<pcl::PointXYZ, pcl::PointXYZ> {
 public:
  /// The best transform that stays in the plane, of all that were found; those that turn it over are mirror
  /// images, which points without height cannot tell from rotations.
  [[nodiscard]] std::optional<Eigen::Matrix4f> best_upright() const {
    for (const auto& candidate : candidates_) {  // best first
      if (candidate.fitness_score < 1.0F && candidate.transformation(2, 2) > 0.0F) {
        return candidate.transformation;
      }
    }
    return std::nullopt;
  }

 protected:
  bool initCompute() override {
    const bool ready = KFPCSInitialAlignment::initCompute();
    std::srand(1);
    indices_validation_ = indices_;  // scored on the whole map, however few draws make a base
    return ready;
  }
};

Cloud::Ptr flat_cloud(std::span<const core::Point2> points) {
  Cloud::Ptr cloud(new Cloud);
  for (const core::Point2& p : points) {
    cloud->push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0F});
  }
  return cloud;
}

/// Draws its bases from the target and looks for them in the source. So the scan is the target: most of its
/// points are in the map, while few bases drawn from the map lie within the scan.
class PclPeer : public Peer {
 public:
  PclPeer(std::span<const core::Point2> map_W, float delta_m) : map_(flat_cloud(map_W)), delta_m_(delta_m) {}

  std::optional<core::Pose2> locate(std::span<const core::Point2> scan_L) override {
    SeededKfpcs method;
    method.setInputSource(map_);
    method.setInputTarget(flat_cloud(scan_L));
    method.setDelta(delta_m_);
    method.setApproxOverlap(kOverlap);
    method.setMaximumIterations(kBases);
    method.setScoreThreshold(0.0F);  // no early end: the best of all bases
    method.setRANSACIterations(kDrawsPerBase);
    Cloud aligned;
    method.align(aligned);
    const std::optional<Eigen::Matrix4f> best = method.best_upright();
    if (!best) {
      return std::nullopt;  // no base was found in the map
    }
    const Eigen::Matrix4f& T_L_W = *best;
    return core::Pose2{static_cast<double>(T_L_W(0, 3)), static_cast<double>(T_L_W(1, 3)),
                       static_cast<double>(std::atan2(T_L_W(1, 0), T_L_W(0, 0)))}
        .inverse();
  }

 private:
  Cloud::Ptr map_;
  float delta_m_;
};

}  // namespace

std::unique_ptr<Peer> make_pcl_peer(std::span<const core::Point2> map_W) {
  return make_pcl_peer_within(map_W, kDelta_m);
}

std::unique_ptr<Peer> make_pcl_peer_within(std::span<const core::Point2> map_W, float delta_m) {
  return std::make_unique<PclPeer>(map_W, delta_m);
}

}  // namespace slamsensor::bench
