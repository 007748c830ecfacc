#include "core/association/rigid_fit.hpp"
#include "tests/bench/peers.hpp"

#include <algorithm>
#include <igraph/igraph.h>
#include <limits>
#include <vector>

namespace slamsensor::bench {
namespace {

/// igraph's own vector, given back when it goes.
class Integers {
 public:
  Integers() { igraph_vector_int_init(&vector_, 0); }
  ~Integers() { igraph_vector_int_destroy(&vector_); }
  Integers(const Integers&) = delete;
  Integers& operator=(const Integers&) = delete;
  igraph_vector_int_t* get() { return &vector_; }

 private:
  igraph_vector_int_t vector_{};
};

/// Two landmarks of the map and how far apart they are.
struct MapPair {
  double length_m;
  std::size_t a;
  std::size_t b;
};

class IgraphPeer : public Peer {
 public:
  explicit IgraphPeer(std::span<const core::Point2> map_W) : map_W_(map_W.begin(), map_W.end()) {
    for (std::size_t a = 0; a < map_W.size(); ++a) {
      for (std::size_t b = a + 1; b < map_W.size(); ++b) {
        pairs_.push_back({(map_W[a] - map_W[b]).norm(), a, b});
      }
    }
    std::sort(pairs_.begin(), pairs_.end(),
              [](const MapPair& one, const MapPair& two) { return one.length_m < two.length_m; });
  }

  std::optional<core::Pose2> locate(std::span<const core::Point2> scan_L) override {
    Integers edges;
    join_consistent(scan_L, edges);
    igraph_t graph;
    igraph_create(&graph, edges.get(), vertex(scan_L.size(), 0), IGRAPH_UNDIRECTED);
    igraph_vector_int_list_t cliques;
    igraph_vector_int_list_init(&cliques, 0);
    igraph_largest_cliques(&graph, &cliques);
    const std::optional<core::Pose2> pose_W = best_fit(cliques, scan_L);
    igraph_vector_int_list_destroy(&cliques);
    igraph_destroy(&graph);
    return pose_W;
  }

 private:
  [[nodiscard]] igraph_integer_t vertex(std::size_t scan, std::size_t map) const {
    return static_cast<igraph_integer_t>(scan * map_W_.size() + map);
  }

  void join_consistent(std::span<const core::Point2> scan_L, Integers& edges) const {
    for (std::size_t i = 0; i < scan_L.size(); ++i) {
      for (std::size_t j = i + 1; j < scan_L.size(); ++j) {
        const double scan_m = (scan_L[i] - scan_L[j]).norm();
        auto pair = std::lower_bound(pairs_.begin(), pairs_.end(), scan_m - kTolerance_m,
                                     [](const MapPair& p, double length_m) { return p.length_m < length_m; });
        for (; pair != pairs_.end() && pair->length_m <= scan_m + kTolerance_m; ++pair) {
          join(vertex(i, pair->a), vertex(j, pair->b), edges);
          join(vertex(i, pair->b), vertex(j, pair->a), edges);
        }
      }
    }
  }

  static void join(igraph_integer_t a, igraph_integer_t b, Integers& edges) {
    igraph_vector_int_push_back(edges.get(), a);
    igraph_vector_int_push_back(edges.get(), b);
  }

  /// A clique may be the mirror image of the truth: the residual tells.
  [[nodiscard]] std::optional<core::Pose2> best_fit(const igraph_vector_int_list_t& cliques,
                                                    std::span<const core::Point2> scan_L) const {
    std::optional<core::Pose2> best;
    double least_m2 = std::numeric_limits<double>::infinity();
    for (igraph_integer_t c = 0; c < igraph_vector_int_list_size(&cliques); ++c) {
      const igraph_vector_int_t* const clique = igraph_vector_int_list_get_ptr(&cliques, c);
      std::vector<core::Match> matches;
      for (igraph_integer_t v = 0; v < igraph_vector_int_size(clique); ++v) {
        const auto pair = static_cast<std::uint32_t>(VECTOR(*clique)[v]);
        const auto n = static_cast<std::uint32_t>(map_W_.size());
        matches.push_back({pair / n, pair % n});
      }
      const std::optional<core::Pose2> pose_W = core::fit_pose(matches, scan_L, map_W_);
      const double residual_m2 = pose_W ? residual(*pose_W, matches, scan_L) : least_m2;
      if (residual_m2 < least_m2) {
        least_m2 = residual_m2;
        best = pose_W;
      }
    }
    return best;
  }

  [[nodiscard]] double residual(const core::Pose2& pose_W, std::span<const core::Match> matches,
                                std::span<const core::Point2> scan_L) const {
    double sum_m2 = 0.0;
    for (const core::Match& match : matches) {
      sum_m2 += (pose_W * scan_L[match.scan] - map_W_[match.map]).squaredNorm();
    }
    return sum_m2;
  }

  std::vector<core::Point2> map_W_;
  std::vector<MapPair> pairs_;  // by length; made once per map, as the product's index is
};

}  // namespace

std::unique_ptr<Peer> make_igraph_peer(std::span<const core::Point2> map_W) {
  return std::make_unique<IgraphPeer>(map_W);
}

}  // namespace slamsensor::bench
