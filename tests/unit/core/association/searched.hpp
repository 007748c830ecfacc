#pragma once

#include "core/association/paper_search.hpp"
#include "core/mapping/landmark_map.hpp"
#include "tests/support/in_arena.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace slamsensor::core {

/// A map and a search over it, with the config they share.
class Searched {
 public:
  Searched(const std::vector<Point2>& map_W, const AssociationConfig& config)
      : config_(config),
        capacities_(capacities_for(map_W)),
        map_(capacities_),
        delaunay_(static_cast<std::uint32_t>(map_W.size())),
        search_(config, capacities_) {
    for (const Point2& p : map_W) {
      EXPECT_TRUE(map_->try_add({}, p));
    }
    map_->rebuild_index(*delaunay_, config_);
  }
  const Candidates& search(const std::vector<Point2>& scan_L, std::uint32_t variants_max = 1,
                           const Deadline& deadline = {}) {
    search_->search(scan_L, map_view(), variants_max, deadline, *found_);
    return *found_;
  }
  const Candidates& rest(const Deadline& deadline = {}) {
    search_->search_rest(deadline, *found_);
    return *found_;
  }
  const MapView& map_view() {
    view_.emplace(map_->view());
    return *view_;
  }

 private:
  static Capacities capacities_for(const std::vector<Point2>& map_W) {
    Capacities c;
    c.scan_landmarks = 64;
    c.map_landmarks = static_cast<std::uint32_t>(map_W.size());
    c.map_edges = 14 * c.map_landmarks + 100;
    return c;
  }
  AssociationConfig config_;
  Capacities capacities_;
  tests::InArena<LandmarkMap> map_;
  tests::InArena<Delaunay> delaunay_;
  tests::InArena<PaperSearch> search_;
  std::unique_ptr<Candidates> found_ = std::make_unique<Candidates>();
  std::optional<MapView> view_;
};

}  // namespace slamsensor::core
