#include "core/mapping/atlas.hpp"

#include "core/graph/lattice.hpp"
#include "core/mapping/atlas_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace slamsensor::core {

Atlas::Atlas(Arena& arena, const Config& config) noexcept
    : config_(config),
      T_L_B_(Pose2{config.mount.x_m, config.mount.y_m, config.mount.heading_rad}.inverse()),
      graph_(arena, config),
      ground_(arena, config.capacities),
      fast_(arena, config.association, config.capacities),
      slots_(arena, "association: slots of a map",
             config.association.search == SearchMethod::Paper ? config.capacities.map_landmarks : 0),
      scale_(config.association, config.acceptance),
      points_L_(arena, "scan: landmarks as measured", config.capacities.scan_landmarks),
      points_B_(arena, "scan: landmarks", config.capacities.scan_landmarks),
      sizes_(arena, "scan: sizes of landmarks", config.capacities.scan_landmarks),
      seen_(arena, "scan: sightings", config.capacities.scan_landmarks),
      confirmed_(arena, "ties: landmarks", config.capacities.scan_landmarks),
      confirmed_slots_(arena, "ties: landmark slots", config.capacities.scan_landmarks),
      confirmed_sizes_(arena, "ties: sizes of landmarks", config.capacities.scan_landmarks),
      found_(arena, "association: candidates", 1),
      weighed_(arena, "decision: weighed candidates", kCandidatesMax),
      weighed_ties_(arena, "decision: weighed ties", kCandidatesMax),
      path_before_(arena, "map: path before the restart", config.capacities.path_poses) {
  SLAMSENSOR_ASSERT(found_.try_resize(1));
  if (config.association.search == SearchMethod::Paper) {
    by_graph_.emplace(arena, config.association, config.capacities);
  }
}

void Atlas::reset() noexcept {
  graph_.clear();
  ground_.clear();
  sensor_reach_m_ = 0.0;
  rates_ = Rates{};
  learned_in_ = kNoMap;
  maps_ = {};
  home_ = kNoMap;
  is_surveyed_ = has_fixed_ = is_home_replaced_ = false;
  scans_ = 0;
  jumps_ = 0;
  maps_made_ = restored_map_ = 0;
  landmarks_evicted_ = scans_taken_out_ = 0;
  twin_turn_ = room_turn_ = 0;
  closed_scan_ = linking_scans_ = steps_due_ = scans_since_step_ = blind_scans_ = 0;
  was_unseen_ = {};
  path_before_.clear();
  ++revision_;
}

void Atlas::take_landmarks(std::span<const ScanLandmark> landmarks) noexcept {
  points_L_.clear();
  points_B_.clear();
  sizes_.clear();
  scan_.reach_m = 0.0;
  double second_m = 0.0;
  for (const ScanLandmark& landmark : landmarks) {
    if (!on_lattice(landmark.position_L)) {
      ++counters_.landmarks_refused;
    } else if (!points_L_.try_push_back(landmark.position_L)) {
      ++counters_.landmarks_cut;
    } else {
      SLAMSENSOR_ASSERT(points_B_.try_push_back(graph_.body_point(landmark.position_L)) &&
                        sizes_.try_push_back(LandmarkSize::seen(landmark.diameter_m)));
      const double range_m = landmark.position_L.norm();
      second_m = std::max(second_m, std::min(range_m, scan_.reach_m));
      scan_.reach_m = std::max(scan_.reach_m, range_m);
    }
  }
  sensor_reach_m_ = std::max(sensor_reach_m_, second_m);
}

Witnesses Atlas::scan_witnesses() const noexcept {
  Witnesses witnesses;
  witnesses.points_B = points_B_.span();
  witnesses.sizes = sizes_.span();
  witnesses.view = scan_.view;
  witnesses.T_L_B = T_L_B_;
  witnesses.is_surveyed = is_surveyed_;
  witnesses.sensor_reach_m = known_reach_m();
  return witnesses;
}

Fix Atlas::process(std::span<const ScanLandmark> landmarks, const ScanView& view,
                   const Deadline& deadline) noexcept {
  Fix fix;
  fix.scan = scan_.number = scans_++;
  graph_.set_home(home_);
  scan_.view = &view;
  linking_scans_ -= linking_scans_ > 0 ? 1 : 0;
  if (view.shows_faces && graph_.expected_offset_m() == 0.0) {
    graph_.expect_offset(kNearFace_m);
  }
  take_landmarks(landmarks);
  weighed_.clear();
  fix.landmarks_seen = static_cast<std::uint32_t>(points_B_.size());
  if (points_B_.size() < std::max(3U, config_.association.landmarks_min)) {
    fix.reason = FixReason::TooFewLandmarks;
    ++blind_scans_;
  } else {
    search(deadline, Rivals::WhereLikely, fix);
    if (frozen_ == Frozen::No || is_surveyed_) {
      learn_sizes();
    }
    localise(deadline, fix);
    blind_scans_ = 0;
  }
  fix.jumps = jumps_;
  if (home_ != kNoMap) {
    fix.home = maps_[home_].number;
    fix.is_home_replaced = is_home_replaced_;
    fix.landmarks_in_map = maps_[home_].landmarks;
    fix.weight_best = maps_[home_].W;
  }
  return fix;
}

MatchModel Atlas::scan_model() const noexcept {
  MatchModel model;
  model.sigma_m = rates_.sigma_m(scale_.start_sigma_m());
  model.detection = rates_.mean_detection();
  model.is_thorough =
      rates_.structure_decades >= kThoroughStructure || points_B_.size() <= kThoroughLandmarks;
  model.density_per_m2 =
      static_cast<double>(points_B_.size()) / std::max(1.0, std::numbers::pi * scan_.reach_m * scan_.reach_m);
  return model;
}

void Atlas::search(const Deadline& deadline, Rivals rivals, Fix& fix) noexcept {
  MatchModel model = scan_model();
  model.is_thorough = model.is_thorough || rivals == Rivals::All;
  const std::span<const Point2> points_B = points_B_.span();
  find(model.is_thorough ? points_B.first(std::min(points_B.size(), kThoroughMost)) : points_B, kNoMap, model,
       deadline);
  counters_.searches_cut += found_[0].end == SearchEnd::Deadline ? 1 : 0;
  fix.search_end = found_[0].end;
  weigh(scan_witnesses(), found_[0], weighed_);
}

/// Candidates in all maps but `except`, by the configured search.
void Atlas::find(std::span<const Point2> points, MapSlot except, const MatchModel& model,
                 const Deadline& deadline) noexcept {
  Candidates& found = found_[0];
  if (!by_graph_) {
    fast_.search(points, graph_.index(), graph_.positions(), except, model, deadline, found);
    return;
  }
  found.list.clear();
  found.poses_tried = found.neighbours_dropped = 0;
  found.end = SearchEnd::Complete;
  for (MapSlot map = 0; map < kMapsMax; ++map) {
    slots_.clear();
    for (std::uint32_t slot = 0; slot < graph_.slots(); ++slot) {
      if (map != except && graph_.is_used(slot) && graph_.landmark(slot).map == map) {
        SLAMSENSOR_ASSERT(slots_.try_push_back(slot));
      }
    }
    if (slots_.size() >= 3) {
      by_graph_->search(points, map, slots_.span(), graph_.positions(), deadline, found);
    }
  }
  counters_.neighbours_dropped += found.neighbours_dropped;
}

void Atlas::weigh(const Witnesses& witnesses, const Candidates& found,
                  BoundedVector<Weighed>& weighed) noexcept {
  weighed.clear();
  const Maps maps = maps_view();
  for (std::size_t i = 0; i < found.list.size(); ++i) {
    if (i >= kWeighedMin && found.list[i].score < found.list[0].score - kWeighedNats) {
      break;
    }
    SLAMSENSOR_ASSERT(weighed.try_push_back({found.list[i], {}}));
    weighed.back().evidence = scale_.weigh(witnesses, maps, weighed.back().candidate);
  }
}

std::optional<std::size_t> Atlas::best_local() const noexcept {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < weighed_.size(); ++i) {
    if (weighed_[i].candidate.map != home_ &&
        (!best || weighed_[i].evidence.ln_bayes > weighed_[*best].evidence.ln_bayes)) {
      best = i;
    }
  }
  return best;
}

void Atlas::describe(const Weighed& w, Fix& fix) const noexcept {
  fix.map = maps_[w.candidate.map].number;
  fix.pose_W = w.candidate.pose_W;
  fix.matches = static_cast<std::uint32_t>(w.candidate.matches.size());
  fix.covariance_near = w.evidence.covariance;
  std::uint32_t xi = 0;
  for (const std::uint32_t slot : w.candidate.triangle) {
    xi = std::max(xi, graph_.landmark(slot).xi);
  }
  fix.error_xi = xi + 1;
  add_common_errors(w.candidate.map, w.candidate.matches, fix);
}

/// What residuals do not show, because the errors of one scan or of one map have it in common: a bias of each
/// scan; the drift of the map since its origin; and the turn of the whole frame, which only its first scan
/// fixed, and which displaces what is far from the origin.
void Atlas::add_common_errors(MapSlot map, const MatchList& matches, Fix& fix) const noexcept {
  const MapEntry& entry = maps_[map];
  const bool is_open = scan_.view->shows_faces && !graph_.is_offset_found();
  const double bias_m = is_open ? kUnknownOffset_m : kScanBias_m;
  const double bias_rad = is_open ? kUnknownOffset_rad : kScanBias_rad;
  fix.covariance_near(0, 0) += bias_m * bias_m;
  fix.covariance_near(1, 1) += bias_m * bias_m;
  fix.covariance_near(2, 2) += bias_rad * bias_rad;
  fix.covariance = fix.covariance_near;
  // The map about the scan is as good as most of its landmarks: what was known long ago and lies there by
  // chance, or by the first scan that comes back, does not make the pose better.
  FixedVector<Eigen::Matrix3d, kScanLandmarksMax> drifts;
  for (const Match& match : matches) {
    const std::uint32_t pose = graph_.landmark(match.map).brought_by;
    SLAMSENSOR_ASSERT(drifts.try_push_back(
        pose == SightingGraph::kNone ? Eigen::Matrix3d(Eigen::Matrix3d::Zero()) : graph_.drift_of(pose)));
  }
  if (!drifts.empty()) {
    auto* const middle = drifts.begin() + drifts.size() / 2;
    std::nth_element(
        drifts.begin(), middle, drifts.end(),
        [](const Eigen::Matrix3d& one, const Eigen::Matrix3d& other) { return one.trace() < other.trace(); });
    const double sigma_m = rates_.sigma_m(scale_.start_sigma_m());
    fix.covariance += sigma_m * sigma_m * kDriftInflation * *middle;
  }
  const double turn2 = entry.frame_turn2 + kFrameBias_rad * kFrameBias_rad;
  const Point2 arm = fix.pose_W.translation();
  const Eigen::Vector3d lever(-arm.y(), arm.x(), 1.0);
  fix.covariance += turn2 * lever * lever.transpose();
  // A map that bends rather than turns has errors along the way, too.
  fix.covariance(0, 0) += kFrameBias_rad * kFrameBias_rad * arm.squaredNorm();
  fix.covariance(1, 1) += kFrameBias_rad * kFrameBias_rad * arm.squaredNorm();
  fix.protection_radius_m =
      std::sqrt(-2.0 * std::log(config_.acceptance.risk)) * position_sigma_m(fix.covariance);
}

/// Closes the loop that the scan shows. One that goes on in a map, and does not show again what the last ones
/// showed there, may have come to another layer of it, which a search that a clear leader ends does not see.
void Atlas::look_for_layers(const Deadline& deadline, Fix& fix) noexcept {
  if (frozen_ == Frozen::Yes || is_surveyed_ || weighed_.empty()) {
    return;
  }
  const MapSlot map = weighed_[0].candidate.map;
  if (maps_[map].last_scan + 1 + blind_scans_ >= scan_.number && stake_of(map) != Stake::Again) {
    search(deadline, Rivals::All, fix);
  }
  if (close_loop(map)) {
    search(deadline, Rivals::WhereLikely, fix);
  }
}

void Atlas::localise(const Deadline& deadline, Fix& fix) noexcept {
  bool is_held_back = false;  // the map grows, but its first fix has to be better than this one
  Verdict verdict;
  verdict.reason = fix.search_end == SearchEnd::Deadline ? FixReason::Deadline : FixReason::NoOverlap;
  look_for_layers(deadline, fix);
  found_home();
  if (home_ != kNoMap) {
    verdict = decide_in(home_, stake_of(home_), fix.search_end);
  }
  if (verdict.status == FixStatus::Fix && !has_fixed_ && !is_surveyed_ &&
      weighed_[verdict.chosen].evidence.covariance(2, 2) > kFirstTurn_rad * kFirstTurn_rad) {
    is_held_back = true;
  }
  fix.status = verdict.status;
  fix.reason = verdict.reason;
  fix.expected_false_alarms = std::pow(10.0, verdict.log10_expected_wrong);
  const std::optional<std::size_t> local = best_local();
  // A local map that explains the scan far better says that this is its place, wherever that is.
  const bool fits_local_better =
      local && verdict.chosen != SIZE_MAX && weighed_[*local].evidence.ln_bayes > 0.0 &&
      weighed_[verdict.chosen].evidence.ln_bayes <
          home_share(weighed_[*local].candidate.map) * weighed_[*local].evidence.ln_bayes;
  if (verdict.chosen != SIZE_MAX) {
    describe(weighed_[verdict.chosen], fix);
  }
  if (frozen_ == Frozen::Yes) {
    if (is_surveyed_ && verdict.status == FixStatus::Fix && is_new_spot(weighed_[verdict.chosen])) {
      learn_spread(weighed_[verdict.chosen]);
    }
    return;
  }
  MapSlot tie_of = kNoMap;
  if (verdict.status == FixStatus::Fix && !fits_local_better) {
    extend(weighed_[verdict.chosen]);
    tie_of =
        local && weighed_[*local].evidence.ln_bayes > std::log(1e4) ? weighed_[*local].candidate.map : kNoMap;
  } else if (local && decide_in(weighed_[*local].candidate.map, Stake::Local, fix.search_end).status ==
                          FixStatus::Fix) {
    tie_of = keep_locally(weighed_[*local], verdict.status == FixStatus::NoFix || fits_local_better, fix);
  } else if (fix.search_end != SearchEnd::Deadline || graph_.index().size() == 0) {
    learn_structure(best_in(weighed_.span(), weighed_.empty() ? kNoMap : weighed_[0].candidate.map), 0);
    start_map(fix);  // a search that was cut does not say that the place is unknown
  }
  if (is_held_back && fix.status == FixStatus::Fix) {
    fix.status = FixStatus::NoFix;
    fix.reason = FixReason::TooFewLandmarks;
  }
  has_fixed_ = has_fixed_ || fix.status == FixStatus::Fix;
  unite_twins_in_turn();
  if (tie_of != kNoMap) {
    try_tie(tie_of, deadline);
  }
  choose_home();
}

/// The share of the decades of a local map with which the home map is still believed. A doubtful map that
/// grew scan by scan up to this one may be a copy of home, which a single scan of it may look like: where
/// such a map explains the scan better, it is not home.
double Atlas::home_share(MapSlot local) const noexcept {
  const bool goes_on = is_in_doubt(maps_[local]) && maps_[local].scans >= kGrownScans &&
                       maps_[local].last_scan + 1 + blind_scans_ >= scan_.number &&
                       maps_[home_].last_scan + 1 + blind_scans_ < scan_.number;
  return goes_on ? 1.0 : kHomeShare;
}

/// A scan that a local map explains. It is the answer when the home map has none. Returns the map that it was
/// brought into.
MapSlot Atlas::keep_locally(const Weighed& chosen, bool is_answer, Fix& fix) noexcept {
  const MapSlot map = chosen.candidate.map;
  // One that does not follow another there may be at a copy of the place, and begins a map of its own.
  const FixStatus status = decide_in(map, stake_of(map), fix.search_end).status;
  const bool is_sure = status == FixStatus::Fix;
  note_places(map, chosen.candidate.pose_W);
  if (is_sure || stake_of(map) == Stake::Again) {
    maps_[map].is_doubtful = maps_[map].is_doubtful || status == FixStatus::Ambiguous;
    if (is_answer) {
      describe(chosen, fix);
      fix.status = FixStatus::NoFix;
      fix.reason = FixReason::LocalMap;
    }
    extend(chosen);
    return map;
  }
  learn_structure(static_cast<std::size_t>(&chosen - weighed_.begin()), 0);
  start_map(fix);
  return kNoMap;
}

/// The decision on `map`; candidates in other maps are marked that are the same place.
Verdict Atlas::decide_in(MapSlot map, Stake stake, SearchEnd end) noexcept {
  const std::size_t best = best_in(weighed_.span(), map);
  for (Weighed& other : weighed_) {
    other.is_same_place = best != SIZE_MAX && is_same_place(other.candidate, weighed_[best].candidate);
  }
  return decide(weighed_.span(), map, stake, end, rates_.structure_decades, config_.acceptance);
}

/// Whether the scan would be a fix if `map` were the home map.
bool Atlas::is_sure_in(MapSlot map, SearchEnd end) noexcept {
  return decide_in(map, stake_of(map), end).status == FixStatus::Fix;
}

/// The first scan that would be a fix in the local map that it is found in makes that map the home map.
void Atlas::found_home() noexcept {
  const std::optional<std::size_t> best = home_ == kNoMap ? best_local() : std::nullopt;
  if (best && weighed_[*best].candidate.matches.size() >= kHomeConfirmed &&
      !is_in_doubt(maps_[weighed_[*best].candidate.map]) &&
      weighed_[*best].evidence.ln_bayes > std::log(kFoundingOdds / config_.acceptance.risk) &&
      is_sure_in(weighed_[*best].candidate.map, found_[0].end)) {
    home_ = weighed_[*best].candidate.map;
    has_fixed_ = false;
  }
}

/// Whether or not the scan is believed in `chosen`: how well the second best place explains it says how far
/// the world repeats itself.
void Atlas::learn_structure(std::size_t chosen, std::uint32_t news) noexcept {
  if (chosen != SIZE_MAX) {
    rates_.see_runner_up(runner_up_decades(weighed_.span(), chosen, config_.acceptance),
                         std::min(1.0, news / kNewsPerSample));
  }
}

/// What a fix in `map` stakes: less when this scan shows again much of what the scans before showed there. A
/// scan of too few landmarks between them says nothing. One that was not believed breaks the chain, unless
/// the world hardly repeats itself.
Stake Atlas::stake_of(MapSlot map) const noexcept {
  if (is_surveyed_) {
    return Stake::Survey;
  }
  const std::size_t best = best_in(weighed_.span(), map);
  const std::uint32_t back = blind_scans_ + (rates_.structure_decades < kTieStructure ? 2U : 1U);
  if (best == SIZE_MAX || maps_[map].last_scan + back < scan_.number) {
    return Stake::Fix;
  }
  const auto again = std::count_if(
      weighed_[best].candidate.matches.begin(), weighed_[best].candidate.matches.end(),
      [&](const Match& match) { return graph_.landmark(match.map).last_scan + kAgainScans >= scan_.number; });
  const double wanted =
      std::max(static_cast<double>(kAgainMin), kAgainShare * static_cast<double>(points_B_.size()));
  return static_cast<double>(again) >= wanted ? Stake::Again : Stake::Fix;
}

MapSlot Atlas::free_map() noexcept {
  MapSlot least = kNoMap;
  for (MapSlot i = 0; i < kMapsMax; ++i) {
    if (maps_[i].number == 0) {
      return i;
    }
    if (i != home_ &&
        (least == kNoMap || maps_[i].confirmed < maps_[least].confirmed ||
         (maps_[i].confirmed == maps_[least].confirmed && maps_[i].last_scan < maps_[least].last_scan))) {
      least = i;
    }
  }
  drop_map(least);
  return least;
}

void Atlas::drop_map(MapSlot map) noexcept {
  graph_.forget(map);
  ground_.forget(map);
  maps_[map] = MapEntry{};
  for (MapEntry& other : maps_) {
    const auto* const kept = std::remove_if(other.places.begin(), other.places.end(),
                                            [&](const PlaceHypothesis& p) { return p.target == map; });
    other.places.truncate(static_cast<std::size_t>(kept - other.places.begin()));
  }
}

void Atlas::start_map(Fix& fix) noexcept {
  if (points_B_.size() < kMapLandmarksMin) {
    return;
  }
  const MapSlot map = free_map();
  MapEntry& entry = maps_[map];
  entry = MapEntry{};
  entry.number = ++maps_made_;
  entry.scans = 1;
  entry.last_scan = scan_.number;
  if (home_ != kNoMap && maps_[home_].last_scan + blind_scans_ + kAgainScans >= scan_.number) {
    entry.follows = maps_[home_].number;
  }
  for (const Point2& p : points_L_) {
    rates_.bearings[Rates::bearing_bin(std::atan2(p.y(), p.x()))] += 1.0F;
  }
  seen_.clear();
  for (std::size_t i = 0; i < points_B_.size(); ++i) {
    double d2 = 0.0;
    make_room(1);
    if (graph_.index().nearest_within(map, points_B_[i], 0.5 * scale_.start_sigma_m(), d2) !=
        LandmarkIndex::kNone) {
      continue;
    }
    const std::uint32_t slot = graph_.add_landmark(map, points_B_[i], scan_.number, 0);
    if (slot != SightingGraph::kNone) {
      graph_.standing(slot).size = sizes_[i];
      ++entry.landmarks;
      SLAMSENSOR_ASSERT(seen_.try_push_back({slot, points_L_[i]}));
    }
  }
  GraphPose pose;
  pose.scan = scan_.number;
  pose.map = map;
  pose.chain = entry.number;
  pose.is_anchor = 1;
  entry.last_place = graph_.add_pose(pose, seen_.span());
  look_around(map, Pose2{});
  note_places(map, Pose2{});
  ++revision_;
  double square_m2 = 0.0;
  for (const Point2& p : points_B_) {
    square_m2 += p.squaredNorm();
  }
  entry.frame_turn2 = scale_.start_sigma_m() * scale_.start_sigma_m() / std::max(1.0, square_m2);
  if (home_ == kNoMap && points_B_.size() >= kHomeAtOnce) {
    found_home_with(map, fix);
  } else if (fix.status == FixStatus::NoFix && fix.reason == FixReason::NoOverlap) {
    // Known nowhere: its own local map is all that is known of it.
    fix.map = 0;
  }
}

/// The scan that begins `map` is its origin by definition; what it leaves open is the turn of the frame.
void Atlas::found_home_with(MapSlot map, Fix& fix) noexcept {
  home_ = map;
  fix.pose_W = Pose2{};
  fix.matches = fix.error_xi = 0;
  fix.status = FixStatus::Fix;
  fix.reason = FixReason::None;
  fix.search_end = SearchEnd::Complete;
  fix.map = maps_[map].number;
  const double sigma_m = scale_.start_sigma_m();
  fix.covariance_near =
      Eigen::Vector3d(sigma_m * sigma_m / static_cast<double>(points_B_.size()),
                      sigma_m * sigma_m / static_cast<double>(points_B_.size()), maps_[map].frame_turn2)
          .asDiagonal();
  add_common_errors(map, {}, fix);
}

/// Whether many landmarks have shown that no place of this world looks like another.
bool Atlas::is_known_without_copies() const noexcept {
  return rates_.structure_decades < kNoCopiesStructure &&
         std::any_of(maps_.begin(), maps_.end(),
                     [](const MapEntry& entry) { return entry.confirmed >= kKnownLandmarks; });
}

/// Whether `map` has been seen often enough to take the place of a home map that gives way, or that there is
/// not yet.
bool Atlas::deserves_home(const MapEntry& map) const noexcept {
  if (is_in_doubt(map)) {
    return false;
  }
  if (home_ == kNoMap) {
    return map.confirmed >= kHomeConfirmed && map.scans >= 2;
  }
  const MapEntry& home = maps_[home_];
  return (home.scans < 2 && map.confirmed >= kHomeAtOnce && map.scans >= kReplacingAlone) ||
         (map.confirmed >= std::max(kHomeConfirmed, 3 * home.confirmed) && map.scans >= kReplacingScans);
}

/// The home map is the first that deserves it. A poor one does not bind: one of a single scan, of which
/// nothing was confirmed, gives way to the first map that three scans show; another, when nothing was found
/// in it for long, to a local map that has become much larger.
void Atlas::choose_home() noexcept {
  const bool is_idle = home_ != kNoMap && scan_.number - maps_[home_].last_scan > kHomeIdleScans &&
                       maps_[home_].confirmed < kHomeSure;
  const bool is_alone = home_ != kNoMap && maps_[home_].scans < 2;
  if (home_ != kNoMap && !is_idle && !is_alone) {
    return;
  }
  MapSlot best = kNoMap;
  for (MapSlot i = 0; i < kMapsMax; ++i) {
    if (i != home_ && maps_[i].number != 0 && deserves_home(maps_[i]) &&
        (best == kNoMap || maps_[i].confirmed > maps_[best].confirmed)) {
      best = i;
    }
  }
  if (best != kNoMap) {
    jumps_ += home_ != kNoMap ? 1 : 0;
    is_home_replaced_ = is_home_replaced_ || (home_ != kNoMap && has_fixed_);
    home_ = best;
    has_fixed_ = false;
    ++revision_;
  }
}

}  // namespace slamsensor::core
