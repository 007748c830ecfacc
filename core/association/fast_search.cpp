#include "core/association/fast_search.hpp"

#include "core/association/rigid_fit.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
namespace {

// Costs in about nanoseconds, to know when to look at the clock and when enough has been done.
constexpr std::uint64_t kWorkPerEntry = 1;
constexpr std::uint64_t kWorkPerQuery = 60;
constexpr std::uint64_t kWorkPerPose = 120;
constexpr std::uint64_t kWorkPerMatch = 60;  // per landmark of the scan and round
constexpr std::uint64_t kWorkPerDeadlineLook = 50'000;

// With a clear leader a rival elsewhere would have shown by now: it shares a fifth of the leader's triangles
// or more, so that each of these tries has that chance to meet it.
constexpr std::uint64_t kTrianglesEnough = 24;
constexpr std::uint64_t kWorkEnough = 150'000;
constexpr double kClearLead = 20.0;  // nats of likelihood against chance

constexpr std::uint32_t kConfirmations =
    2;  // landmarks beside the triangle that have to be where they should be
constexpr std::uint32_t kConfirmationTries = 8;
constexpr double kLooseGate = 1.4;         // in tolerances: a pose of three landmarks is not precise
constexpr std::uint32_t kFailuresMax = 3;  // tries at one place that may fail before it is left alone
constexpr int kRounds = 4;                 // of matching and fitting
constexpr std::uint32_t kMatchesMin = 4;   // three match by construction: only a fourth says anything
constexpr double kRobustScale = 2.0;       // of the robust fit, in sigmas

/// Pairs of neighbours, the nearest first: (0,1), (0,2), (1,2), (0,3), ...
struct Pair {
  std::uint32_t i;
  std::uint32_t j;
};
template <std::uint32_t N>
constexpr std::array<Pair, N*(N - 1) / 2> pairs_by_rank() {
  std::array<Pair, N*(N - 1) / 2> pairs{};
  std::size_t count = 0;
  for (std::uint32_t sum = 1; sum < 2 * N; ++sum) {
    for (std::uint32_t i = 0; i < N && 2 * i < sum; ++i) {
      if (sum - i < N) {
        pairs[count++] = {i, sum - i};
      }
    }
  }
  return pairs;
}

double cross(const Point2& a, const Point2& b) noexcept {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

FastSearch::FastSearch(Arena& arena, const AssociationConfig& config, const Capacities&) noexcept
    : config_(config), tried_(arena, "association: poses tried", 8'192) {
  SLAMSENSOR_ASSERT(tried_.try_resize(tried_.capacity()));
}

void FastSearch::search(std::span<const Point2> scan, const LandmarkIndex& index,
                        std::span<const Point2> positions, MapSlot except, const MatchModel& model,
                        const Deadline& deadline, Candidates& found) noexcept {
  scan_ = scan;
  index_ = &index;
  positions_ = positions;
  except_ = except;
  model_ = model;
  deadline_ = deadline;
  moments_ = ScanMoments(scan);
  middle_ = Point2::Zero();
  for (const Point2& p : scan) {
    middle_ += p / static_cast<double>(scan.size());
  }
  work_ = looked_at_ = 0;
  ++round_;
  found.list.clear();
  found.poses_tried = found.vertices_searched = found.vertices_total = found.neighbours_dropped = 0;
  found.end = deadline.expired() ? SearchEnd::Deadline : SearchEnd::Complete;
  if (scan.size() < 3 || index.size() < 3 || found.end == SearchEnd::Deadline) {
    return;
  }
  find_neighbourhoods();
  static constexpr auto kPairs = pairs_by_rank<kNeighbours>();
  found.vertices_total = kPairs.size() * scan.size();
  for (const Pair& pair : kPairs) {
    for (std::uint32_t apex = 0; apex < scan.size(); ++apex) {
      if (pair.j < neighbourhoods_[apex].size() && try_pair(apex, pair.i, pair.j, found)) {
        return;
      }
    }
  }
}

/// The nearest neighbours of each landmark of the scan that are not too near.
void FastSearch::find_neighbourhoods() noexcept {
  const auto side_min_m = static_cast<float>(index_->side_min_m());
  for (std::uint32_t i = 0; i < scan_.size(); ++i) {
    Neighbourhood& list = neighbourhoods_[i];
    list.clear();
    for (std::uint32_t j = 0; j < scan_.size(); ++j) {
      const auto distance_m = static_cast<float>((scan_[i] - scan_[j]).norm());
      if (i == j || distance_m < side_min_m ||
          (list.size() == kNeighbours && distance_m >= list.back().distance_m)) {
        continue;
      }
      if (list.size() < kNeighbours) {
        SLAMSENSOR_ASSERT(list.try_push_back({j, distance_m}));
      }
      std::size_t place = list.size() - 1;
      for (; place > 0 && list[place - 1].distance_m > distance_m; --place) {
        list[place] = list[place - 1];
      }
      list[place] = {j, distance_m};
    }
  }
}

/// Tries the triangle of a landmark with two of its neighbours, if its own corner may be the one opposite the
/// longest side. True when the search is over.
bool FastSearch::try_pair(std::uint32_t apex, std::uint32_t i, std::uint32_t j, Candidates& found) noexcept {
  const Neighbour& p = neighbourhoods_[apex][i];
  const Neighbour& q = neighbourhoods_[apex][j];
  const auto window_m = static_cast<float>(config_.tolerance_m);
  const Point2 to_p = scan_[p.index] - scan_[apex];
  const Point2 to_q = scan_[q.index] - scan_[apex];
  const auto longest_m = static_cast<float>((to_p - to_q).norm());
  if (longest_m + window_m < q.distance_m || longest_m < static_cast<float>(index_->side_min_m())) {
    return false;
  }
  ++found.vertices_searched;
  using Turn = LandmarkIndex::Turn;
  const double area = cross(to_q, to_p);  // the neighbour that is farther comes second
  // Moving the corners by a tolerance can turn a flat triangle over.
  const bool is_flat = std::abs(area) < 2.0 * config_.tolerance_m * static_cast<double>(longest_m);
  const Turn turn = is_flat ? Turn::Either : (area > 0.0 ? Turn::CounterClockwise : Turn::Clockwise);
  query(apex, q.index, p.index, turn, found);
  if (q.distance_m - p.distance_m < window_m) {  // in the map the other one may be farther
    const Turn other = is_flat ? Turn::Either : (area > 0.0 ? Turn::Clockwise : Turn::CounterClockwise);
    query(apex, p.index, q.index, other, found);
  }
  return is_over(found);
}

bool FastSearch::is_over(Candidates& found) noexcept {
  if (found.end == SearchEnd::Deadline) {
    return true;
  }
  if (work_ - looked_at_ >= kWorkPerDeadlineLook) {
    looked_at_ = work_;
    if (deadline_.expired()) {
      found.end = SearchEnd::Deadline;
      return true;
    }
  }
  const bool is_clear = !found.list.empty() && found.list[0].score >= kClearLead;
  if (work_ >= config_.effort_max ||
      (is_clear && work_ >= kWorkEnough && found.vertices_searched >= kTrianglesEnough)) {
    found.end = SearchEnd::Share;
    return true;
  }
  return false;
}

void FastSearch::query(std::uint32_t apex, std::uint32_t second, std::uint32_t third,
                       LandmarkIndex::Turn turn, Candidates& found) noexcept {
  LandmarkIndex::Sides sides;
  sides.longest_m = static_cast<float>((scan_[second] - scan_[third]).norm());
  sides.middle_m = static_cast<float>((scan_[second] - scan_[apex]).norm());
  sides.shortest_m = static_cast<float>((scan_[third] - scan_[apex]).norm());
  const std::uint64_t entries =
      index_->visit_triangles(sides, static_cast<float>(config_.tolerance_m), turn,
                              [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                                if (work_ < config_.effort_max && found.end != SearchEnd::Deadline) {
                                  try_triangle({{apex, second, third}, {a, b, c}}, found);
                                }
                              });
  work_ += kWorkPerQuery + entries * kWorkPerEntry;
}

void FastSearch::try_triangle(const Triangle& triangle, Candidates& found) noexcept {
  work_ += kWorkPerPose / 4;
  const MapSlot map = index_->map_of(triangle.map[0]);
  if (map == except_) {
    return;
  }
  // The pose by least squares over the three corners.
  const Point2 mean_B = (scan_[triangle.scan[0]] + scan_[triangle.scan[1]] + scan_[triangle.scan[2]]) / 3.0;
  const Point2 mean_W =
      (positions_[triangle.map[0]] + positions_[triangle.map[1]] + positions_[triangle.map[2]]) / 3.0;
  double dot = 0.0;
  double turned = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Point2 b = scan_[triangle.scan[i]] - mean_B;
    const Point2 w = positions_[triangle.map[i]] - mean_W;
    dot += b.dot(w);
    turned += cross(b, w);
  }
  const RigidMotion move = RigidMotion::from_direction(mean_B, mean_W, dot, turned);
  Tried& tried = tried_at(move, map);
  if (tried.failures >= kFailuresMax) {
    return;
  }
  work_ += kWorkPerPose;
  ++found.poses_tried;
  if (!is_confirmed(move, map, triangle)) {
    ++tried.failures;
    return;
  }
  tried.failures = kFailuresMax;
  refine(move.pose(), map, triangle, found);
  if (work_ - looked_at_ >= kWorkPerDeadlineLook) {
    looked_at_ = work_;
    found.end = deadline_.expired() ? SearchEnd::Deadline : found.end;
  }
}

/// Whether enough of the landmarks about the triangle are where the pose says.
bool FastSearch::is_confirmed(const RigidMotion& move, MapSlot map, const Triangle& triangle) const noexcept {
  const double gate_m = kLooseGate * config_.tolerance_m;
  const auto others = static_cast<std::uint32_t>(scan_.size()) - 3U;
  const std::uint32_t wanted = std::min(kConfirmations, others);
  std::uint32_t hits = 0;
  std::uint32_t tries = 0;
  for (const std::uint32_t corner : triangle.scan) {
    for (const Neighbour& n : neighbourhoods_[corner]) {
      if (n.index == triangle.scan[0] || n.index == triangle.scan[1] || n.index == triangle.scan[2]) {
        continue;
      }
      double distance2 = 0.0;
      hits += index_->nearest_within(map, move(scan_[n.index]), gate_m, distance2) != LandmarkIndex::kNone
                  ? 1U
                  : 0U;
      if (hits >= wanted) {
        return true;
      }
      if (++tries >= kConfirmationTries || (tries == 5 && hits == 0)) {
        return hits >= wanted;
      }
    }
  }
  return hits >= wanted;
}

/// One-to-one matches under `pose` within the gate; of two that claim a landmark the nearer one has it.
/// Returns the sum of squared distances.
double FastSearch::match(const Pose2& pose, MapSlot map, double gate_m, MatchList& matches) noexcept {
  const std::size_t mask = claimed_slot_.size() - 1;
  ++claim_round_;
  const RigidMotion move(pose);
  matches.clear();
  std::array<double, kScanLandmarksMax> distance2;  // NOLINT: of each match; written before it is read
  double sum = 0.0;
  for (std::uint32_t i = 0; i < scan_.size(); ++i) {
    double d2 = 0.0;
    const std::uint32_t slot = index_->nearest_within(map, move(scan_[i]), gate_m, d2);
    if (slot == LandmarkIndex::kNone) {
      continue;
    }
    std::size_t h = (slot * 2'654'435'761U) & mask;
    while (claimed_round_[h] == claim_round_ && claimed_slot_[h] != slot) {
      h = (h + 1) & mask;
    }
    if (claimed_round_[h] == claim_round_) {
      const std::uint32_t m = claimed_match_[h];
      if (d2 < distance2[m]) {
        sum += d2 - distance2[m];
        matches[m] = {i, slot};
        distance2[m] = d2;
      }
      continue;
    }
    claimed_round_[h] = claim_round_;
    claimed_slot_[h] = slot;
    claimed_match_[h] = static_cast<std::uint32_t>(matches.size());
    distance2[matches.size()] = d2;
    SLAMSENSOR_ASSERT(matches.try_push_back({i, slot}));
    sum += d2;
  }
  work_ += kWorkPerMatch * scan_.size();
  return sum;
}

void FastSearch::refine(const Pose2& pose, MapSlot map, const Triangle& triangle,
                        Candidates& found) noexcept {
  Candidate candidate;
  candidate.map = map;
  candidate.pose_W = pose;
  candidate.triangle = triangle.map;
  const double tight_m = std::max(config_.tolerance_m, 3.0 * model_.sigma_m);
  std::size_t before = 0;
  for (int round = 0; round < kRounds; ++round) {
    const double gate_m = round == 0 ? std::max(tight_m, kLooseGate * config_.tolerance_m) : tight_m;
    candidate.residual_m2 = match(candidate.pose_W, map, gate_m, candidate.matches);
    if (candidate.matches.size() < kMatchesMin) {
      return;
    }
    if (round > 1 && candidate.matches.size() == before) {
      break;
    }
    before = candidate.matches.size();
    candidate.pose_W = fit_pose_robust(candidate.pose_W, candidate.matches.span(), scan_, positions_,
                                       round == 0 ? gate_m : kRobustScale * model_.sigma_m);
  }
  const double per_match = std::log(
      model_.detection / (2.0 * std::numbers::pi * model_.sigma_m * model_.sigma_m * model_.density_per_m2));
  candidate.residual_m2 = match(candidate.pose_W, map, tight_m, candidate.matches);
  candidate.score = per_match * (static_cast<double>(candidate.matches.size()) - 1.5) -
                    candidate.residual_m2 / (2.0 * model_.sigma_m * model_.sigma_m);
  if (candidate.matches.size() >= kMatchesMin) {
    tried_at(RigidMotion(candidate.pose_W), map).failures = kFailuresMax;
    offer(candidate, found);
  }
}

FastSearch::Tried& FastSearch::tried_at(const RigidMotion& move, MapSlot map) noexcept {
  constexpr double kTurnCells = 16.0;  // per unit of sine and cosine: about 4 degrees
  const Point2 place = move(middle_) / std::max(0.5, config_.tolerance_m);
  const auto cell = [](double v) {
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(v)));
  };
  const std::uint32_t x = cell(place.x());
  const std::uint32_t y = cell(place.y());
  const std::uint32_t turn = cell(move.cosine() * kTurnCells) * 64U + cell(move.sine() * kTurnCells);
  std::uint32_t key = x * 73'856'093U ^ y * 19'349'663U ^ turn * 83'492'791U ^ map * 2'654'435'761U;
  key ^= key >> 15U;
  Tried& tried = tried_[key & (tried_.size() - 1)];
  if (tried.round != round_ || tried.key != key) {
    tried = {key, round_, 0};
  }
  return tried;
}

/// Keeps the best candidate of each place, by rank.
void FastSearch::offer(const Candidate& candidate, Candidates& found) const noexcept {
  const auto is_same = [&](const Candidate& other) {
    return other.map == candidate.map &&
           moments_.displacement_m(other.pose_W, candidate.pose_W) <= config_.tolerance_m;
  };
  if (std::any_of(found.list.begin(), found.list.end(),
                  [&](const Candidate& other) { return other.score >= candidate.score && is_same(other); })) {
    return;
  }
  const auto* const kept = std::remove_if(found.list.begin(), found.list.end(), is_same);
  found.list.truncate(static_cast<std::size_t>(kept - found.list.begin()));
  if (found.list.size() == kCandidatesMax) {
    if (found.list.back().score >= candidate.score) {
      return;
    }
    found.list.truncate(kCandidatesMax - 1);
  }
  SLAMSENSOR_ASSERT(found.list.try_push_back(candidate));
  for (std::size_t i = found.list.size() - 1; i > 0 && found.list[i - 1].score < found.list[i].score; --i) {
    std::swap(found.list[i - 1], found.list[i]);
  }
}

}  // namespace slamsensor::core
