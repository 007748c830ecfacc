// Where a local map may lie, and how it becomes part of another map.
#include "core/association/false_alarms.hpp"
#include "core/association/rigid_fit.hpp"
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

/// The scan of a local map that may also lie elsewhere says where the whole local map may lie.
void Atlas::note_places(MapSlot slot, const Pose2& T_map_B) noexcept {
  MapEntry& map = maps_[slot];
  for (const Weighed& other : weighed_) {
    if (other.candidate.map == slot || other.evidence.ln_bayes < std::log(100.0)) {
      continue;
    }
    const Pose2 T = other.candidate.pose_W * T_map_B.inverse();
    auto* place = std::find_if(map.places.begin(), map.places.end(), [&](const PlaceHypothesis& p) {
      return p.target == other.candidate.map && !elsewhere(p.T_target_map, T, config_.acceptance);
    });
    if (place == map.places.end()) {
      if (map.places.size() == std::min<std::size_t>(config_.mapping.hypotheses_max, MapEntry::kPlacesMax)) {
        map.places.truncate(map.places.size() - 1);  // the least W makes room
      }
      SLAMSENSOR_ASSERT(map.places.try_push_back({other.candidate.map, T, 0, 0, 0.0}));
      place = &map.places.back();
    }
    place->W += other.candidate.matches.size();
    if (other.evidence.group_decades >= kPlaceGroups &&
        other.evidence.contradiction_decades() <= kPlaceContradiction) {
      ++place->scans;
      place->decades += other.evidence.ln_bayes / std::numbers::ln10;
    }
  }
  std::sort(map.places.begin(), map.places.end(),
            [](const PlaceHypothesis& a, const PlaceHypothesis& b) { return a.W > b.W; });
}

/// Whether `a` and `b` are one place in two maps: an earlier scan said the same of how the maps lie to each
/// other. Asked only of a map of at most kYoungScans scans and of one that began when the scans left it:
/// later a copy of the place may have come between.
bool Atlas::is_same_place(const Candidate& a, const Candidate& b) const noexcept {
  const auto lies_so = [&](const Candidate& local, const Candidate& other) {
    const auto& places = maps_[local.map].places;
    return maps_[local.map].follows == maps_[other.map].number && maps_[other.map].scans <= kYoungScans &&
           std::any_of(places.begin(), places.end(), [&](const PlaceHypothesis& place) {
             return place.target == other.map &&
                    !elsewhere(place.T_target_map * local.pose_W, other.pose_W, config_.acceptance);
           });
  };
  return lies_so(a, b) || lies_so(b, a);
}

/// Holds the confirmed landmarks of a local map, as a whole, against all other maps.
void Atlas::try_tie(MapSlot map, const Deadline& deadline) noexcept {
  const MapEntry& entry = maps_[map];
  if (map == home_ || is_in_doubt(entry) || tie_by_one_scan(map) || tie_by_scans(map) ||
      entry.confirmed < kTieLandmarksMin) {
    return;
  }
  confirmed_.clear();
  confirmed_slots_.clear();
  confirmed_sizes_.clear();
  const double reach_m = std::max(scan_.reach_m, 30.0);
  graph_.index().visit_within(map, entry.last_pose.translation(), reach_m, [&](std::uint32_t slot, double) {
    const Standing& standing = graph_.standing(slot);
    if (standing.sightings >= 2 && confirmed_.try_push_back(graph_.positions()[slot])) {
      SLAMSENSOR_ASSERT(confirmed_slots_.try_push_back(slot) &&
                        confirmed_sizes_.try_push_back(standing.size));
    }
  });
  if (confirmed_.size() < kTieLandmarksMin) {
    return;
  }
  // About the place where the map was last seen, so that distances from the frame's origin do not matter.
  const Pose2 T_C_map{-entry.last_pose.x_m, -entry.last_pose.y_m, 0.0};
  for (Point2& p : confirmed_) {
    p = T_C_map * p;
  }
  MatchModel model;
  model.sigma_m = rates_.sigma_m(scale_.start_sigma_m());
  model.density_per_m2 = static_cast<double>(confirmed_.size()) / (std::numbers::pi * reach_m * reach_m);
  find(confirmed_.span(), map, model, deadline);
  Witnesses witnesses;
  witnesses.points_B = confirmed_.span();
  witnesses.sizes = confirmed_sizes_.span();
  witnesses.own_map = map;
  witnesses.sensor_reach_m = known_reach_m();
  witnesses.sigma_share = kMeanSigmaShare;
  witnesses.T_own_B = T_C_map.inverse();
  weigh(witnesses, found_[0], weighed_ties_);
  MapSlot target = home_;
  if (target == kNoMap && !weighed_ties_.empty()) {
    target = weighed_ties_[0].candidate.map;
  }
  if (target == kNoMap) {
    return;
  }
  const Stake stake = entry.follows == maps_[target].number ? Stake::Follow : Stake::Tie;
  Verdict verdict = decide(weighed_ties_.span(), target, stake, found_[0].end, rates_.structure_decades,
                           config_.acceptance);
  if (verdict.status != FixStatus::Fix && !weighed_ties_.empty() &&
      weighed_ties_[0].candidate.map != target) {
    verdict = decide(weighed_ties_.span(), weighed_ties_[0].candidate.map, Stake::Tie, found_[0].end,
                     rates_.structure_decades, config_.acceptance);
  }
  if (verdict.status == FixStatus::Fix && found_[0].end != SearchEnd::Deadline) {
    Weighed chosen = weighed_ties_[verdict.chosen];
    chosen.candidate.pose_W = chosen.candidate.pose_W * T_C_map;
    confirm_tie(map, chosen);
  } else {
    maps_[map].tie = PlaceHypothesis{};
  }
}

/// Where the world does not repeat itself, scans that each say alone where their local map lies, and agree,
/// tie it.
bool Atlas::tie_by_scans(MapSlot map) noexcept {
  const MapEntry& entry = maps_[map];
  if (rates_.structure_decades >= kTieStructure || entry.places.empty() ||
      entry.places[0].scans < kTieScans || entry.places[0].decades < kScansTieDecades ||
      (entry.places.size() > 1 && 2 * entry.places[1].W > entry.places[0].W)) {
    return false;
  }
  return tie_at(map, entry.places[0]);
}

/// Where the world does not repeat itself, one scan ties the maps in both of which it is believed as a tie
/// would be: two ends of a loop meet in few scans.
bool Atlas::tie_by_one_scan(MapSlot map) noexcept {
  if (rates_.structure_decades >= kTieStructure ||
      decide_in(map, Stake::Tie, found_[0].end).status != FixStatus::Fix) {
    return false;
  }
  const Pose2& T_map_B = weighed_[best_in(weighed_.span(), map)].candidate.pose_W;
  for (MapSlot other = 0; other < kMapsMax; ++other) {
    if (other == map || maps_[other].number == 0 || is_in_doubt(maps_[other])) {
      continue;
    }
    const Verdict verdict = decide_in(other, Stake::Tie, found_[0].end);
    if (verdict.status == FixStatus::Fix) {
      const Pose2& T_other_B = weighed_[verdict.chosen].candidate.pose_W;
      return tie_at(map, {other, T_other_B * T_map_B.inverse(), 0, 0, 0.0});
    }
  }
  return false;
}

/// `map` becomes part of the map where it lies. False when they have hardly a landmark in common there.
bool Atlas::tie_at(MapSlot map, const PlaceHypothesis& place) noexcept {
  const MapEntry& entry = maps_[map];
  const double sigma_m = rates_.sigma_m(scale_.start_sigma_m());
  Weighed tied;
  tied.candidate.map = place.target;
  tied.candidate.pose_W = place.T_target_map;
  for (int round = 0; round < 2; ++round) {  // what scans say of the place is less precise than the maps
    confirmed_.clear();
    confirmed_slots_.clear();
    tied.candidate.matches.clear();
    graph_.index().visit_within(
        map, entry.last_pose.translation(), 2.0 * std::max(scan_.reach_m, 30.0),
        [&](std::uint32_t slot, double) {
          double d2 = 0.0;
          const Point2 p = tied.candidate.pose_W * graph_.positions()[slot];
          const std::uint32_t twin =
              graph_.index().nearest_within(place.target, p, kTieGateSigmas * sigma_m, d2);
          const bool is_taken = std::any_of(tied.candidate.matches.begin(), tied.candidate.matches.end(),
                                            [&](const Match& match) { return match.map == twin; });
          const auto next = static_cast<std::uint32_t>(confirmed_.size());
          if (twin != LandmarkIndex::kNone && !is_taken &&
              confirmed_.try_push_back(graph_.positions()[slot])) {
            SLAMSENSOR_ASSERT(confirmed_slots_.try_push_back(slot));
            SLAMSENSOR_ASSERT(tied.candidate.matches.try_push_back({next, twin}));
          }
        });
    if (tied.candidate.matches.size() < 3) {
      return false;
    }
    tied.candidate.pose_W = fit_pose_robust(tied.candidate.pose_W, tied.candidate.matches.span(),
                                            confirmed_.span(), graph_.positions(), kTwinGateSigmas * sigma_m);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    tied.candidate.triangle[i] = tied.candidate.matches[i].map;
  }
  tie(map, tied);
  return true;
}

/// A tie binds many scans at once: it is made when several scans in a row agree on it.
void Atlas::confirm_tie(MapSlot map, const Weighed& w) noexcept {
  PlaceHypothesis& last = maps_[map].tie;
  const bool is_same = last.W > 0 && last.target == w.candidate.map &&
                       !elsewhere(last.T_target_map * maps_[map].last_pose,
                                  w.candidate.pose_W * maps_[map].last_pose, config_.acceptance);
  last = {w.candidate.map, w.candidate.pose_W, is_same ? last.W + 1 : 1, 0, 0.0};
  const std::uint64_t wanted = maps_[map].follows == maps_[w.candidate.map].number ? kFollowScans : kTieScans;
  if (last.W >= wanted || rates_.structure_decades < kTieStructure) {
    tie(map, w);
  }
}

/// Pairs of landmarks, of `map` and of the map that it is tied to, that are one: those that the tie matched,
/// and what else stands at one place, as far as there is room.
MatchList Atlas::twins_of(MapSlot map, const Weighed& w) const noexcept {
  MatchList twins;
  for (const Match& match : w.candidate.matches) {
    SLAMSENSOR_ASSERT(twins.try_push_back({confirmed_slots_[match.scan], match.map}));
  }
  const double gate_m = kTwinGateSigmas * rates_.sigma_m(scale_.start_sigma_m());
  const RigidMotion move(w.candidate.pose_W);
  graph_.visit_landmarks(map, [&](std::uint32_t slot) {
    if (!graph_.is_used(slot)) {
      return;  // it stands no more
    }
    double d2 = 0.0;
    const std::uint32_t twin =
        graph_.index().nearest_within(w.candidate.map, move(graph_.positions()[slot]), gate_m, d2);
    if (twin == LandmarkIndex::kNone || twins.size() == kScanLandmarksMax) {
      return;
    }
    const bool is_taken = std::any_of(
        twins.begin(), twins.end(), [&](const Match& pair) { return pair.scan == slot || pair.map == twin; });
    if (!is_taken) {
      SLAMSENSOR_ASSERT(twins.try_push_back({slot, twin}));
    }
  });
  return twins;
}

void Atlas::tie(MapSlot map, const Weighed& w) noexcept {
  const MapSlot to = w.candidate.map;
  std::uint32_t xi = 0;
  std::array<std::uint32_t, 3> parents{};  // of what was the origin
  for (std::size_t i = 0; i < parents.size(); ++i) {
    const GraphLandmark& corner = graph_.landmark(w.candidate.triangle[i]);
    parents[i] = corner.id;
    xi = std::max(xi, corner.xi);
  }
  graph_.visit_landmarks(map, [&](std::uint32_t slot) {
    GraphLandmark& l = graph_.landmark(slot);
    l.parents = l.xi == 0 ? parents : l.parents;
    l.xi += xi + 1;
  });
  const MatchList twins = twins_of(map, w);
  MapEntry& from = maps_[map];
  MapEntry& into = maps_[to];
  into.landmarks += from.landmarks;
  into.confirmed += from.confirmed;
  for (const Match& twin : twins) {
    count_as_one(into, twin.scan, twin.map);
  }
  graph_.visit_poses([&](std::uint32_t place, const GraphPose& pose) {
    if (pose.map == map) {
      graph_.pose(place).xi += xi + 1;
      look_around(to, w.candidate.pose_W * pose.T_W_B);
    }
  });
  graph_.merge(map, to, w.candidate.pose_W, twins.span());
  into.scans += from.scans;
  into.W += from.W;
  if (from.last_scan >= into.last_scan) {
    into.last_scan = from.last_scan;
    into.last_pose = w.candidate.pose_W * from.last_pose;
    into.last_place = from.last_place;
  }
  drop_map(map);
  ++revision_;
}

/// Places within `apart_m` of the answer that are expected to match as well as `others` at `pose_W` do, by
/// chance. A place is tried for each two pairs of landmarks, of the scan and of the map, that lie and turn
/// so.
double Atlas::log10_layers_by_chance(MapSlot map, const Pose2& pose_W, std::span<const Match> others,
                                     double apart_m) const noexcept {
  const double gate_m = kTieGateSigmas * rates_.sigma_m(scale_.start_sigma_m());
  FixedVector<double, kScanLandmarksMax> shares;
  const RigidMotion move(pose_W);
  for (const Match& match : others) {
    const double d2 = (move(points_B_[match.scan]) - graph_.positions()[match.map]).squaredNorm();
    SLAMSENSOR_ASSERT(shares.try_push_back(std::min(1.0, d2 / (gate_m * gate_m))));
  }
  std::sort(shares.begin(), shares.end());
  double about = 0.0;  // landmarks of the map
  graph_.index().visit_within(map, pose_W.translation(), scan_.reach_m,
                              [&](std::uint32_t, double) { about += 1.0; });
  const double per_m2 = about / (scan_.reach_m * scan_.reach_m);  // times pi
  const double pairs = static_cast<double>(points_B_.size()) * per_m2 * apart_m * apart_m;
  const double places = std::max(1.0, 0.5 * pairs * pairs * kLayerTurn_rad / std::numbers::pi);
  return std::log10(places) + log10_chance_of_matches(static_cast<std::uint32_t>(points_B_.size()),
                                                      shares.span(), std::min(1.0, per_m2 * gate_m * gate_m));
}

/// Whether `other` explains the scan by another layer of the map than `answer` does: the same ground, mapped
/// twice with drift between. Each layer contradicts the other, so that the matches and their sizes alone
/// count. What tells layers from a lattice or a row: hardly any scan ever showed several landmarks of both,
/// though both would have been in view.
bool Atlas::is_layer(const Weighed& answer, const Weighed& other) noexcept {
  const Pose2& a = answer.candidate.pose_W;
  const Pose2& b = other.candidate.pose_W;
  const double apart_m = std::min(kLayerApart_m, 0.5 * scan_.reach_m);
  if (other.candidate.map != answer.candidate.map || (a.translation() - b.translation()).norm() > apart_m ||
      std::abs(wrap_angle(a.heading_rad - b.heading_rad)) > kLayerTurn_rad) {
    return false;
  }
  FixedVector<std::uint32_t, kScanLandmarksMax> some;
  FixedVector<std::uint32_t, kScanLandmarksMax> others;
  MatchList matches;  // of the others
  for (const Match& match : answer.candidate.matches) {
    SLAMSENSOR_ASSERT(some.try_push_back(match.map));
  }
  for (const Match& match : other.candidate.matches) {
    if (std::find(some.begin(), some.end(), match.map) == some.end()) {
      SLAMSENSOR_ASSERT(others.try_push_back(match.map) && matches.try_push_back(match));
    }
  }
  if (4 * others.size() < 3 * other.candidate.matches.size() ||
      log10_layers_by_chance(other.candidate.map, b, matches.span(), apart_m) -
              other.evidence.ln_sizes / std::numbers::ln10 >
          -kNearDecades) {
    return false;
  }
  std::uint32_t shown = 0;  // by the scans that showed the fewer
  for (const std::uint32_t slot : others) {
    shown = std::max(shown, graph_.standing(slot).sightings);
  }
  // Scans that are not kept any more, as those of a map from a file, may have shown both: then nothing is
  // known of it.
  const auto is_all_kept = [&](std::uint32_t slot) { return !(graph_.landmark(slot).prior_weight > 0.0F); };
  if (!std::all_of(some.begin(), some.end(), is_all_kept) &&
      !std::all_of(others.begin(), others.end(), is_all_kept)) {
    return false;
  }
  return graph_.scans_of_both(some.span(), others.span(), kLayerShared) * kLayerScans <= shown;
}

/// A scan that stands in two layers of a map closes the loop between them. True when it did, and what was
/// found in the maps is to be found again.
bool Atlas::close_loop(MapSlot map) noexcept {
  const std::size_t best = best_in(weighed_.span(), map);
  if (best == SIZE_MAX || weighed_[best].evidence.ln_bayes < kLayerDecades * std::numbers::ln10) {
    return false;
  }
  const Weighed& answer = weighed_[best];
  const auto other = std::find_if(weighed_.begin(), weighed_.end(),
                                  [&](const Weighed& w) { return &w != &answer && is_layer(answer, w); });
  if (other == weighed_.end()) {
    return false;
  }
  link_layers(answer.candidate, other->candidate);
  return true;
}

/// The scan, as a pose that shows landmarks of both layers, pulls them together.
void Atlas::link_layers(const Candidate& answer, const Candidate& other) noexcept {
  seen_.clear();
  for (const Match& match : answer.matches) {
    SLAMSENSOR_ASSERT(seen_.try_push_back({match.map, points_L_[match.scan]}));
  }
  for (const Match& match : other.matches) {
    const auto* const same = std::find_if(answer.matches.begin(), answer.matches.end(),
                                          [&](const Match& m) { return m.scan == match.scan; });
    const bool is_taken = std::any_of(seen_.begin(), seen_.end(), [&](const SightingGraph::Seen& seen) {
      return seen.landmark == match.map;
    });
    if (is_taken) {
      continue;
    }
    if (same == answer.matches.end()) {
      if (!seen_.try_push_back({match.map, points_L_[match.scan]})) {
        break;
      }
    } else if (graph_.may_be_one(same->map, match.map)) {
      seen_[static_cast<std::size_t>(same - answer.matches.begin())].landmark = unite(same->map, match.map);
    }
  }
  GraphPose pose;
  pose.T_W_B = answer.pose_W;
  pose.scan = scan_.number;
  pose.map = answer.map;
  pose.chain = maps_[answer.map].number;
  static_cast<void>(graph_.add_pose(pose, seen_.span(), SightingGraph::Weights::Full));
  graph_.sum_anew();
  linking_scans_ = kLinkingScans;
  for (std::uint32_t i = 0; i < kStepsAfterLoop; ++i) {
    graph_.refine(answer.map, rates_.sigma_m(scale_.start_sigma_m()));
  }
}

/// Before `a` and `b`, which the entry counts both, become one landmark, which both scans have confirmed.
void Atlas::count_as_one(MapEntry& entry, std::uint32_t a, std::uint32_t b) const noexcept {
  const bool is_a_confirmed = graph_.standing()[a].sightings >= 2;
  const bool is_b_confirmed = graph_.standing()[b].sightings >= 2;
  --entry.landmarks;
  entry.confirmed += is_a_confirmed || is_b_confirmed ? 0 : 1;
  entry.confirmed -= is_a_confirmed && is_b_confirmed ? 1 : 0;
}

/// Two landmarks of one map become one: the older. Returns it.
std::uint32_t Atlas::unite(std::uint32_t a, std::uint32_t b) noexcept {
  const std::uint32_t kept = graph_.landmark(a).id < graph_.landmark(b).id ? a : b;
  const std::uint32_t gone = kept == a ? b : a;
  count_as_one(maps_[graph_.landmark(kept).map], gone, kept);
  graph_.unite(gone, kept);
  return kept;
}

/// Landmarks that came to stand at one place, and may be one, become one; some of the maps' landmarks a scan.
void Atlas::unite_twins_in_turn() noexcept {
  const double gate_m = kTwinGateSigmas * rates_.sigma_m(scale_.start_sigma_m());
  for (std::uint32_t i = 0; i < std::min(kTwinsInTurn, graph_.slots()); ++i) {
    twin_turn_ = twin_turn_ + 1 < graph_.slots() ? twin_turn_ + 1 : 0;
    if (!graph_.is_used(twin_turn_)) {
      continue;
    }
    std::uint32_t twin = SightingGraph::kNone;
    graph_.index().visit_within(graph_.landmark(twin_turn_).map, graph_.positions()[twin_turn_], gate_m,
                                [&](std::uint32_t slot, double) {
                                  if (slot != twin_turn_ && graph_.may_be_one(slot, twin_turn_)) {
                                    twin = slot;
                                  }
                                });
    if (twin != SightingGraph::kNone) {
      static_cast<void>(unite(twin_turn_, twin));
    }
  }
}

}  // namespace slamsensor::core
