#include "core/mapping/hypothesis_set.hpp"

#include "core/association/rigid_fit.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
namespace {

// Matches within the tolerance are expected to have this spread, as a share of it, before any residual is
// seen.
constexpr double kStartSigmaShare = 1.0 / 3.0;

}  // namespace

HypothesisSet::HypothesisSet(Arena& arena, const Config& config) noexcept
    : config_(config),
      search_(arena, config.association, config.capacities),
      builder_(arena, config),
      scan_B_(arena, "scan: landmarks", config.capacities.scan_landmarks),
      found_(arena, "hypotheses: candidates", config.mapping.hypotheses_max) {
  for (std::uint32_t i = 0; i < config.mapping.hypotheses_max; ++i) {
    pool_[i].emplace(arena, config.capacities);
  }
}

void HypothesisSet::reset() noexcept {
  revision_ += kept_.empty() ? 0 : 1;
  kept_.clear();
  scans_ = 0;
  jumps_ = 0;
}

void HypothesisSet::drop_rivals() noexcept {
  if (!kept_.empty()) {
    const std::uint32_t best = kept_[0];
    kept_.clear();
    SLAMSENSOR_ASSERT(kept_.try_push_back(best));
  }
}

MapCheck HypothesisSet::restore(const MapState& state) noexcept {
  const MapCheck check = check_map(state, config_.capacities);
  if (check.ok()) {
    jumps_ += kept_.empty() ? 0 : 1;
    kept_.clear();
    builder_.restore(state, *pool_[0]);
    SLAMSENSOR_ASSERT(kept_.try_push_back(0));
    scans_ = state.scans;
    ++revision_;
  }
  return check;
}

MapState HypothesisSet::state() const noexcept {
  return kept_.empty() ? MapState{} : state_of(best(), scans_);
}

void HypothesisSet::take_landmarks(std::span<const ScanLandmark> landmarks) noexcept {
  const Pose2 mount_B_L{config_.mount.x_m, config_.mount.y_m, config_.mount.heading_rad};
  scan_B_.clear();
  for (const ScanLandmark& landmark : landmarks) {
    if (!on_lattice(landmark.position_L)) {
      ++counters_.landmarks_refused;
    } else if (!scan_B_.try_push_back(mount_B_L * landmark.position_L)) {
      ++counters_.landmarks_cut;
    }
  }
}

Fix HypothesisSet::process(std::span<const ScanLandmark> landmarks, const Deadline& deadline) noexcept {
  Fix fix;
  fix.scan = scans_++;
  fix.jumps = jumps_;
  take_landmarks(landmarks);
  fix.landmarks_seen = static_cast<std::uint32_t>(scan_B_.size());
  if (scan_B_.size() < std::max(3U, config_.association.landmarks_min)) {
    fix.reason = FixReason::TooFewLandmarks;
  } else if (kept_.empty()) {
    start(fix);
  } else {
    localise(deadline, fix);
  }
  if (!kept_.empty()) {
    fix.landmarks_in_map = best().map.size();
    fix.weight_best = best().weight;
    fix.weight_runner_up = kept_.size() > 1 ? pool_[kept_[1]]->weight : 0;
  }
  return fix;
}

void HypothesisSet::start(Fix& fix) noexcept {
  if (frozen_ == Frozen::Yes) {
    fix.reason = FixReason::NoOverlap;
    return;
  }
  builder_.start(scan_B_.span(), fix.scan, *pool_[0]);
  SLAMSENSOR_ASSERT(kept_.try_push_back(0));
  ++revision_;
  fix.status = FixStatus::Fix;
  fix.reason = FixReason::None;
  fix.map = fix.home = 1;
  fix.search_end = SearchEnd::Complete;
}

void HypothesisSet::localise(const Deadline& deadline, Fix& fix) noexcept {
  const bool is_frozen = frozen_ == Frozen::Yes;
  associate_first(is_frozen ? 1 : kept_.size(), deadline);
  const Generation generation = spawn();
  report(generation[0], fix);
  if (!is_frozen) {
    replace(generation);
    fix.jumps = jumps_;
  }
}

void HypothesisSet::associate_first(std::size_t hypotheses, const Deadline& deadline) noexcept {
  SLAMSENSOR_ASSERT(found_.try_resize(hypotheses));
  for (std::size_t h = 0; h < hypotheses; ++h) {
    const MapView map = pool_[kept_[h]]->map.view();
    search_.search(scan_B_.span(), map, config_.mapping.hypotheses_max, deadline, found_[h]);
    if (found_[h].list.empty() && found_[h].end == SearchEnd::Share &&
        config_.association.exhaust_when_unsure) {
      search_.search_rest(deadline, found_[h]);
    }
    counters_.neighbours_dropped += found_[h].neighbours_dropped;
    counters_.searches_cut += found_[h].end == SearchEnd::Deadline ? 1 : 0;
  }
}

/// The next generation of the parents that were associated, best W first. A parent in which the scan was not
/// found goes on as it is; one in which it was found goes on only in its offspring, one for each candidate.
HypothesisSet::Generation HypothesisSet::spawn() const noexcept {
  Generation generation;
  const auto insert = [&](const Offspring& offspring) {
    if (generation.size() == config_.mapping.hypotheses_max) {
      if (offspring.weight <= generation.back().weight) {
        return;
      }
      generation.truncate(generation.size() - 1);
    }
    std::size_t place = generation.size();
    SLAMSENSOR_ASSERT(generation.try_push_back(offspring));
    for (; place > 0 && generation[place - 1].weight < offspring.weight; --place) {
      generation[place] = generation[place - 1];
    }
    generation[place] = offspring;
  };
  for (std::uint32_t h = 0; h < found_.size(); ++h) {
    const std::uint64_t weight = pool_[kept_[h]]->weight;
    const Candidates& found = found_[h];
    if (found.list.empty()) {
      insert({h, -1, weight});
    }
    for (std::size_t c = 0; c < found.list.size(); ++c) {
      insert({h, static_cast<std::int32_t>(c), weight + found.list[c].matches.size()});
    }
  }
  return generation;
}

void HypothesisSet::report(const Offspring& best, Fix& fix) noexcept {
  const Candidates& found = found_[best.parent];
  const LandmarkMap& map = pool_[kept_[best.parent]]->map;
  fix.search_end = found.end;
  if (best.candidate < 0) {
    fix.reason = found.end == SearchEnd::Deadline ? FixReason::Deadline : FixReason::NoOverlap;
    return;
  }
  const Candidate& candidate = found.list[static_cast<std::size_t>(best.candidate)];
  fix.status = FixStatus::Fix;
  fix.reason = FixReason::None;
  fix.map = fix.home = 1;
  fix.pose_W = candidate.pose_W;
  fix.matches = static_cast<std::uint32_t>(candidate.matches.size());
  fix.expected_false_alarms = static_cast<double>(std::max<std::uint64_t>(found.poses_tried, 1)) *
                              std::pow(10.0, candidate.log10_chance);
  fix.error_xi = PositionalError::of_scan(map, candidate.triangle);
  fix.covariance_near =
      pose_covariance(candidate.pose_W, candidate.matches.span(), scan_B_.span(), map.positions_W(),
                      kStartSigmaShare * config_.association.tolerance_m);
  // The residuals tell how well the scan fits the map about it. Between there and the origin stand xi
  // triangulations of the same kind; a heading error of one displaces all that follow, so their errors add up
  // rather than average out.
  const double chain = 1.0 + fix.error_xi;
  fix.covariance = fix.covariance_near * (chain * chain);
}

void HypothesisSet::extend(std::uint32_t slot, const Offspring& offspring) noexcept {
  if (offspring.candidate >= 0) {
    const Candidate& candidate = found_[offspring.parent].list[static_cast<std::size_t>(offspring.candidate)];
    builder_.extend(scan_B_.span(), candidate, scans_ - 1, *pool_[slot]);
  }
}

/// Turns the kept hypotheses into the next generation. A parent's first offspring takes over its slot; the
/// others are copied into slots that no parent with offspring holds. There are at most hypotheses_max of all
/// of them.
void HypothesisSet::replace(const Generation& generation) noexcept {
  std::array<bool, kHypothesesMax> taken{};
  std::array<bool, kHypothesesMax> first_done{};
  FixedVector<std::uint32_t, kHypothesesMax> next;
  for (const Offspring& offspring : generation) {
    taken[kept_[offspring.parent]] = true;
  }
  for (const Offspring& offspring : generation) {
    std::uint32_t slot = kept_[offspring.parent];
    if (first_done[offspring.parent]) {
      slot = static_cast<std::uint32_t>(std::find(taken.begin(), taken.end(), false) - taken.begin());
      SLAMSENSOR_ASSERT(slot < config_.mapping.hypotheses_max);
      taken[slot] = true;
      pool_[slot]->copy_from(*pool_[kept_[offspring.parent]]);
    }
    first_done[offspring.parent] = true;
    SLAMSENSOR_ASSERT(next.try_push_back(slot));
  }
  for (std::size_t i = 0; i < generation.size(); ++i) {
    extend(next[i], generation[i]);
  }
  const bool has_jumped = generation[0].parent != 0;  // the solution goes on from what was not the solution
  jumps_ += has_jumped ? 1 : 0;
  revision_ += has_jumped || generation[0].candidate >= 0 ? 1 : 0;
  kept_ = next;
}

}  // namespace slamsensor::core
