// How a scan that is believed in a map changes it.
#include "core/graph/lattice.hpp"
#include "core/mapping/atlas.hpp"
#include "core/mapping/atlas_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace slamsensor::core {
namespace {

/// A landmark in view, `range_m` away, that the scan shows or does not.
void learn_showing(const Standing& standing, bool is_shown, double range_m, Rates& rates) noexcept {
  if (standing.sightings < 2 ||
      (is_shown && standing.sightings == 2)) {  // until now seen once: it may be nothing
    rates.second_count += 1.0;
    rates.second += is_shown ? 1.0 : 0.0;
    return;
  }
  const std::size_t bin = Rates::range_bin(range_m);
  rates.in_view[bin] += 1.0F;
  rates.shown[bin] += is_shown ? 1.0F : 0.0F;
  if (rates.in_view[bin] > static_cast<float>(kRatesMemory)) {
    rates.in_view[bin] *= 0.5F;
    rates.shown[bin] *= 0.5F;
  }
}

}  // namespace

/// Brings the scan into the map that it is believed in.
void Atlas::extend(const Weighed& w) noexcept {
  const MapSlot map = w.candidate.map;
  MapEntry& entry = maps_[map];
  entry.last_scan = scan_.number;  // from here on it is no map that could make room for others
  learn_from(w);
  std::array<std::uint32_t, 3> parents;
  const std::uint32_t xi = update_matched(w, parents);
  look_for_missing(w);
  const double twin_m = kTwinSigmas * std::max(w.evidence.sigma_m, scale_.start_sigma_m() * 0.5);
  bool is_saturated = true;
  std::uint32_t news = 0;
  seen_.clear();
  std::size_t m = 0;
  for (std::uint32_t i = 0; i < points_B_.size(); ++i) {
    if (m < w.candidate.matches.size() && w.candidate.matches[m].scan == i) {
      const std::uint32_t slot = w.candidate.matches[m++].map;
      if (graph_.is_used(slot)) {
        is_saturated = is_saturated && graph_.standing(slot).sightings > kSaturated;
        SLAMSENSOR_ASSERT(seen_.try_push_back({slot, points_L_[i]}));
      }
      continue;
    }
    const Point2 p_W = w.candidate.pose_W * points_B_[i];
    double d2 = 0.0;
    if (graph_.index().nearest_within(map, p_W, twin_m, d2) != LandmarkIndex::kNone) {
      continue;  // it may be one that is there: neither new nor matched
    }
    make_room(1);
    const std::uint32_t slot = graph_.add_landmark(map, p_W, scan_.number, xi);
    if (slot == SightingGraph::kNone) {
      ++landmarks_evicted_;
      continue;
    }
    graph_.landmark(slot).parents = parents;
    graph_.standing(slot).size = sizes_[i];
    ++entry.landmarks;
    is_saturated = false;
    ++news;
    SLAMSENSOR_ASSERT(seen_.try_push_back({slot, points_L_[i]}));
  }
  learn_structure(static_cast<std::size_t>(&w - weighed_.begin()), news);
  look_around(map, w.candidate.pose_W);
  entry.W += w.candidate.matches.size();
  ++entry.scans;
  entry.last_pose = w.candidate.pose_W;
  if (!is_saturated) {
    refine_with(w, xi);
  }
  ++revision_;
}

/// The scan's pose and sightings enter the graph; what they say moves the poses about it, and others in turn.
void Atlas::refine_with(const Weighed& w, std::uint32_t xi) noexcept {
  const MapSlot map = w.candidate.map;
  MapEntry& entry = maps_[map];
  GraphPose pose;
  pose.T_W_B = w.candidate.pose_W;
  pose.scan = scan_.number;
  pose.xi = xi;
  pose.map = map;
  pose.chain = entry.number;
  pose.group =
      entry.last_place == SightingGraph::kNone ? std::uint16_t{0} : graph_.pose(entry.last_place).group;
  // Two layers that were linked lie far apart as yet: what links them counts until they have come together.
  graph_.set_robust_scale(
      is_linking() ? kLayerApart_m
                   : std::max(config_.association.tolerance_m, 3.0 * rates_.sigma_m(scale_.start_sigma_m())));
  entry.last_place = graph_.add_pose(pose, seen_.span());
  graph_.refit(entry.last_place);
  graph_.refit_around(entry.last_place, kRefitAround);
  graph_.refit_in_turn(kRefitInTurn);
  step_map(w, map);
  entry.last_pose = graph_.pose(entry.last_place).T_W_B;
}

/// Steps of the whole map come after so many scans that each scan pays the same share of them, and at once
/// when a scan closes a loop: when it shows again what was not seen for long.
void Atlas::step_map(const Weighed& w, MapSlot map) noexcept {
  const auto old =
      std::count_if(w.candidate.matches.begin(), w.candidate.matches.end(), [&](const Match& match) {
        return graph_.is_used(match.map) && scan_.number - closed_scan_ > kLoopScans &&
               graph_.landmark(match.map).first_scan + kLoopScans < scan_.number && was_unseen_[match.scan];
      });
  if (old >= 3) {
    closed_scan_ = scan_.number;
    steps_due_ = kStepsAfterLoop;
  }
  ++scans_since_step_;
  const auto share = static_cast<std::uint32_t>(graph_.sightings_kept() / kSightingsPerScan);
  // How far centres lie behind what readings show is learned as soon as possible: until then every scan errs.
  const bool is_offset_open =
      graph_.expected_offset_m() > 0.0 && !graph_.is_offset_found() && maps_[map].scans <= kOffsetOpenScans;
  if (steps_due_ > 0 || is_offset_open || is_linking() || scans_since_step_ >= std::max(kStepScans, share)) {
    steps_due_ -= steps_due_ > 0 ? 1 : 0;
    scans_since_step_ = 0;
    graph_.refine(map, rates_.sigma_m(scale_.start_sigma_m()));
    rates_.offset_m = graph_.is_offset_found() ? graph_.offset_m() : 0.0;
  }
}

/// Algorithm 1: the scan's error is one more than the largest of its triangle; a matched landmark whose error
/// is not smaller takes the scan's.
std::uint32_t Atlas::update_matched(const Weighed& w, std::array<std::uint32_t, 3>& parents) noexcept {
  std::uint32_t xi = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const GraphLandmark& corner = graph_.landmark(w.candidate.triangle[i]);
    parents[i] = corner.id;
    xi = std::max(xi, corner.xi);
  }
  ++xi;
  MapEntry& entry = maps_[w.candidate.map];
  for (const Match& match : w.candidate.matches) {
    GraphLandmark& l = graph_.landmark(match.map);
    Standing& standing = graph_.standing(match.map);
    standing.sightings += standing.sightings < UINT32_MAX / 2 ? 1 : 0;
    standing.chances += standing.chances < UINT32_MAX / 2 ? 1 : 0;
    standing.size.add(sizes_[match.scan]);
    entry.confirmed += standing.sightings == 2 ? 1 : 0;
    l.misses = 0;
    was_unseen_[match.scan] = l.last_scan + kLoopScans < scan_.number;
    l.last_scan = scan_.number;
    if (l.xi >= xi) {
      l.xi = xi;
      l.parents = parents;
    }
  }
  return xi;
}

/// Two scans from one spot say little of what a scan from another spot will show, so only those are learned
/// from that lie apart.
bool Atlas::is_new_spot(const Weighed& w) noexcept {
  const double apart_m = (w.candidate.pose_W.translation() - learned_at_.translation()).norm();
  if (learned_in_ == w.candidate.map && apart_m <= kLearnApart * scan_.reach_m) {
    return false;
  }
  learned_in_ = w.candidate.map;
  learned_at_ = w.candidate.pose_W;
  return true;
}

void Atlas::learn_from(const Weighed& w) noexcept {
  learns_ = is_new_spot(w);
  if (!learns_) {
    return;
  }
  learn_spread(w);
  rates_.clutter += w.evidence.unmatched;
  rates_.clutter_count += w.evidence.explored;
  for (const Point2& p : points_L_) {
    rates_.bearings[Rates::bearing_bin(std::atan2(p.y(), p.x()))] += 1.0F;
  }
  if (rates_.clutter_count > kRatesMemory) {
    rates_.clutter *= 0.5;
    rates_.clutter_count *= 0.5;
  }
}

/// All that a survey teaches, which says what stands where but not how well this sensor measures it. A survey
/// is not equally good everywhere: where it is best must not teach that no other part can be matched.
void Atlas::learn_spread(const Weighed& w) noexcept {
  double scaled2 = 0.0;
  for (const Match& match : w.candidate.matches) {
    const Point2 seen_W = w.candidate.pose_W * points_B_[match.scan];
    scaled2 += (seen_W - graph_.positions()[match.map]).squaredNorm() /
               (1.0 + 1.0 / static_cast<double>(graph_.standing()[match.map].sightings));
  }
  const double axes = std::max(0.0, 2.0 * static_cast<double>(w.candidate.matches.size()) - 3.0);
  const double least_m = is_surveyed_ ? kSurveySharpest * scale_.start_sigma_m() : 0.0;
  rates_.spread_m2 += std::max(scaled2, axes * least_m * least_m);
  rates_.spread_count += axes;
  if (rates_.spread_count > kRatesMemory) {
    rates_.spread_m2 *= 0.5;
    rates_.spread_count *= 0.5;
  }
}

/// How far a scan's sizes are from those of the place that leads by far without them, whether it is believed
/// or not: were it the wrong one, sizes would only seem to say less than they do. A size that is not the
/// landmark's counts no more than kSizeFar sigmas.
void Atlas::learn_sizes() noexcept {
  const auto places_alone = [](const Weighed& w) { return w.evidence.ln_bayes - w.evidence.ln_sizes; };
  const auto* const best =
      std::max_element(weighed_.begin(), weighed_.end(),
                       [&](const Weighed& a, const Weighed& b) { return places_alone(a) < places_alone(b); });
  const bool leads =
      best != weighed_.end() && places_alone(*best) > kSizeDecades * std::numbers::ln10 &&
      std::all_of(weighed_.begin(), weighed_.end(), [&](const Weighed& other) {
        return other.candidate.map != best->candidate.map ||
               !elsewhere(other.candidate.pose_W, best->candidate.pose_W, config_.acceptance) ||
               places_alone(other) < places_alone(*best) - kSizeLead * std::numbers::ln10;
      });
  if (!leads) {
    return;
  }
  constexpr double kSizeFar = 4.0;
  const double far2 = kSizeFar * kSizeFar * rates_.size_variance();
  for (const Match& match : best->candidate.matches) {
    const LandmarkSize& seen = sizes_[match.scan];
    const LandmarkSize& known = graph_.standing()[match.map].size;
    if (seen.is_known() && known.is_known()) {
      const double off = static_cast<double>(seen.ln_diameter - known.ln_diameter);
      rates_.size_square += std::min(far2, off * off / (1.0 + known.variance_share()));
      rates_.size_count += 1.0;
    }
  }
  if (rates_.size_count > kRatesMemory) {
    rates_.size_square *= 0.5;
    rates_.size_count *= 0.5;
  }
}

/// Whether a landmark that was in view again and again is not there, or not worth keeping. What was seen once
/// is held to what confirmed landmarks show; a confirmed one to its own record.
bool Atlas::is_contradicted(const GraphLandmark& landmark, const Standing& standing,
                            double range_m) const noexcept {
  if (standing.sightings < 2) {
    return landmark.misses * std::log1p(-rates_.detection(range_m)) < std::log(kNeverThere);
  }
  const double share = config_.mapping.prune_share > 0.0 ? config_.mapping.prune_share : kSeldom;
  return (standing.chances >= kSeldomChances && standing.sightings < share * standing.chances) ||
         landmark.misses * std::log1p(-chance_to_be_shown(rates_, standing, range_m)) <
             std::log(kContradicted);
}

/// Landmarks in view that the scan does not show lose standing; those that should have been seen again and
/// again go.
void Atlas::look_for_missing(const Weighed& w) noexcept {
  std::array<std::uint32_t, 64> gone{};
  std::size_t gone_count = 0;
  const Pose2 T_L_W = T_L_B_ * w.candidate.pose_W.inverse();
  const bool is_known = !scan_.view->free_m.empty() || scan_.view->field_of_view_rad > 0.0;
  graph_.index().visit_within(
      w.candidate.map, w.candidate.pose_W.translation(), scan_.reach_m + 2.0,
      [&](std::uint32_t slot, double) {
        const Point2 p_L = T_L_W * graph_.positions()[slot];
        const double range_m = p_L.norm();
        const bool is_matched = std::any_of(w.candidate.matches.begin(), w.candidate.matches.end(),
                                            [&](const Match& match) { return match.map == slot; });
        if (!is_matched &&
            (range_m > scan_.reach_m || !scan_.view->shows(p_L, 0.3) ||
             (!is_known && !(rates_.bearings[Rates::bearing_bin(std::atan2(p_L.y(), p_L.x()))] > 0.0F)))) {
          return;
        }
        Standing& standing = graph_.standing(slot);
        if (learns_) {
          learn_showing(standing, is_matched, range_m, rates_);
        }
        if (is_matched) {
          return;
        }
        standing.chances += standing.chances < UINT32_MAX / 2 ? 1 : 0;
        GraphLandmark& l = graph_.landmark(slot);
        l.misses = static_cast<std::uint16_t>(l.misses + (l.misses < UINT16_MAX ? 1 : 0));
        if (is_contradicted(l, standing, range_m) && gone_count < gone.size()) {
          gone[gone_count++] = slot;
        }
      });
  for (std::size_t i = 0; i < gone_count; ++i) {
    if (!graph_.is_used(gone[i])) {
      continue;  // its scan was taken out
    }
    const std::uint32_t bringer = graph_.landmark(gone[i]).brought_by;
    const bool was_seen_once = graph_.standing(gone[i]).sightings == 1;
    count_out(gone[i]);
    if (was_seen_once) {
      graph_.remove_landmark(gone[i]);
    } else {
      graph_.retire_landmark(gone[i]);
    }
    if (bringer != SightingGraph::kNone && was_seen_once) {
      GraphPose& pose = graph_.pose(bringer);
      ++pose.gone;
      if (pose.is_anchor == 0 && pose.count > 0 && pose.gone >= kTakenOutMin &&
          pose.gone >= kTakenOutShare * pose.brought) {
        const SightingGraph::Loss loss = graph_.remove_pose(bringer);
        MapEntry& entry = maps_[w.candidate.map];
        entry.landmarks -= loss.landmarks;
        entry.confirmed -= std::min(entry.confirmed, loss.confirmed);
        ++scans_taken_out_;
      }
    }
  }
}

void Atlas::look_around(MapSlot map, const Pose2& T_W_B) noexcept {
  const double reach_m = std::min(scan_.reach_m, kLookReach_m);
  const Pose2 T_L_W = T_L_B_ * T_W_B.inverse();
  const bool is_known = !scan_.view->free_m.empty() || scan_.view->field_of_view_rad > 0.0;
  const double cell = ExploredGround::kCell_m;
  const auto first = [&](double v) { return (std::floor((v - reach_m) / cell) + 0.5) * cell; };
  for (double y = first(T_W_B.y_m); y <= T_W_B.y_m + reach_m; y += cell) {
    for (double x = first(T_W_B.x_m); x <= T_W_B.x_m + reach_m; x += cell) {
      const Point2 p_L = T_L_W * Point2(x, y);
      const double range_m = p_L.norm();
      if (range_m <= reach_m && scan_.view->shows(p_L, 0.3) &&
          (is_known || rates_.bearings[Rates::bearing_bin(std::atan2(p_L.y(), p_L.x()))] > 0.0F)) {
        ground_.look(map, {x, y}, rates_.detection(range_m));
      }
    }
  }
}

void Atlas::count_out(std::uint32_t slot) noexcept {
  MapEntry& entry = maps_[graph_.landmark(slot).map];
  --entry.landmarks;
  entry.confirmed -= graph_.standing(slot).sightings >= 2 && entry.confirmed > 0 ? 1 : 0;
}

/// A full memory loses the least useful landmarks: those of the least local map first, then the least
/// confirmed of all.
void Atlas::make_room(std::uint32_t wanted) noexcept {
  if (graph_.free_landmarks() >= wanted) {
    return;
  }
  MapSlot least = kNoMap;
  for (MapSlot i = 0; i < kMapsMax; ++i) {
    if (maps_[i].number != 0 && i != home_ && maps_[i].last_scan != scan_.number &&
        (least == kNoMap || maps_[i].confirmed < maps_[least].confirmed)) {
      least = i;
    }
  }
  if (least != kNoMap) {
    landmarks_evicted_ += maps_[least].landmarks;
    drop_map(least);
    return;
  }
  for (std::uint32_t dropped = 0; dropped < wanted; ++dropped) {
    const std::uint32_t worst = least_useful_in_turn();
    if (worst == SightingGraph::kNone) {
      return;
    }
    count_out(worst);
    graph_.remove_landmark(worst);
    ++landmarks_evicted_;
  }
}

/// The least useful landmark of a stretch of them; the next call looks at the next stretch. kNone when the
/// scan shows all that there are.
std::uint32_t Atlas::least_useful_in_turn() noexcept {
  std::uint32_t worst = SightingGraph::kNone;
  double worst_use = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < graph_.slots() && (i < kRoomStretch || worst == SightingGraph::kNone); ++i) {
    const std::uint32_t slot = room_turn_ = room_turn_ + 1 < graph_.slots() ? room_turn_ + 1 : 0;
    if (!graph_.is_used(slot) || graph_.landmark(slot).last_scan == scan_.number) {
      continue;
    }
    const Standing& standing = graph_.standing(slot);
    const double age = static_cast<double>(scan_.number - graph_.landmark(slot).last_scan);
    const double use = static_cast<double>(standing.sightings) / standing.chances - 1e-9 * age +
                       (standing.sightings > 1 ? 1.0 : 0.0);
    if (use < worst_use) {
      worst_use = use;
      worst = slot;
    }
  }
  return worst;
}

}  // namespace slamsensor::core
