#include "core/mapping/sighting_graph.hpp"

#include "core/memory/assert.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
namespace {

/// Weight of Geman and McClure's kernel.
double robust_weight(double distance2_m2, double scale_m) noexcept {
  const double r = 1.0 + distance2_m2 / (scale_m * scale_m);
  return 1.0 / (r * r);
}

}  // namespace

SightingGraph::SightingGraph(Arena& arena, const Config& config) noexcept
    : mount_(config.mount),
      T_B_L_{config.mount.x_m, config.mount.y_m, config.mount.heading_rad},
      robust_scale_m_(config.association.tolerance_m),
      index_(arena, config.association, config.capacities),
      landmarks_(arena, "maps: landmarks", config.capacities.map_landmarks),
      positions_(arena, "maps: positions", config.capacities.map_landmarks),
      standing_(arena, "maps: standing", config.capacities.map_landmarks),
      used_(arena, "maps: slots in use", config.capacities.map_landmarks),
      free_(arena, "maps: free slots", config.capacities.map_landmarks),
      poses_(arena, "maps: poses", config.capacities.path_poses),
      sightings_(arena, "maps: sightings",
                 std::max(config.capacities.sightings, config.capacities.scan_landmarks)),
      marks_(arena, "maps: marks of poses", config.capacities.path_poses),
      unknowns_(arena, "maps: equations of poses", config.capacities.path_poses),
      means_(arena, "maps: equations of landmarks", config.capacities.map_landmarks),
      system_(arena, "maps: group equations", std::size_t{kUnknownsMax} * kUnknownsMax) {
  for (MapDrift& drift : drifts_) {
    drift.groups.fill(Eigen::Matrix3d::Zero());
  }
  first_of_map_.fill(kNone);
  SLAMSENSOR_ASSERT(system_.try_resize(system_.capacity()) && poses_.try_resize(poses_.capacity()) &&
                    marks_.try_resize(marks_.capacity()) && unknowns_.try_resize(unknowns_.capacity()) &&
                    means_.try_resize(means_.capacity()) && sightings_.try_resize(sightings_.capacity()));
}

Point2 SightingGraph::body_point(const Point2& point_L) const noexcept {
  const double range_m = point_L.norm();
  return T_B_L_ * (range_m > 0.0 ? Point2(point_L * (1.0 + offset_m_ / range_m)) : point_L);
}

std::uint32_t SightingGraph::add_landmark(MapSlot map, const Point2& position_W, std::uint32_t scan,
                                          std::uint32_t xi) noexcept {
  std::uint32_t slot = static_cast<std::uint32_t>(landmarks_.size());
  if (free_.empty() && slot == landmarks_.capacity() && retired_ > 0) {
    forget_one_retired();
  }
  if (!free_.empty()) {
    slot = free_.back();
    free_.truncate(free_.size() - 1);
  } else if (!landmarks_.try_push_back({}) || !positions_.try_push_back(position_W) ||
             !standing_.try_push_back({}) || !used_.try_push_back(0)) {
    return kNone;
  }
  GraphLandmark landmark;
  landmark.id = next_id_++;
  landmark.xi = xi;
  landmark.first_scan = landmark.last_scan = scan;
  landmarks_[slot] = landmark;
  put_into_map(slot, map);
  positions_[slot] = position_W;
  standing_[slot] = Standing{};
  used_[slot] = kStands;
  index_.insert(slot, map, position_W);
  return slot;
}

void SightingGraph::set_prior(std::uint32_t slot, double weight) noexcept {
  GraphLandmark& l = landmarks_[slot];
  l.prior_x_m = static_cast<float>(positions_[slot].x());
  l.prior_y_m = static_cast<float>(positions_[slot].y());
  l.prior_weight = static_cast<float>(weight);
  l.sum_weight = weight;
  l.sum_x_m = weight * positions_[slot].x();
  l.sum_y_m = weight * positions_[slot].y();
}

void SightingGraph::remove_landmark(std::uint32_t slot) noexcept {
  SLAMSENSOR_ASSERT(used_[slot] != kFree);
  for (std::uint32_t s = landmarks_[slot].sightings; s != kNone;) {
    const std::uint32_t next = sightings_[s].next;
    sightings_[s].landmark = kNone;
    sightings_[s].next = kNone;
    s = next;
  }
  if (used_[slot] == kStands) {
    index_.erase(slot);
  } else {
    --retired_;
  }
  used_[slot] = kFree;
  take_out_of_map(slot);
  SLAMSENSOR_ASSERT(free_.try_push_back(slot));
}

void SightingGraph::retire_landmark(std::uint32_t slot) noexcept {
  SLAMSENSOR_ASSERT(used_[slot] == kStands);
  index_.erase(slot);
  used_[slot] = kRetired;
  ++retired_;
}

/// Another one each time, whichever comes first.
void SightingGraph::forget_one_retired() noexcept {
  do {
    retired_turn_ = retired_turn_ + 1 < landmarks_.size() ? retired_turn_ + 1 : 0;
  } while (used_[retired_turn_] != kRetired);
  remove_landmark(retired_turn_);
}

void SightingGraph::put_into_map(std::uint32_t slot, MapSlot map) noexcept {
  GraphLandmark& l = landmarks_[slot];
  l.map = map;
  l.previous = kNone;
  l.next = first_of_map_[map];
  if (l.next != kNone) {
    landmarks_[l.next].previous = slot;
  }
  first_of_map_[map] = slot;
}

void SightingGraph::take_out_of_map(std::uint32_t slot) noexcept {
  const GraphLandmark& l = landmarks_[slot];
  (l.previous == kNone ? first_of_map_[l.map] : landmarks_[l.previous].next) = l.next;
  if (l.next != kNone) {
    landmarks_[l.next].previous = l.previous;
  }
}

void SightingGraph::chain(std::uint32_t sighting) noexcept {
  GraphLandmark& l = landmarks_[sightings_[sighting].landmark];
  sightings_[sighting].next = l.sightings;
  l.sightings = sighting;
}

void SightingGraph::unchain(std::uint32_t sighting) noexcept {
  std::uint32_t* link = &landmarks_[sightings_[sighting].landmark].sightings;
  while (*link != sighting) {
    link = &sightings_[*link].next;
  }
  *link = sightings_[sighting].next;
  sightings_[sighting].next = kNone;
}

void SightingGraph::add_to_sum(const GraphSighting& s, const Point2& at_W, double sign) noexcept {
  GraphLandmark& l = landmarks_[s.landmark];
  const double weight = sign * static_cast<double>(s.weight);
  l.sum_x_m += weight * at_W.x();
  l.sum_y_m += weight * at_W.y();
  l.sum_weight += weight;
}

void SightingGraph::place(std::uint32_t slot) noexcept {
  const GraphLandmark& l = landmarks_[slot];
  if (l.sum_weight > 1e-6) {
    positions_[slot] = Point2(l.sum_x_m, l.sum_y_m) / l.sum_weight;
    if (used_[slot] == kStands) {
      index_.move(slot, positions_[slot]);
    }
  }
}

std::uint32_t SightingGraph::add_pose(const GraphPose& pose, std::span<const Seen> seen,
                                      Weights weights) noexcept {
  while (pose_head_ - pose_tail_ >= poses_.capacity() ||
         (pose_head_ > pose_tail_ && sighting_head_ - sighting_tail_ + seen.size() > sightings_.capacity())) {
    fold_oldest();
  }
  const auto place_of = static_cast<std::uint32_t>(pose_head_++ % poses_.capacity());
  GraphPose& added = poses_[place_of];
  added = pose;
  added.first = static_cast<std::uint32_t>(sighting_head_ % sightings_.capacity());
  added.count = static_cast<std::uint32_t>(seen.size());
  const Carrier carry(*this, pose.T_W_B);
  for (const Seen& s : seen) {
    const auto at = static_cast<std::uint32_t>(sighting_head_++ % sightings_.capacity());
    const Point2 q = pose.T_W_B * body_point(s.point_L);
    GraphLandmark& l = landmarks_[s.landmark];
    const double d2 =
        weights == Weights::Robust && l.sum_weight > 0.0 ? (q - positions_[s.landmark]).squaredNorm() : 0.0;
    sightings_[at] = {static_cast<float>(s.point_L.x()),
                      static_cast<float>(s.point_L.y()),
                      static_cast<float>(robust_weight(d2, robust_scale_m_)),
                      s.landmark,
                      place_of,
                      kNone};
    chain(at);
    add_to_sum(sightings_[at], carry(sightings_[at]), 1.0);
    if (l.brought_by == kNone && l.first_scan == pose.scan) {
      l.brought_by = place_of;
      ++added.brought;
    }
    place(s.landmark);
  }
  return place_of;
}

/// The sightings of the oldest pose become part of the priors of their landmarks.
void SightingGraph::fold_oldest() noexcept {
  SLAMSENSOR_ASSERT(pose_tail_ < pose_head_);
  GraphPose& pose = poses_[static_cast<std::size_t>(pose_tail_ % poses_.capacity())];
  const Carrier carry(*this, pose.T_W_B);
  for (std::uint32_t i = 0; i < pose.count; ++i) {
    const auto at = static_cast<std::uint32_t>((pose.first + i) % sightings_.capacity());
    GraphSighting& s = sightings_[at];
    if (s.landmark == kNone) {
      continue;
    }
    GraphLandmark& l = landmarks_[s.landmark];
    const Point2 q = carry(s);
    const auto old = static_cast<double>(l.prior_weight);
    const double weight = old + static_cast<double>(s.weight);
    l.prior_x_m = static_cast<float>(
        (old * static_cast<double>(l.prior_x_m) + static_cast<double>(s.weight) * q.x()) / weight);
    l.prior_y_m = static_cast<float>(
        (old * static_cast<double>(l.prior_y_m) + static_cast<double>(s.weight) * q.y()) / weight);
    l.prior_weight = static_cast<float>(weight);
    l.brought_by = l.brought_by == s.pose ? kNone : l.brought_by;
    const std::uint32_t slot = s.landmark;
    unchain(at);
    s.landmark = kNone;
    if (used_[slot] == kRetired && l.sightings == kNone) {
      remove_landmark(slot);
    }
  }
  // Sightings are kept in the order of their poses: those up to the next pose go with this one.
  pose.count = 0;
  ++pose_tail_;
  sighting_tail_ = sighting_head_;
  for (std::uint64_t p = pose_tail_; p < pose_head_; ++p) {
    const GraphPose& next = poses_[static_cast<std::size_t>(p % poses_.capacity())];
    if (next.count > 0) {
      const std::uint64_t newest = sighting_head_ % sightings_.capacity();
      const std::uint64_t back = (newest + sightings_.capacity() - next.first) % sightings_.capacity();
      sighting_tail_ = sighting_head_ - (back == 0 ? sightings_.capacity() : back);
      break;
    }
    ++pose_tail_;
  }
  turn_ = std::max(turn_, pose_tail_);
  ++folded_;
}

SightingGraph::Loss SightingGraph::remove_pose(std::uint32_t place_of) noexcept {
  GraphPose& pose = poses_[place_of];
  const Carrier carry(*this, pose.T_W_B);
  Loss loss;
  for (std::uint32_t i = 0; i < pose.count; ++i) {
    const auto at = static_cast<std::uint32_t>((pose.first + i) % sightings_.capacity());
    GraphSighting& s = sightings_[at];
    if (s.landmark == kNone) {
      continue;
    }
    const std::uint32_t slot = s.landmark;
    add_to_sum(s, carry(s), -1.0);
    unchain(at);
    s.landmark = kNone;
    Standing& standing = standing_[slot];
    const bool was_confirmed = standing.sightings >= 2;
    standing.sightings -= standing.sightings > 1 ? 1 : 0;
    const bool goes = landmarks_[slot].sightings == kNone && !(landmarks_[slot].prior_weight > 0.0F);
    if (used_[slot] == kStands) {
      loss.landmarks += goes ? 1 : 0;
      loss.confirmed += was_confirmed && (goes || standing.sightings < 2) ? 1 : 0;
    }
    if (goes) {
      remove_landmark(slot);
    } else {
      landmarks_[slot].brought_by =
          landmarks_[slot].brought_by == place_of ? kNone : landmarks_[slot].brought_by;
      place(slot);
    }
  }
  pose.count = 0;
  return loss;
}

void SightingGraph::refit(std::uint32_t place_of) noexcept {
  GraphPose& pose = poses_[place_of];
  if (pose.count == 0) {
    return;
  }
  // Against the mean of what the others say of each landmark, which counts as much as there are others.
  Point2 mean_B = Point2::Zero();
  Point2 mean_W = Point2::Zero();
  double total = 0.0;
  std::uint32_t held = 0;                          // sightings that hold the pose
  std::array<Point2, kScanLandmarksMax> points_B;  // NOLINT: what is read is written before
  std::array<Point2, kScanLandmarksMax> rest_W;    // NOLINT
  std::array<double, kScanLandmarksMax> weights;   // NOLINT
  const std::uint32_t count = std::min(pose.count, kScanLandmarksMax);
  const Carrier carry(*this, pose.T_W_B);
  const RigidMotion now(pose.T_W_B);
  for (std::uint32_t i = 0; i < count; ++i) {
    GraphSighting& s = sightings_[(pose.first + i) % sightings_.capacity()];
    weights[i] = 0.0;
    if (s.landmark == kNone) {
      continue;
    }
    const GraphLandmark& l = landmarks_[s.landmark];
    points_B[i] = carry.body_point(s);
    const Point2 q = now(points_B[i]);
    const double rest = l.sum_weight - static_cast<double>(s.weight);
    if (rest < 1e-3) {
      continue;  // nobody else saw it
    }
    rest_W[i] = (Point2(l.sum_x_m, l.sum_y_m) - static_cast<double>(s.weight) * q) / rest;
    const double weight = robust_weight((q - rest_W[i]).squaredNorm(), robust_scale_m_);
    weights[i] = weight * rest / (rest + weight);
    mean_B += weights[i] * points_B[i];
    mean_W += weights[i] * rest_W[i];
    total += weights[i];
    held += weights[i] > kHolds ? 1 : 0;
  }
  Pose2 moved = pose.T_W_B;
  if (held >= kHeldMin && pose.is_anchor == 0) {
    mean_B /= total;
    mean_W /= total;
    double dot = 0.0;
    double turned = 0.0;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (weights[i] > 0.0) {
        const Point2 b = points_B[i] - mean_B;
        const Point2 w = rest_W[i] - mean_W;
        dot += weights[i] * b.dot(w);
        turned += weights[i] * (b.x() * w.y() - b.y() * w.x());
      }
    }
    if (dot != 0.0 || turned != 0.0) {
      moved = RigidMotion::from_direction(mean_B, mean_W, dot, turned).pose();
    }
  }
  move_pose(pose, moved, std::span(points_B).first(count), std::span(rest_W).first(count),
            std::span(weights).first(count));
}

/// The pose and its sightings at another place; the robust weights follow, against what the others say.
void SightingGraph::move_pose(GraphPose& pose, const Pose2& moved, std::span<const Point2> points_B,
                              std::span<const Point2> rest_W, std::span<const double> weights) noexcept {
  const RigidMotion before(pose.T_W_B);
  const RigidMotion after(moved);
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    GraphSighting& s = sightings_[(pose.first + i) % sightings_.capacity()];
    if (s.landmark == kNone) {
      continue;
    }
    add_to_sum(s, before(points_B[i]), -1.0);
    const Point2 q = after(points_B[i]);
    if (weights[i] > 0.0) {
      s.weight = static_cast<float>(robust_weight((q - rest_W[i]).squaredNorm(), robust_scale_m_));
    }
    add_to_sum(s, q, 1.0);
    place(s.landmark);
  }
  pose.T_W_B = moved;
}

void SightingGraph::refit_around(std::uint32_t place_of, std::uint32_t count) noexcept {
  std::array<std::uint32_t, 64> around{};
  std::uint32_t found = 0;
  const GraphPose& pose = poses_[place_of];
  for (std::uint32_t i = 0; i < pose.count && found < std::min<std::uint32_t>(count, around.size()); ++i) {
    const GraphSighting& own = sightings_[(pose.first + i) % sightings_.capacity()];
    if (own.landmark == kNone) {
      continue;
    }
    std::uint32_t steps = 0;
    for (std::uint32_t s = landmarks_[own.landmark].sightings; s != kNone && steps < 8;
         s = sightings_[s].next, ++steps) {
      const std::uint32_t other = sightings_[s].pose;
      const auto* const end = around.begin() + found;
      if (other != place_of && found < around.size() &&
          std::find(around.begin(), around.begin() + found, other) == end) {
        around[found++] = other;
      }
    }
  }
  for (std::uint32_t i = 0; i < found; ++i) {
    refit(around[i]);
  }
  refit(place_of);
}

void SightingGraph::refit_in_turn(std::uint32_t sightings) noexcept {
  std::uint32_t done = 0;
  const std::uint64_t poses = pose_head_ - pose_tail_;
  for (std::uint64_t tries = 0; tries < poses && done < sightings; ++tries) {
    turn_ = turn_ + 1 >= pose_head_ || turn_ < pose_tail_ ? pose_tail_ : turn_ + 1;
    const auto place_of = static_cast<std::uint32_t>(turn_ % poses_.capacity());
    done += poses_[place_of].count + 1;
    refit(place_of);
  }
}

void SightingGraph::merge(MapSlot from, MapSlot to, const Pose2& T_to_from,
                          std::span<const Match> twins) noexcept {
  const RigidMotion move(T_to_from);
  visit_landmarks(from, [&](std::uint32_t slot) {
    GraphLandmark& l = landmarks_[slot];
    positions_[slot] = move(positions_[slot]);
    const Point2 prior = move(Point2(static_cast<double>(l.prior_x_m), static_cast<double>(l.prior_y_m)));
    l.prior_x_m = static_cast<float>(prior.x());
    l.prior_y_m = static_cast<float>(prior.y());
    if (l.sum_weight > 0.0) {
      const Point2 mean = move(Point2(Point2(l.sum_x_m, l.sum_y_m) / l.sum_weight));
      l.sum_x_m = l.sum_weight * mean.x();
      l.sum_y_m = l.sum_weight * mean.y();
    }
    take_out_of_map(slot);
    put_into_map(slot, to);
    if (used_[slot] == kStands) {
      index_.erase(slot);
      index_.insert(slot, to, positions_[slot]);
    }
  });
  for (std::uint64_t p = pose_tail_; p < pose_head_; ++p) {
    GraphPose& pose = poses_[static_cast<std::size_t>(p % poses_.capacity())];
    if (pose.map == from) {
      pose.map = to;
      pose.is_anchor = 0;
      pose.T_W_B = T_to_from * pose.T_W_B;
    }
  }
  for (const Match& twin : twins) {
    unite(twin.scan, twin.map);
  }
}

void SightingGraph::unite(std::uint32_t gone_slot, std::uint32_t kept_slot) noexcept {
  GraphLandmark& gone = landmarks_[gone_slot];
  GraphLandmark& kept = landmarks_[kept_slot];
  while (gone.sightings != kNone) {
    const std::uint32_t s = gone.sightings;
    unchain(s);
    sightings_[s].landmark = kept_slot;
    chain(s);
  }
  const auto a = static_cast<double>(kept.prior_weight);
  const auto b = static_cast<double>(gone.prior_weight);
  if (b > 0.0) {
    kept.prior_x_m = static_cast<float>(
        (a * static_cast<double>(kept.prior_x_m) + b * static_cast<double>(gone.prior_x_m)) / (a + b));
    kept.prior_y_m = static_cast<float>(
        (a * static_cast<double>(kept.prior_y_m) + b * static_cast<double>(gone.prior_y_m)) / (a + b));
    kept.prior_weight = static_cast<float>(a + b);
  }
  kept.sum_x_m += gone.sum_x_m;
  kept.sum_y_m += gone.sum_y_m;
  kept.sum_weight += gone.sum_weight;
  kept.first_scan = std::min(kept.first_scan, gone.first_scan);
  kept.last_scan = std::max(kept.last_scan, gone.last_scan);
  kept.misses = std::min(kept.misses, gone.misses);
  standing_[kept_slot].sightings += standing_[gone_slot].sightings;
  standing_[kept_slot].chances += standing_[gone_slot].chances;
  standing_[kept_slot].size.add(standing_[gone_slot].size);
  remove_landmark(gone_slot);
  place(kept_slot);
}

bool SightingGraph::may_be_one(std::uint32_t a, std::uint32_t b) noexcept {
  if (landmarks_[a].map != landmarks_[b].map ||
      (landmarks_[a].prior_weight > 0.0F && landmarks_[b].prior_weight > 0.0F)) {
    return false;
  }
  return scans_of_both(std::span(&a, 1), std::span(&b, 1), 1) == 0;
}

std::size_t SightingGraph::scans_of_both(std::span<const std::uint32_t> some,
                                         std::span<const std::uint32_t> others,
                                         std::uint32_t least) noexcept {
  // A scan's mark counts: up to `enough` what it showed of `some`, then up to `both` what of `others`.
  const std::uint32_t none = mark_;
  const std::uint32_t enough = none + least;
  const std::uint32_t both = enough + least;
  mark_ = both;
  for (const std::uint32_t slot : some) {
    for (std::uint32_t s = landmarks_[slot].sightings; s != kNone; s = sightings_[s].next) {
      std::uint32_t& mark = marks_[sightings_[s].pose];
      mark = std::min(std::max(mark, none) + 1, enough);
    }
  }
  std::size_t count = 0;
  for (const std::uint32_t slot : others) {
    for (std::uint32_t s = landmarks_[slot].sightings; s != kNone; s = sightings_[s].next) {
      std::uint32_t& mark = marks_[sightings_[s].pose];
      const bool is_counted = mark >= enough && mark < both;
      mark += is_counted ? 1 : 0;
      count += is_counted && mark == both ? 1 : 0;
    }
  }
  return count;
}

void SightingGraph::sum_anew() noexcept {
  for (std::uint32_t slot = 0; slot < landmarks_.size(); ++slot) {
    GraphLandmark& l = landmarks_[slot];
    l.sum_weight = static_cast<double>(l.prior_weight);
    l.sum_x_m = l.sum_weight * static_cast<double>(l.prior_x_m);
    l.sum_y_m = l.sum_weight * static_cast<double>(l.prior_y_m);
  }
  visit_poses([&](std::uint32_t, const GraphPose& pose) {
    const Carrier carry(*this, pose.T_W_B);
    for (std::uint32_t i = 0; i < pose.count; ++i) {
      const GraphSighting& s = sightings_[(pose.first + i) % sightings_.capacity()];
      if (s.landmark != kNone) {
        add_to_sum(s, carry(s), 1.0);
      }
    }
  });
  for (std::uint32_t slot = 0; slot < landmarks_.size(); ++slot) {
    if (used_[slot] != kFree) {
      place(slot);
    }
  }
}

void SightingGraph::expect_offset(double offset_m) noexcept {
  expected_offset_m_ = offset_m_ = offset_m;
  sum_anew();
}

void SightingGraph::know_offset(double offset_m) noexcept {
  expect_offset(offset_m);
  is_offset_found_ = true;
}

void SightingGraph::forget(MapSlot map) noexcept {
  visit_landmarks(map, [&](std::uint32_t slot) { remove_landmark(slot); });
  for (std::uint64_t p = pose_tail_; p < pose_head_; ++p) {
    GraphPose& pose = poses_[static_cast<std::size_t>(p % poses_.capacity())];
    pose.count = pose.map == map ? 0 : pose.count;
  }
}

void SightingGraph::clear() noexcept {
  landmarks_.clear();
  positions_.clear();
  standing_.clear();
  used_.clear();
  free_.clear();
  first_of_map_.fill(kNone);
  index_.clear();
  pose_head_ = pose_tail_ = sighting_head_ = sighting_tail_ = turn_ = 0;
  folded_ = 0;
  next_id_ = 0;
  retired_ = retired_turn_ = 0;
  offset_m_ = expected_offset_m_ = 0.0;
  is_offset_found_ = false;
  drifts_[0].map = drifts_[1].map = UINT16_MAX;
}

void SightingGraph::set_home(MapSlot home) noexcept {
  if (drifts_[0].map == home) {
    return;
  }
  std::swap(drifts_[0], drifts_[1]);
  if (drifts_[0].map != home) {
    drifts_[0].map = home;
    drifts_[0].groups.fill(Eigen::Matrix3d::Zero());
  }
}

}  // namespace slamsensor::core
