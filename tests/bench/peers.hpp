#pragma once

#include "core/geometry/pose2.hpp"

#include <memory>
#include <optional>
#include <span>

namespace slamsensor::bench {

/// Another program's method on the task: where in the map a scan was made.
class Peer {
 public:
  Peer() = default;
  virtual ~Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  /// The pose T_W_L; none when the method gives none. No peer says whether its pose is to be believed.
  [[nodiscard]] virtual std::optional<core::Pose2> locate(std::span<const core::Point2> scan_L) = 0;
};

/// What the task tells every method: lengths and places agree within it, m.
inline constexpr double kTolerance_m = 0.5;

/// The largest clique of the consistency graph, exactly (igraph_largest_cliques): a vertex per pair of scan
/// and map landmark, an edge where two pairs agree in length within the tolerance. Of several largest cliques
/// the one with the least residual.
[[nodiscard]] std::unique_ptr<Peer> make_igraph_peer(std::span<const core::Point2> map_W);

/// PCL's keypoint-based four point congruent sets (KFPCSInitialAlignment), whose lengths agree within 1.414
/// times `delta_m`; without it, as noise of 0.1 m asks for.
[[nodiscard]] std::unique_ptr<Peer> make_pcl_peer(std::span<const core::Point2> map_W);
[[nodiscard]] std::unique_ptr<Peer> make_pcl_peer_within(std::span<const core::Point2> map_W, float delta_m);

/// OpenCV's estimateAffinePartial2D over all pairs of scan and map landmark.
[[nodiscard]] std::unique_ptr<Peer> make_opencv_peer(std::span<const core::Point2> map_W);

}  // namespace slamsensor::bench
