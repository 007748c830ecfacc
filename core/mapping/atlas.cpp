#include "core/mapping/atlas.hpp"

#include "core/graph/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamsensor::core {
namespace {

constexpr std::uint32_t kHomeAtOnce = 10;  // landmarks of a first scan that may found the home map by itself
constexpr std::uint32_t kHomeConfirmed = 5;   // landmarks seen twice that make a local map the home map
constexpr std::uint32_t kHomeIdleScans = 30;  // without a fix, after which a home map ...
constexpr std::uint32_t kHomeSure =
    30;  // ... of fewer confirmed landmarks than this gives way to a larger map
constexpr std::uint32_t kMapLandmarksMin = 4;  // of a scan that starts a local map
constexpr std::uint32_t kTieLandmarksMin = 6;  // confirmed landmarks of a local map before it may be tied
constexpr std::uint32_t kAgainMin = 3;         // landmarks that two scans in a row show ...
constexpr double kAgainShare = 0.4;     // ... and this share of all, so that the second shows the first again
constexpr std::uint64_t kTieScans = 3;  // in a row that agree on where a local map lies before it is tied
constexpr double kHomeShare =
    0.5;  // of the decades of a local map, with which the home map is still believed
constexpr double kScansTieDecades = 15.0;    // in all, of scans that agree on where their local map lies
constexpr double kPlaceGroups = 3.0;         // decades of groups, and ...
constexpr double kPlaceContradiction = 2.0;  // ... decades against, of a scan that counts for a place
constexpr double kFirstTurn_rad =
    0.25 * kDegree;                     // 1 sigma: the first fix in a home map is what users align by
constexpr double kTieStructure = 7.0;   // a world that repeats itself less than this is tied at once
constexpr std::size_t kWeighedMin = 6;  // candidates that are weighed, however far behind the leader
constexpr double kWeighedNats = 15.0;   // others are weighed when they are not farther behind than this
constexpr double kContradicted =
    1e-3;                             // a landmark goes when so many misses in a row are as unlikely as this
constexpr double kNeverThere = 0.02;  // the same of one that was seen once
constexpr double kSeldom = 0.12;      // a landmark shown by fewer of its chances than this goes ...
constexpr std::uint32_t kSeldomChances = 15;  // ... after so many
constexpr double kTwinSigmas = 4.5;           // nearer to a landmark than this, nothing new is put
constexpr double kTwinGateSigmas = 3.0;  // nearer to each other than this, landmarks of tied maps are one
constexpr std::uint32_t kSaturated =
    60;                               // sightings of each match after which a scan adds nothing to the graph
constexpr double kLearnApart = 0.03;  // of the scan's reach
constexpr double kRatesMemory = 4'000.0;       // observations after which old ones are forgotten
constexpr std::uint32_t kRefitAround = 16;     // poses
constexpr std::uint32_t kRefitInTurn = 6'000;  // sightings a scan
constexpr double kMeanSigmaShare = 0.7;        // spread of a mean of two sightings or more, of a scan's
constexpr std::uint32_t kProbeLandmarks = 40;  // of a place of the map that is held against the map itself
constexpr double kSurveyedAbout_m = ExploredGround::kCell_m;
constexpr std::uint32_t kLoopScans = 20;  // a landmark unseen for so long closes a loop when it is seen again
constexpr std::uint32_t kStepsAfterLoop = 4;  // group steps, one a scan
constexpr std::uint32_t kGroupStepScans = 3;  // a group step after so many scans ...
constexpr std::uint64_t kSightingsPerScan =
    3'000;  // ... or more, so that a scan's share of it is this many sightings
// Calibrated on real drives against their references (tests/truth): about what is left of their errors.
constexpr double kScanBias_m = 0.04;
constexpr double kScanBias_rad = 0.15 * kDegree;
constexpr double kFrameBias_rad = 0.06 * kDegree;
constexpr double kDriftInflation = 1.5;  // of the drift's variance, for what sightings' errors have in common
constexpr double kLookReach_m = 80.0;    // ground farther than this is not marked as explored

}  // namespace

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
      seen_(arena, "scan: sightings", config.capacities.scan_landmarks),
      confirmed_(arena, "ties: landmarks", config.capacities.scan_landmarks),
      confirmed_slots_(arena, "ties: landmark slots", config.capacities.scan_landmarks),
      found_(arena, "association: candidates", 1),
      weighed_(arena, "decision: weighed candidates", kCandidatesMax),
      weighed_ties_(arena, "decision: weighed ties", kCandidatesMax) {
  SLAMSENSOR_ASSERT(found_.try_resize(1));
  if (config.association.search == SearchMethod::Paper) {
    by_graph_.emplace(arena, config.association, config.capacities);
  }
}

void Atlas::reset() noexcept {
  graph_.clear();
  ground_.clear();
  rates_ = Rates{};
  learned_in_ = kNoMap;
  maps_ = {};
  home_ = kNoMap;
  is_surveyed_ = has_fixed_ = false;
  scans_ = 0;
  jumps_ = 0;
  maps_made_ = 0;
  landmarks_evicted_ = 0;
  closed_scan_ = group_steps_due_ = scans_since_step_ = 0;
  was_unseen_ = {};
  ++revision_;
}

void Atlas::take_landmarks(std::span<const ScanLandmark> landmarks) noexcept {
  points_L_.clear();
  points_B_.clear();
  scan_.reach_m = 0.0;
  for (const ScanLandmark& landmark : landmarks) {
    if (!on_lattice(landmark.position_L)) {
      ++counters_.landmarks_refused;
    } else if (!points_L_.try_push_back(landmark.position_L)) {
      ++counters_.landmarks_cut;
    } else {
      SLAMSENSOR_ASSERT(points_B_.try_push_back(graph_.body_point(landmark.position_L)));
      scan_.reach_m = std::max(scan_.reach_m, landmark.position_L.norm());
    }
  }
}

Witnesses Atlas::scan_witnesses() const noexcept {
  Witnesses witnesses;
  witnesses.points_B = points_B_.span();
  witnesses.view = scan_.view;
  witnesses.T_L_B = T_L_B_;
  witnesses.is_surveyed = is_surveyed_;
  return witnesses;
}

Fix Atlas::process(std::span<const ScanLandmark> landmarks, const ScanView& view,
                   const Deadline& deadline) noexcept {
  Fix fix;
  fix.scan = scan_.number = scans_++;
  scan_.view = &view;
  take_landmarks(landmarks);
  weighed_.clear();
  fix.landmarks_seen = static_cast<std::uint32_t>(points_B_.size());
  if (points_B_.size() < std::max(3U, config_.association.landmarks_min)) {
    fix.reason = FixReason::TooFewLandmarks;
  } else {
    search(deadline, fix);
    localise(deadline, fix);
  }
  fix.jumps = jumps_;
  if (home_ != kNoMap) {
    fix.home = maps_[home_].number;
    fix.landmarks_in_map = maps_[home_].landmarks;
    fix.weight_best = maps_[home_].W;
  }
  return fix;
}

MatchModel Atlas::scan_model() const noexcept {
  MatchModel model;
  model.sigma_m = rates_.sigma_m(scale_.start_sigma_m());
  model.detection = rates_.mean_detection();
  model.density_per_m2 = static_cast<double>(points_B_.size()) /
                         std::max(1.0, std::numbers::pi * scan_.reach_m * scan_.reach_m);
  return model;
}

void Atlas::search(const Deadline& deadline, Fix& fix) noexcept {
  find(points_B_.span(), kNoMap, scan_model(), deadline);
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
  fix.covariance_near(0, 0) += kScanBias_m * kScanBias_m;
  fix.covariance_near(1, 1) += kScanBias_m * kScanBias_m;
  fix.covariance_near(2, 2) += kScanBias_rad * kScanBias_rad;
  fix.covariance = fix.covariance_near;
  // The map about the scan is as good as the best known of its landmarks.
  std::optional<Eigen::Matrix3d> least;
  for (const Match& match : matches) {
    const std::uint32_t pose = graph_.landmark(match.map).brought_by;
    const Eigen::Matrix3d drift =
        pose == SightingGraph::kNone ? Eigen::Matrix3d(Eigen::Matrix3d::Zero()) : graph_.drift_of(pose);
    if (!least || drift.trace() < least->trace()) {
      least = drift;
    }
  }
  if (least) {
    const double sigma_m = rates_.sigma_m(scale_.start_sigma_m());
    fix.covariance += sigma_m * sigma_m * kDriftInflation * *least;
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

void Atlas::localise(const Deadline& deadline, Fix& fix) noexcept {
  bool is_held_back = false;  // the map grows, but its first fix has to be better than this one
  Verdict verdict;
  verdict.reason = fix.search_end == SearchEnd::Deadline ? FixReason::Deadline : FixReason::NoOverlap;
  if (home_ != kNoMap) {
    verdict = decide(weighed_.span(), home_, stake_of(home_), fix.search_end, rates_.structure_decades,
                     config_.acceptance);
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
      weighed_[verdict.chosen].evidence.ln_bayes < kHomeShare * weighed_[*local].evidence.ln_bayes;
  if (verdict.chosen != SIZE_MAX) {
    describe(weighed_[verdict.chosen], fix);
  }
  if (frozen_ == Frozen::Yes) {
    return;
  }
  MapSlot tie_of = kNoMap;
  if (verdict.status == FixStatus::Fix && !fits_local_better) {
    extend(weighed_[verdict.chosen]);
    tie_of =
        local && weighed_[*local].evidence.ln_bayes > std::log(1e4) ? weighed_[*local].candidate.map : kNoMap;
  } else if (local && decide(weighed_.span(), weighed_[*local].candidate.map, Stake::Local, fix.search_end,
                             rates_.structure_decades, config_.acceptance)
                              .status == FixStatus::Fix) {
    const Weighed& chosen = weighed_[*local];
    if (verdict.status == FixStatus::NoFix || fits_local_better) {
      describe(chosen, fix);
      fix.status = FixStatus::NoFix;
      fix.reason = FixReason::LocalMap;
    }
    note_places(chosen);
    extend(chosen);
    tie_of = chosen.candidate.map;
  } else if (fix.search_end != SearchEnd::Deadline || graph_.index().size() == 0) {
    start_map(fix);  // a search that was cut does not say that the place is unknown
  }
  if (is_held_back && fix.status == FixStatus::Fix) {
    fix.status = FixStatus::NoFix;
    fix.reason = FixReason::TooFewLandmarks;
  }
  has_fixed_ = has_fixed_ || fix.status == FixStatus::Fix;
  if (tie_of != kNoMap) {
    try_tie(tie_of, deadline);
  }
  choose_home();
}

/// What a fix in `map` stakes: less when this scan shows again much of what the scan before showed there.
Stake Atlas::stake_of(MapSlot map) const noexcept {
  if (is_surveyed_) {
    return Stake::Survey;
  }
  const std::size_t best = best_in(weighed_.span(), map);
  if (best == SIZE_MAX || scan_.number == 0 || maps_[map].last_scan + 1 != scan_.number) {
    return Stake::Fix;
  }
  const auto again = std::count_if(
      weighed_[best].candidate.matches.begin(), weighed_[best].candidate.matches.end(),
      [&](const Match& match) { return graph_.landmark(match.map).last_scan + 1 == scan_.number; });
  const double wanted =
      std::max(static_cast<double>(kAgainMin), kAgainShare * static_cast<double>(points_B_.size()));
  return static_cast<double>(again) >= wanted ? Stake::Again : Stake::Fix;
}

/// The scan of a local map that may also lie elsewhere says where the whole local map may lie.
void Atlas::note_places(const Weighed& local) noexcept {
  MapEntry& map = maps_[local.candidate.map];
  for (const Weighed& other : weighed_) {
    if (other.candidate.map == local.candidate.map || other.evidence.ln_bayes < std::log(100.0)) {
      continue;
    }
    const Pose2 T = other.candidate.pose_W * local.candidate.pose_W.inverse();
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

/// Brings the scan into the map that it is believed in.
void Atlas::extend(const Weighed& w) noexcept {
  const MapSlot map = w.candidate.map;
  MapEntry& entry = maps_[map];
  entry.last_scan = scan_.number;  // from here on it is no map that could make room for others
  learn_from(w);
  rates_.see_runner_up(runner_up_decades(weighed_.span(), static_cast<std::size_t>(&w - weighed_.begin()),
                                         config_.acceptance));
  std::array<std::uint32_t, 3> parents;
  const std::uint32_t xi = update_matched(w, parents);
  look_for_missing(w);
  const double twin_m = kTwinSigmas * std::max(w.evidence.sigma_m, scale_.start_sigma_m() * 0.5);
  bool is_saturated = true;
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
    ++entry.landmarks;
    is_saturated = false;
    SLAMSENSOR_ASSERT(seen_.try_push_back({slot, points_L_[i]}));
  }
  look_around(map, w.candidate.pose_W);
  entry.W += w.candidate.matches.size();
  ++entry.scans;
  entry.last_pose = w.candidate.pose_W;
  if (!is_saturated) {
    GraphPose pose;
    pose.T_W_B = w.candidate.pose_W;
    pose.scan = scan_.number;
    pose.xi = xi;
    pose.map = map;
    pose.group =
        entry.last_place == SightingGraph::kNone ? std::uint16_t{0} : graph_.pose(entry.last_place).group;
    graph_.set_robust_scale(
        std::max(config_.association.tolerance_m, 3.0 * rates_.sigma_m(scale_.start_sigma_m())));
    entry.last_place = graph_.add_pose(pose, seen_.span());
    graph_.refit(entry.last_place);
    graph_.refit_around(entry.last_place, kRefitAround);
    graph_.refit_in_turn(kRefitInTurn);
    step_groups(w, map);
    entry.last_pose = graph_.pose(entry.last_place).T_W_B;
  }
  ++revision_;
}

/// Group steps come after so many scans that each scan pays the same share of them, and at once when a scan
/// closes a loop: when it shows again what was not seen for long.
void Atlas::step_groups(const Weighed& w, MapSlot map) noexcept {
  const auto old =
      std::count_if(w.candidate.matches.begin(), w.candidate.matches.end(), [&](const Match& match) {
        return graph_.is_used(match.map) && scan_.number - closed_scan_ > kLoopScans &&
               graph_.landmark(match.map).first_scan + kLoopScans < scan_.number && was_unseen_[match.scan];
      });
  if (old >= 3) {
    closed_scan_ = scan_.number;
    group_steps_due_ = kStepsAfterLoop;
  }
  ++scans_since_step_;
  const auto share = static_cast<std::uint32_t>(graph_.sightings_kept() / kSightingsPerScan);
  if (group_steps_due_ > 0 || scans_since_step_ >= std::max(kGroupStepScans, share)) {
    group_steps_due_ -= group_steps_due_ > 0 ? 1 : 0;
    scans_since_step_ = 0;
    graph_.group_step(map, rates_.sigma_m(scale_.start_sigma_m()));
    rates_.offset_m = graph_.offset_m();
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
void Atlas::learn_from(const Weighed& w) noexcept {
  const double apart_m = (w.candidate.pose_W.translation() - learned_at_.translation()).norm();
  learns_ = learned_in_ != w.candidate.map || apart_m > kLearnApart * scan_.reach_m;
  if (!learns_) {
    return;
  }
  learned_in_ = w.candidate.map;
  learned_at_ = w.candidate.pose_W;
  double scaled2 = 0.0;
  for (const Match& match : w.candidate.matches) {
    const Point2 seen_W = w.candidate.pose_W * points_B_[match.scan];
    scaled2 += (seen_W - graph_.positions()[match.map]).squaredNorm() /
               (1.0 + 1.0 / static_cast<double>(graph_.standing()[match.map].sightings));
  }
  rates_.spread_m2 += scaled2;
  rates_.spread_count += std::max(0.0, 2.0 * static_cast<double>(w.candidate.matches.size()) - 3.0);
  rates_.clutter += w.evidence.unmatched;
  rates_.clutter_count += w.evidence.explored;
  for (const Point2& p : points_L_) {
    rates_.bearings[Rates::bearing_bin(std::atan2(p.y(), p.x()))] += 1.0F;
  }
  if (rates_.spread_count > kRatesMemory) {
    rates_.spread_m2 *= 0.5;
    rates_.spread_count *= 0.5;
  }
  if (rates_.clutter_count > kRatesMemory) {
    rates_.clutter *= 0.5;
    rates_.clutter_count *= 0.5;
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
        const std::size_t bin = Rates::range_bin(range_m);
        Standing& standing = graph_.standing(slot);
        if (!learns_) {
          // no news of how scans show landmarks
        } else if (standing.sightings < 2 ||
                   (is_matched && standing.sightings == 2)) {  // until now seen once: it may be nothing
          rates_.second_count += 1.0;
          rates_.second += is_matched ? 1.0 : 0.0;
        } else {
          rates_.in_view[bin] += 1.0F;
          rates_.shown[bin] += is_matched ? 1.0F : 0.0F;
          if (rates_.in_view[bin] > static_cast<float>(kRatesMemory)) {
            rates_.in_view[bin] *= 0.5F;
            rates_.shown[bin] *= 0.5F;
          }
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
    const GraphLandmark& l = graph_.landmark(gone[i]);
    if (l.brought_by != SightingGraph::kNone && graph_.standing(gone[i]).sightings == 1) {
      ++graph_.pose(l.brought_by).gone;
    }
    remove_landmark(gone[i]);
  }
}

void Atlas::remove_landmark(std::uint32_t slot) noexcept {
  MapEntry& entry = maps_[graph_.landmark(slot).map];
  --entry.landmarks;
  entry.confirmed -= graph_.standing(slot).sightings >= 2 && entry.confirmed > 0 ? 1 : 0;
  graph_.remove_landmark(slot);
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
      ++entry.landmarks;
      SLAMSENSOR_ASSERT(seen_.try_push_back({slot, points_L_[i]}));
    }
  }
  GraphPose pose;
  pose.scan = scan_.number;
  pose.map = map;
  pose.is_anchor = 1;
  entry.last_place = graph_.add_pose(pose, seen_.span());
  look_around(map, Pose2{});
  ++revision_;
  double square_m2 = 0.0;
  for (const Point2& p : points_B_) {
    square_m2 += p.squaredNorm();
  }
  entry.frame_turn2 = scale_.start_sigma_m() * scale_.start_sigma_m() / std::max(1.0, square_m2);
  const bool is_first = maps_made_ == 1;
  if (home_ == kNoMap && is_first && points_B_.size() >= kHomeAtOnce) {
    home_ = map;
    fix.status = FixStatus::Fix;
    fix.reason = FixReason::None;
    fix.search_end = SearchEnd::Complete;
    fix.map = entry.number;
    const double sigma_m = scale_.start_sigma_m();
    // The origin by definition; what the first scan leaves open is the turn of the frame.
    fix.covariance_near =
        Eigen::Vector3d(sigma_m * sigma_m / static_cast<double>(points_B_.size()),
                        sigma_m * sigma_m / static_cast<double>(points_B_.size()), entry.frame_turn2)
            .asDiagonal();
    add_common_errors(map, {}, fix);
  } else if (fix.status == FixStatus::NoFix && fix.reason == FixReason::NoOverlap) {
    // Known nowhere: its own local map is all that is known of it.
    fix.map = 0;
  }
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
  // A sixteenth of all at once, so that the search for them is paid once for many.
  const std::uint32_t batch = std::max(wanted, graph_.slots() / 16);
  for (std::uint32_t dropped = 0; dropped < batch;) {
    std::uint32_t worst = SightingGraph::kNone;
    double worst_use = std::numeric_limits<double>::infinity();
    // One pass finds the worst of a stride: bounded, and near enough to the least useful.
    for (std::uint32_t slot = dropped; slot < graph_.slots(); slot += 16) {
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
    ++dropped;
    if (worst == SightingGraph::kNone) {
      return;
    }
    remove_landmark(worst);
    ++landmarks_evicted_;
    if (dropped >= wanted + 15) {
      return;
    }
  }
}

/// The home map is the first that deserves it. A poor one does not bind: when nothing was found in it for
/// long, and a local map has become much larger, that one is the home map from then on.
void Atlas::choose_home() noexcept {
  const bool is_idle = home_ != kNoMap && scan_.number - maps_[home_].last_scan > kHomeIdleScans &&
                       maps_[home_].confirmed < kHomeSure;
  const bool is_alone = home_ != kNoMap && maps_[home_].scans < 2;
  if (home_ != kNoMap && !is_idle && !is_alone) {
    return;
  }
  MapSlot best = kNoMap;
  for (MapSlot i = 0; i < kMapsMax; ++i) {
    const std::uint32_t wanted =
        home_ == kNoMap ? kHomeConfirmed : std::max(kHomeConfirmed, 3 * maps_[home_].confirmed);
    if (i != home_ && maps_[i].number != 0 && maps_[i].confirmed >= wanted &&
        maps_[i].scans >= (home_ == kNoMap ? 2U : 4U) &&
        (best == kNoMap || maps_[i].confirmed > maps_[best].confirmed)) {
      best = i;
    }
  }
  if (best != kNoMap) {
    jumps_ += home_ != kNoMap ? 1 : 0;
    home_ = best;
    has_fixed_ = false;
    ++revision_;
  }
}

/// Holds the confirmed landmarks of a local map, as a whole, against all other maps.
void Atlas::try_tie(MapSlot map, const Deadline& deadline) noexcept {
  const MapEntry& entry = maps_[map];
  if (map == home_ || tie_by_scans(map) || entry.confirmed < kTieLandmarksMin) {
    return;
  }
  confirmed_.clear();
  confirmed_slots_.clear();
  const double reach_m = std::max(scan_.reach_m, 30.0);
  graph_.index().visit_within(map, entry.last_pose.translation(), reach_m, [&](std::uint32_t slot, double) {
    if (graph_.standing(slot).sightings >= 2 && confirmed_.try_push_back(graph_.positions()[slot])) {
      SLAMSENSOR_ASSERT(confirmed_slots_.try_push_back(slot));
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
  witnesses.own_map = map;
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
  Verdict verdict = decide(weighed_ties_.span(), target, Stake::Tie, found_[0].end, rates_.structure_decades,
                           config_.acceptance);
  if (verdict.status != FixStatus::Fix && !weighed_ties_.empty() &&
      weighed_ties_[0].candidate.map != target) {
    verdict = decide(weighed_ties_.span(), weighed_ties_[0].candidate.map, Stake::Tie, found_[0].end,
                     rates_.structure_decades, config_.acceptance);
  }
#ifdef DEBUG_TIE
  {
    size_t b = best_in(weighed_ties_.span(), target);
    if (b != SIZE_MAX) {
      auto& w = weighed_ties_[b];
      __builtin_printf(
          "  TIE map %u->%u n %zu m %zu bf %.1f grp %.1f un %u/%u %.1f miss %u/%u %.1f sig %.2f deg %.2f -> "
          "%d %d\n",
          map, target, confirmed_.size(), w.candidate.matches.size(), w.evidence.ln_bayes / 2.3,
          w.evidence.group_decades, w.evidence.unmatched, w.evidence.explored, w.evidence.log10_unmatched,
          w.evidence.missing, w.evidence.in_view, w.evidence.log10_missing,
          position_sigma_m(w.evidence.covariance), std::sqrt(w.evidence.covariance(2, 2)) * 57.3,
          (int)verdict.status, (int)verdict.reason);
    } else
      __builtin_printf("  TIE map %u -> none of %zu, n %zu\n", map, weighed_ties_.size(), confirmed_.size());
  }
#endif
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
  const PlaceHypothesis place = entry.places[0];
  Weighed tied;
  tied.candidate.map = place.target;
  tied.candidate.pose_W = place.T_target_map;
  confirmed_slots_.clear();
  const double gate_m = 3.7 * rates_.sigma_m(scale_.start_sigma_m());
  graph_.index().visit_within(
      map, entry.last_pose.translation(), 2.0 * std::max(scan_.reach_m, 30.0),
      [&](std::uint32_t slot, double) {
        double d2 = 0.0;
        const Point2 p = place.T_target_map * graph_.positions()[slot];
        const std::uint32_t twin = graph_.index().nearest_within(place.target, p, gate_m, d2);
        const bool is_taken = std::any_of(tied.candidate.matches.begin(), tied.candidate.matches.end(),
                                          [&](const Match& match) { return match.map == twin; });
        if (twin != LandmarkIndex::kNone && !is_taken && confirmed_slots_.try_push_back(slot) &&
            !tied.candidate.matches.try_push_back(
                {static_cast<std::uint32_t>(confirmed_slots_.size() - 1), twin})) {
          confirmed_slots_.truncate(confirmed_slots_.size() - 1);
        }
      });
  if (tied.candidate.matches.size() < 3) {
    return false;
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
  if (last.W >= kTieScans || rates_.structure_decades < kTieStructure) {
    tie(map, w);
  }
}

/// Pairs of landmarks, of `map` and of the map that it is tied to, that are one: those that the tie matched, and what else
/// stands at one place, as far as there is room.
MatchList Atlas::twins_of(MapSlot map, const Weighed& w) const noexcept {
  MatchList twins;
  for (const Match& match : w.candidate.matches) {
    SLAMSENSOR_ASSERT(twins.try_push_back({confirmed_slots_[match.scan], match.map}));
  }
  const double gate_m = kTwinGateSigmas * rates_.sigma_m(scale_.start_sigma_m());
  for (std::uint32_t slot = 0; slot < graph_.slots(); ++slot) {
    double d2 = 0.0;
    if (!graph_.is_used(slot) || graph_.landmark(slot).map != map) {
      continue;
    }
    const Point2 p = w.candidate.pose_W * graph_.positions()[slot];
    const std::uint32_t twin = graph_.index().nearest_within(w.candidate.map, p, gate_m, d2);
    const bool is_taken = std::any_of(twins.begin(), twins.end(),
                                      [&](const Match& pair) { return pair.scan == slot || pair.map == twin; });
    if (twin != LandmarkIndex::kNone && !is_taken && !twins.try_push_back({slot, twin})) {
      break;
    }
  }
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
  for (std::uint32_t slot = 0; slot < graph_.slots(); ++slot) {
    if (graph_.is_used(slot) && graph_.landmark(slot).map == map) {
      GraphLandmark& l = graph_.landmark(slot);
      l.parents = l.xi == 0 ? parents : l.parents;
      l.xi += xi + 1;
    }
  }
  const MatchList twins = twins_of(map, w);
  MapEntry& from = maps_[map];
  MapEntry& into = maps_[to];
  graph_.visit_poses([&](std::uint32_t place, const GraphPose& pose) {
    if (pose.map == map) {
      graph_.pose(place).xi += xi + 1;
      look_around(to, w.candidate.pose_W * pose.T_W_B);
    }
  });
  graph_.merge(map, to, w.candidate.pose_W, twins.span());
  into.landmarks = into.confirmed = 0;
  for (std::uint32_t slot = 0; slot < graph_.slots(); ++slot) {
    if (graph_.is_used(slot) && graph_.landmark(slot).map == to) {
      ++into.landmarks;
      into.confirmed += graph_.standing(slot).sightings >= 2 ? 1 : 0;
    }
  }
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

bool Atlas::take_survey(std::span<const Point2> landmarks_W) noexcept {
  constexpr std::uint32_t kSurveyed = 10;  // sightings that a surveyed place counts as
  reset();
  if (landmarks_W.size() > config_.capacities.map_landmarks) {
    return false;
  }
  home_ = 0;
  maps_[0].number = ++maps_made_;
  maps_[0].scans = 2;
  for (const Point2& p_W : landmarks_W) {
    const std::uint32_t slot = graph_.add_landmark(0, p_W, 0, 0);
    SLAMSENSOR_ASSERT(slot != SightingGraph::kNone);
    graph_.standing(slot) = {kSurveyed, kSurveyed};
    graph_.set_prior(slot, kSurveyed);
    ++maps_[0].landmarks;
    ++maps_[0].confirmed;
    for (const double dy :
         {-kSurveyedAbout_m, 0.0, kSurveyedAbout_m}) {  // a survey leaves out nothing beside a landmark
      for (const double dx : {-kSurveyedAbout_m, 0.0, kSurveyedAbout_m}) {
        ground_.look(0, p_W + Point2(dx, dy), 0.9);
      }
    }
  }
  is_surveyed_ = true;
  probe_structure();
  return true;
}

/// Learns how far a map repeats itself, from samples of its own places.
void Atlas::probe_structure() noexcept {
  constexpr std::uint32_t kProbes = 64;
  constexpr double kProbeReach_m = 20.0;
  const std::uint32_t step = std::max(1U, graph_.slots() / kProbes);
  for (std::uint32_t slot = 0; slot < graph_.slots(); slot += step) {
    const Point2 middle = graph_.positions()[slot];
    points_B_.clear();
    points_L_.clear();
    graph_.index().visit_within(home_, middle, kProbeReach_m, [&](std::uint32_t other, double) {
      if (points_B_.size() < kProbeLandmarks) {
        SLAMSENSOR_ASSERT(points_B_.try_push_back(graph_.positions()[other] - middle));
      }
    });
    ScanView view;
    scan_.view = &view;
    scan_.reach_m = kProbeReach_m;
    // By the fast search in any case: the paper's may take minutes for this.
    fast_.search(points_B_.span(), graph_.index(), graph_.positions(), kNoMap, scan_model(), {}, found_[0]);
    weigh(scan_witnesses(), found_[0], weighed_);
    const std::size_t best = best_in(weighed_.span(), home_);
    if (best != SIZE_MAX) {
      rates_.see_runner_up(runner_up_decades(weighed_.span(), best, config_.acceptance));
    }
  }
  scan_.view = nullptr;
  weighed_.clear();
}

MapState Atlas::copy_home(const MapRoom& room) const noexcept {
  MapState state;
  state.scans = scans_;
  state.next_id = graph_.next_id();
  state.landmarks_evicted = landmarks_evicted_;
  state.path_thinnings = graph_.poses_folded();
  if (home_ == kNoMap) {
    return state;
  }
  state.weight = maps_[home_].W;
  std::size_t count = 0;
  for (std::uint32_t slot = 0; slot < graph_.slots() && count < room.landmarks.size(); ++slot) {
    if (!graph_.is_used(slot) || graph_.landmark(slot).map != home_) {
      continue;
    }
    const GraphLandmark& l = graph_.landmark(slot);
    const Standing& standing = graph_.standing()[slot];
    room.landmarks[count] = {l.id,         l.xi,       l.parents, standing.sightings, standing.chances,
                             l.first_scan, l.last_scan};
    // Two numbers share the array until it is sorted: the slot stands where the place will.
    room.positions_W[count] = {static_cast<double>(l.id), static_cast<double>(slot)};
    ++count;
  }
  const std::span<MapLandmark> landmarks = room.landmarks.first(count);
  const std::span<Point2> positions = room.positions_W.first(count);
  std::sort(landmarks.begin(), landmarks.end(),
            [](const MapLandmark& a, const MapLandmark& b) { return a.id < b.id; });
  std::sort(positions.begin(), positions.end(),
            [](const Point2& a, const Point2& b) { return a.x() < b.x(); });
  for (Point2& p : positions) {
    p = graph_.positions()[static_cast<std::size_t>(p.y())];
  }
  state.landmarks = landmarks;
  state.positions_W = positions;
  std::size_t poses = 0;
  graph_.visit_poses([&](std::uint32_t, const GraphPose& pose) {
    if (pose.map == home_ && poses < room.path.size() &&
        (poses == 0 || pose.scan > room.path[poses - 1].scan)) {
      room.path[poses++] = {pose.scan, pose.xi, pose.T_W_B};
    }
  });
  state.path = room.path.first(poses);
  return state;
}

MapCheck Atlas::restore(const MapState& state) noexcept {
  const MapCheck check = check_map(state, config_.capacities);
  if (!check.ok()) {
    return check;
  }
  jumps_ += home_ != kNoMap ? 1 : 0;
  const std::uint32_t jumps = jumps_;
  reset();
  jumps_ = jumps;
  home_ = 0;
  has_fixed_ = true;  // the frame is known from before
  MapEntry& entry = maps_[0];
  entry.number = ++maps_made_;
  entry.scans = std::max(2U, static_cast<std::uint32_t>(state.path.size()));
  entry.W = state.weight;
  scans_ = state.scans;
  for (std::size_t i = 0; i < state.landmarks.size(); ++i) {
    const MapLandmark& from = state.landmarks[i];
    graph_.set_next_id(from.id);
    const std::uint32_t slot = graph_.add_landmark(0, state.positions_W[i], from.first_scan, from.xi);
    SLAMSENSOR_ASSERT(slot != SightingGraph::kNone);
    GraphLandmark& l = graph_.landmark(slot);
    l.last_scan = from.last_scan;
    l.parents = from.parents;
    graph_.standing(slot) = {from.sightings, std::max(from.chances, from.sightings)};
    graph_.set_prior(slot, from.sightings);
    ++entry.landmarks;
    entry.confirmed += from.sightings >= 2 ? 1 : 0;
    // Where landmarks are, somebody looked.
    ground_.look(0, state.positions_W[i], 0.9);
  }
  graph_.set_next_id(state.next_id);
  landmarks_evicted_ = state.landmarks_evicted;
  probe_structure();
  return check;
}

}  // namespace slamsensor::core
