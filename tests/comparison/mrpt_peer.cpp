// What users of odometry take from MRPT, on a drive: mrpt_peer ekf-jcbb|ekf-nn|icp|particles DRIVE MAP OUT
// SIGMA_M SIGMA_RAD REACH_M LIKELIHOOD_M
//
// DRIVE: lines "S scan dx dy dphi" (a scan, and what odometry says of the way to it, in the frame of the scan
// before) and "L x y" (a landmark of that scan, in the sensor's frame). MAP: the true landmarks, for
// `particles` alone. OUT: a line "scan,x_m,y_m,heading_rad,milliseconds" per scan, from the first scan as
// origin. The sigmas are the noise of the sensor in range and bearing, REACH_M how far EKF SLAM expects
// landmarks; LIKELIHOOD_M is the spread about the true landmarks that the particle filter allows for.
//
// Settings: MRPT's defaults and the values of its own examples where not said otherwise beside them.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationBearingRange.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/random/RandomGenerators.h>
#include <mrpt/slam/CICP.h>
#include <mrpt/slam/CMonteCarloLocalization2D.h>
#include <mrpt/slam/CRangeBearingKFSLAM2D.h>
#include <sstream>
#include <string>
#include <vector>

namespace {

using mrpt::maps::CSimplePointsMap;
using mrpt::poses::CPose2D;

/// Of the sensor that the drive was made with.
struct Noise {
  double range_m = 0.1;
  double bearing_rad = 0.005;
  double reach_m = 100.0;
};
constexpr unsigned kSeed = 5;

struct Point {
  double x, y;
};
struct Scan {
  int number = 0;
  CPose2D odometry;
  std::vector<Point> landmarks;
};

std::vector<Scan> read_drive(const std::string& path) {
  std::ifstream file(path);
  std::vector<Scan> scans;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    char kind = 0;
    double a = 0, b = 0, c = 0;
    words >> kind;
    if (kind == 'S') {
      Scan scan;
      words >> scan.number >> a >> b >> c;
      scan.odometry = CPose2D(a, b, c);
      scans.push_back(scan);
    } else if (words >> a >> b) {
      scans.back().landmarks.push_back({a, b});
    }
  }
  return scans;
}

std::vector<Point> read_map(const std::string& path) {
  std::ifstream file(path);
  std::vector<Point> points;
  Point p{};
  while (file >> p.x >> p.y) {
    points.push_back(p);
  }
  return points;
}

mrpt::obs::CActionCollection::Ptr action_of(const CPose2D& odometry) {
  mrpt::obs::CActionRobotMovement2D movement;
  movement.computeFromOdometry(odometry, mrpt::obs::CActionRobotMovement2D::TMotionModelOptions());
  auto actions = mrpt::obs::CActionCollection::Create();
  actions->insert(movement);
  return actions;
}

CSimplePointsMap points_map(const std::vector<Point>& points) {
  CSimplePointsMap map;
  for (const Point& p : points) {
    map.insertPoint(static_cast<float>(p.x), static_cast<float>(p.y), 0.0F);
  }
  return map;
}

class Peer {
 public:
  virtual ~Peer() = default;
  virtual CPose2D process(const Scan& scan) = 0;
};

/// CRangeBearingKFSLAM2D with its default data association, the nearest neighbour, or with joint
/// compatibility: its best, whose time grows exponentially with the landmarks of a scan.
class Ekf : public Peer {
 public:
  Ekf(const Noise& noise, mrpt::slam::TDataAssociationMethod association) : noise_(noise) {
    filter_.options.std_sensor_range = static_cast<float>(noise.range_m);
    filter_.options.std_sensor_yaw = static_cast<float>(noise.bearing_rad);
    filter_.options.data_assoc_method = association;
    filter_.setMinLoggingLevel(mrpt::system::LVL_ERROR);
  }

  CPose2D process(const Scan& scan) override {
    auto seen = mrpt::obs::CObservationBearingRange::Create();
    for (const Point& p : scan.landmarks) {
      mrpt::obs::CObservationBearingRange::TMeasurement one;
      one.range = static_cast<float>(std::hypot(p.x, p.y));
      one.yaw = static_cast<float>(std::atan2(p.y, p.x));
      one.pitch = 0.0F;
      one.landmarkID = mrpt::obs::INVALID_LANDMARK_ID;
      seen->sensedData.push_back(one);
    }
    seen->sensor_std_range = static_cast<float>(noise_.range_m);
    seen->sensor_std_yaw = static_cast<float>(noise_.bearing_rad);
    seen->fieldOfView_yaw = 2.0 * M_PI;
    seen->minSensorDistance = 0.5F;
    seen->maxSensorDistance = static_cast<float>(noise_.reach_m);
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(seen);
    auto actions = action_of(scan.odometry);
    filter_.processActionObservation(actions, frame);
    mrpt::poses::CPosePDFGaussian pose;
    filter_.getCurrentRobotPose(pose);
    return pose.mean;
  }

 private:
  Noise noise_;
  mrpt::slam::CRangeBearingKFSLAM2D filter_;
};

/// CICP of each scan's landmarks against all before, begun where odometry says.
class Icp : public Peer {
 public:
  Icp() {
    icp_.options.maxIterations = 80;
    icp_.options.thresholdDist = 2.0;  // landmarks are metres apart: the 0.75 m of dense scans finds nothing
    icp_.options.smallestThresholdDist = 0.3;
    icp_.options.ALFA = 0.8;
    icp_.options.corresponding_points_decimation = 1;  // each of some twenty points counts
  }

  CPose2D process(const Scan& scan) override {
    const CSimplePointsMap seen = points_map(scan.landmarks);
    pose_ = pose_ + scan.odometry;
    if (map_.size() > 0 && seen.size() >= 3) {
      mrpt::slam::CICP::TReturnInfo info;
      const auto found = icp_.Align(&map_, &seen, pose_, info);
      if (found && info.goodness > 0.4) {  // CMetricMapBuilderICP's own default
        pose_ = found->getMeanVal();
      }
    }
    for (const Point& p : scan.landmarks) {
      double x = 0, y = 0;
      pose_.composePoint(p.x, p.y, x, y);
      float distance = 1e9F, cx = 0, cy = 0;
      if (map_.size() > 0) {
        map_.kdTreeClosestPoint2D(static_cast<float>(x), static_cast<float>(y), cx, cy, distance);
      }
      if (distance > 0.5F * 0.5F) {
        map_.insertPoint(static_cast<float>(x), static_cast<float>(y), 0.0F);
      }
    }
    return pose_;
  }

 private:
  mrpt::slam::CICP icp_;
  CSimplePointsMap map_;
  CPose2D pose_;
};

/// CMonteCarloLocalization2D, given the true map, which neither of the others has.
class Particles : public Peer {
 public:
  Particles(const std::vector<Point>& map, double likelihood_m) : map_(points_map(map)), filter_(2000) {
    mrpt::random::getRandomGenerator().randomize(kSeed);
    map_.likelihoodOptions.sigma_dist = static_cast<float>(likelihood_m);
    map_.likelihoodOptions.max_corr_distance = 1.0;
    map_.likelihoodOptions.decimation = 1;
    filter_.options.metricMap = std::shared_ptr<mrpt::maps::CMetricMap>(&map_, [](auto*) {});
    filter_.resetDeterministic(mrpt::math::TPose2D(), 2000);
    options_.PF_algorithm = mrpt::bayes::CParticleFilter::pfStandardProposal;
    options_.resamplingMethod = mrpt::bayes::CParticleFilter::prSystematic;
    options_.BETA = 0.5;
    particles_.m_options = options_;
    particles_.setMinLoggingLevel(mrpt::system::LVL_ERROR);
  }

  CPose2D process(const Scan& scan) override {
    auto seen = mrpt::obs::CObservationPointCloud::Create();
    auto cloud = CSimplePointsMap::Create();
    *cloud = points_map(scan.landmarks);
    seen->pointcloud = cloud;
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(seen);
    auto actions = action_of(scan.odometry);
    particles_.executeOn(filter_, actions.get(), frame.get());
    CPose2D mean;
    filter_.getMean(mean);
    return mean;
  }

 private:
  CSimplePointsMap map_;
  mrpt::slam::CMonteCarloLocalization2D filter_;
  mrpt::bayes::CParticleFilter::TParticleFilterOptions options_;
  mrpt::bayes::CParticleFilter particles_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 9) {
    std::fprintf(stderr,
                 "usage: mrpt_peer ekf-jcbb|ekf-nn|icp|particles DRIVE MAP OUT SIGMA_M SIGMA_RAD REACH_M "
                 "LIKELIHOOD_M\n");
    return 64;
  }
  const Noise noise{std::strtod(argv[5], nullptr), std::strtod(argv[6], nullptr),
                    std::strtod(argv[7], nullptr)};
  const std::string method = argv[1];
  std::unique_ptr<Peer> peer;
  if (method == "ekf-jcbb") {
    peer = std::make_unique<Ekf>(noise, mrpt::slam::assocJCBB);
  } else if (method == "ekf-nn") {
    peer = std::make_unique<Ekf>(noise, mrpt::slam::assocNN);
  } else if (method == "icp") {
    peer = std::make_unique<Icp>();
  } else if (method == "particles") {
    peer = std::make_unique<Particles>(read_map(argv[3]), std::strtod(argv[8], nullptr));
  } else {
    return 64;
  }
  std::FILE* const out = std::fopen(argv[4], "w");
  if (out == nullptr) {
    return 73;
  }
  std::fprintf(out, "scan,x_m,y_m,heading_rad,milliseconds\n");
  for (const Scan& scan : read_drive(argv[2])) {
    const auto begin = std::chrono::steady_clock::now();
    const CPose2D pose = peer->process(scan);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    std::fprintf(out, "%d,%.6f,%.6f,%.9f,%.4f\n", scan.number, pose.x(), pose.y(), pose.phi(), took.count());
    std::fflush(out);  // what is there when its time is over, counts
  }
  return std::fclose(out) == 0 ? 0 : 73;
}
