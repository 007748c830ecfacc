#pragma once

#include "core/mapping/sighting_graph.hpp"
#include "tests/support/forest.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

namespace slamsensor::core {

inline Config graph_config(std::uint32_t poses, std::uint32_t sightings) {
  Config c;
  c.capacities.map_landmarks = 300;
  c.capacities.scan_landmarks = 40;
  c.capacities.path_poses = poses;
  c.capacities.sightings = sightings;
  c.mount = {0.5, -0.2, 0.3};
  return c;
}

/// A graph and all that went into it. With a robust scale without end each sighting weighs 1.
class MirroredGraph {
 public:
  explicit MirroredGraph(const Config& config) : graph(config) { graph->set_robust_scale(1e9); }

  std::uint32_t add_landmark(MapSlot map, const Point2& p) {
    const std::uint32_t slot = graph->add_landmark(map, p, next_scan_, 0);
    EXPECT_NE(slot, SightingGraph::kNone);
    folded_.erase(slot);
    return slot;
  }
  std::uint32_t add_pose(MapSlot map, const Pose2& T_W_B, const std::vector<SightingGraph::Seen>& seen,
                         bool is_anchor = false) {
    for (Kept& kept : kept_) {
      kept.last_T = graph->pose(kept.place).T_W_B;
    }
    GraphPose pose;
    pose.T_W_B = T_W_B;
    pose.scan = next_scan_++;
    pose.map = map;
    pose.is_anchor = is_anchor ? 1 : 0;
    const std::uint32_t place = graph->add_pose(pose, seen);
    note_folded();
    kept_.push_back({place, pose.scan, T_W_B, seen});
    return place;
  }
  void remove_pose(std::uint32_t place) {
    graph->remove_pose(place);
    kept_.erase(
        std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.place == place; }));
  }
  void remove_landmark(std::uint32_t slot) {
    graph->remove_landmark(slot);
    forget_sightings([&](std::uint32_t landmark) { return landmark == slot; });
    folded_.erase(slot);
  }
  void merge(MapSlot from, MapSlot to, const Pose2& T_to_from, const std::vector<Match>& twins) {
    for (auto& [slot, sum] : folded_) {
      if (graph->landmark(slot).map == from) {
        sum.place_sum = sum.weight * (T_to_from * Point2(sum.place_sum / sum.weight));
      }
    }
    graph->merge(from, to, T_to_from, twins);
    for (const Match& twin : twins) {
      for (Kept& kept : kept_) {
        for (SightingGraph::Seen& seen : kept.seen) {
          seen.landmark = seen.landmark == twin.scan ? twin.map : seen.landmark;
        }
      }
      if (folded_.count(twin.scan) == 1) {
        folded_[twin.map].weight += folded_[twin.scan].weight;
        folded_[twin.map].place_sum += folded_[twin.scan].place_sum;
        folded_.erase(twin.scan);
      }
    }
  }

  /// Sum of squared distances of the sightings that are kept from their landmarks.
  double cost() {
    double sum = 0.0;
    visit_sightings([&](std::uint32_t slot, const Point2& p_W) {
      sum += (p_W - graph->positions()[slot]).squaredNorm();
    });
    return sum;
  }

  /// Each landmark stands at the mean of its sightings and of what was folded.
  void expect_means() {
    std::map<std::uint32_t, Sum> sums = folded_;
    visit_sightings([&](std::uint32_t slot, const Point2& p_W) {
      sums[slot].weight += 1.0;
      sums[slot].place_sum += p_W;
    });
    for (const auto& [slot, sum] : sums) {
      ASSERT_TRUE(graph->is_used(slot));
      const GraphLandmark& l = graph->landmark(slot);
      EXPECT_NEAR(l.sum_weight, sum.weight, 1e-4) << slot;
      EXPECT_LT((graph->positions()[slot] - sum.place_sum / sum.weight).norm(), 2e-4) << slot;
      EXPECT_LT((Point2(l.sum_x_m, l.sum_y_m) / l.sum_weight - graph->positions()[slot]).norm(), 1e-9);
      double d2 = 0.0;
      EXPECT_NE(graph->index().nearest_within(l.map, graph->positions()[slot], 0.01, d2),
                LandmarkIndex::kNone);
    }
  }

  [[nodiscard]] std::vector<std::uint32_t> places() const {
    std::vector<std::uint32_t> places;
    for (const Kept& kept : kept_) {
      places.push_back(kept.place);
    }
    return places;
  }

  tests::InArena<SightingGraph> graph;

 private:
  struct Kept {
    std::uint32_t place = 0;
    std::uint32_t scan = 0;
    Pose2 last_T;
    std::vector<SightingGraph::Seen> seen;
  };
  struct Sum {
    double weight = 0.0;
    Point2 place_sum = Point2::Zero();
  };

  template <typename Visit>
  void visit_sightings(Visit&& visit) {
    for (const Kept& kept : kept_) {
      for (const SightingGraph::Seen& seen : kept.seen) {
        visit(seen.landmark, graph->pose(kept.place).T_W_B * graph->body_point(seen.point_L));
      }
    }
  }
  template <typename Is>
  void forget_sightings(Is&& is) {
    for (Kept& kept : kept_) {
      kept.seen.erase(std::remove_if(kept.seen.begin(), kept.seen.end(),
                                     [&](const SightingGraph::Seen& seen) { return is(seen.landmark); }),
                      kept.seen.end());
    }
  }
  void note_folded() {
    std::map<std::uint32_t, bool> is_kept;
    graph->visit_poses([&](std::uint32_t, const GraphPose& pose) { is_kept[pose.scan] = true; });
    for (const Kept& kept : kept_) {
      for (const SightingGraph::Seen& seen : kept.seen) {
        if (is_kept.count(kept.scan) == 0) {
          folded_[seen.landmark].weight += 1.0;
          folded_[seen.landmark].place_sum += kept.last_T * graph->body_point(seen.point_L);
        }
      }
    }
    kept_.erase(std::remove_if(kept_.begin(), kept_.end(),
                               [&](const Kept& kept) { return is_kept.count(kept.scan) == 0; }),
                kept_.end());
  }

  std::vector<Kept> kept_;
  std::map<std::uint32_t, Sum> folded_;  // what was folded into each landmark
  std::uint32_t next_scan_ = 0;
};

}  // namespace slamsensor::core
