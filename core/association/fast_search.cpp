#include "core/association/fast_search.hpp"

#include "core/association/rigid_fit.hpp"

#include <algorithm>
#include <cmath>

namespace slamsensor::core {
namespace {

// Costs in about nanoseconds, to know when to look at the clock and when enough has been done.
constexpr std::uint64_t kWorkPerEntry = 2;
constexpr std::uint64_t kWorkPerQuery = 200;
constexpr std::uint64_t kWorkPerStar = 20;
constexpr std::uint64_t kWorkPerLookUp = 40;
constexpr std::uint64_t kWorkPerMatch = 120;  // per landmark of the scan and round
constexpr std::uint64_t kWorkPerDeadlineLook = 50'000;

// With a clear leader a rival elsewhere would have shown by now: it shares a fifth of the leader's triangles
// or more, so that each of these tries has that chance to meet it.
constexpr std::uint64_t kTrianglesEnough = 24;
constexpr std::uint64_t kTrianglesContested = 160;
constexpr double kContestedShare = 0.5;
constexpr double kExplainedShare = 0.55;  // of the scan, by a leader that nobody contests
constexpr std::uint64_t kWorkEnough = 30'000;
constexpr double kLead = 20.0;         // nats of a leader ...
constexpr double kLeadMargin = 12.0;   // ... and above what chance reaches
constexpr double kChanceMargin = 5.0;  // nats below what chance reaches, from which on candidates are kept

constexpr std::uint32_t kWitnesses = 2;  // neighbours of a triangle that the scan has to show, too
constexpr std::uint32_t kConfirmationTries = 8;
constexpr std::uint32_t kPlannedNeighbours = 5;  // of a landmark: its triangles that are tried by their price
constexpr std::uint32_t kEntriesPerQuery = 4;    // that cost as much as a query does anyway, by bucket
constexpr float kPricePerRank = 0.5F;            // farther neighbours are less likely linked in the map
constexpr double kWindowSigmas = 1.6;      // of a side: most of what is right at a third of the cost of all
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
  per_match_ = std::log(model_.detection /
                        (2.0 * std::numbers::pi * model_.sigma_m * model_.sigma_m * model_.density_per_m2));
  // About the area that the maps cover, times the headings.
  chance_ = std::log(2.0 * std::numbers::pi * static_cast<double>(index.size() + 1) / model_.density_per_m2);
  worth_ = 0.0;
  work_ = looked_at_ = 0;
  ++round_;
  found.list.clear();
  found.poses_tried = found.vertices_searched = found.vertices_total = found.neighbours_dropped = 0;
  found.end = deadline.expired() ? SearchEnd::Deadline : SearchEnd::Complete;
  if (scan.size() < 3 || index.size() < 3 || found.end == SearchEnd::Deadline) {
    return;
  }
  has_neighbourhood_.fill(false);
  mask_.draw(scan, kLooseGate * config_.tolerance_m);
  witnesses_ = kWitnesses;
  window_m_ = std::min(config_.tolerance_m, kWindowSigmas * std::numbers::sqrt2 * model_.sigma_m);
  bool is_done = false;
  if (!model_.is_thorough) {
    plan_all();
    is_done = try_plans(found);
  }
  if (!is_done &&
      !model_.is_thorough) {  // a poor scan, a place that is not in the map, or a world that repeats itself
    witnesses_ = 1;
    window_m_ = config_.tolerance_m;
    is_done = try_plans(found);
  }
  if (!is_done) {
    witnesses_ = 0;
    window_m_ = config_.tolerance_m;
    static_cast<void>(try_all(found));
  }
  while (found.list.size() > 1 && found.list.back().score < chance_ - kChanceMargin) {
    found.list.truncate(found.list.size() - 1);
  }
}

bool FastSearch::has_lead(const Candidates& found) const noexcept {
  return !model_.is_thorough && !found.list.empty() &&
         found.list[0].score >= std::max(kLead, chance_ + kLeadMargin);
}

/// Whether the leader leaves much of the scan unexplained, or another place comes near it, and not by chance:
/// the world repeats itself, and what leads
/// now need not lead in the end.
bool FastSearch::is_contested(const Candidates& found) const noexcept {
  if (found.list.empty()) {
    return false;
  }
  const Candidate& leader = found.list[0];
  return static_cast<double>(leader.matches.size()) < kExplainedShare * static_cast<double>(scan_.size()) ||
         (found.list.size() > 1 && found.list[1].score > std::max(chance_, kContestedShare * leader.score));
}

/// Lists the triangles of near neighbours, those first that are most likely in the index for their price.
void FastSearch::plan_all() noexcept {
  static constexpr auto kPairs = pairs_by_rank<kPlannedNeighbours>();
  plans_.clear();
  const auto apexes =
      std::min<std::uint32_t>(static_cast<std::uint32_t>(scan_.size()), kPlansMax / kPairs.size());
  for (std::uint32_t apex = 0; apex < apexes; ++apex) {
    find_neighbourhood(apex);
    for (const Pair& pair : kPairs) {
      if (pair.j >= neighbourhoods_[apex].size()) {
        continue;
      }
      if (const auto planned = plan(apex, pair.i, pair.j)) {
        SLAMSENSOR_ASSERT(plans_.try_push_back(*planned));
      }
    }
  }
  std::sort(plans_.begin(), plans_.end(), [](const Plan& a, const Plan& b) { return a.cost < b.cost; });
}

/// True when the search is over.
bool FastSearch::try_plans(Candidates& found) noexcept {
  for (const Plan& planned : plans_) {
    if (try_pair(planned.apex, planned.i, planned.j, found)) {
      return true;
    }
  }
  return has_lead(found) && !is_contested(found);
}

/// None when the landmark's corner is not the one opposite the longest side.
std::optional<FastSearch::Plan> FastSearch::plan(std::uint32_t apex, std::uint32_t i,
                                                 std::uint32_t j) const noexcept {
  const Neighbour& p = neighbourhoods_[apex][i];
  const Neighbour& q = neighbourhoods_[apex][j];
  const Point2 to_p = scan_[p.index] - scan_[apex];
  const Point2 to_q = scan_[q.index] - scan_[apex];
  const auto longest_m = static_cast<float>((to_p - to_q).norm());
  if (longest_m < q.distance_m) {
    return std::nullopt;
  }
  const double area = cross(to_q, to_p);
  const bool is_flat = std::abs(area) < 2.0 * config_.tolerance_m * static_cast<double>(longest_m);
  const bool is_even = q.distance_m - p.distance_m < static_cast<float>(window_m_);
  const std::uint32_t entries = index_->bucket_entries({longest_m, q.distance_m, p.distance_m}, area > 0.0);
  const float cost = static_cast<float>(entries + kEntriesPerQuery) * (is_flat ? 2.0F : 1.0F) *
                     (is_even ? 2.0F : 1.0F) * (1.0F + kPricePerRank * static_cast<float>(i + j - 1));
  return Plan{cost, static_cast<std::uint8_t>(apex), static_cast<std::uint8_t>(i),
              static_cast<std::uint8_t>(j)};
}

/// Tries all triangles, about each landmark in turn. True when the search is over.
bool FastSearch::try_all(Candidates& found) noexcept {
  static constexpr auto kPairs = pairs_by_rank<kNeighbours>();
  found.vertices_total = kPairs.size() * scan_.size();
  for (const Pair& pair : kPairs) {
    for (std::uint32_t apex = 0; apex < scan_.size(); ++apex) {
      find_neighbourhood(apex);
      if (pair.j < neighbourhoods_[apex].size() && try_pair(apex, pair.i, pair.j, found)) {
        return true;
      }
    }
  }
  return has_lead(found);
}

/// The nearest neighbours of a landmark of the scan that are not too near.
void FastSearch::find_neighbourhood(std::uint32_t apex) noexcept {
  if (has_neighbourhood_[apex]) {
    return;
  }
  has_neighbourhood_[apex] = true;
  Neighbourhood& list = neighbourhoods_[apex];
  list.clear();
  const auto side_min2 = static_cast<float>(index_->side_min_m() * index_->side_min_m());
  for (std::uint32_t j = 0; j < scan_.size(); ++j) {
    const auto distance2 = static_cast<float>((scan_[apex] - scan_[j]).squaredNorm());
    if (distance2 < side_min2 || (list.size() == kNeighbours && distance2 >= list.back().distance_m)) {
      continue;
    }
    if (list.size() < kNeighbours) {
      SLAMSENSOR_ASSERT(list.try_push_back({j, distance2}));
    }
    std::size_t place = list.size() - 1;
    for (; place > 0 && list[place - 1].distance_m > distance2; --place) {
      list[place] = list[place - 1];
    }
    list[place] = {j, distance2};
  }
  for (Neighbour& neighbour : list) {
    neighbour.distance_m = std::sqrt(neighbour.distance_m);
  }
}

/// Tries the triangle of a landmark with two of its neighbours, if its own corner may be the one opposite the
/// longest side. True when the search is over.
bool FastSearch::try_pair(std::uint32_t apex, std::uint32_t i, std::uint32_t j, Candidates& found) noexcept {
  const Neighbour& p = neighbourhoods_[apex][i];
  const Neighbour& q = neighbourhoods_[apex][j];
  const auto window_m = static_cast<float>(window_m_);
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

bool FastSearch::is_late(Candidates& found) noexcept {
  if (work_ - looked_at_ >= kWorkPerDeadlineLook) {
    looked_at_ = work_;
    if (deadline_.expired()) {
      found.end = SearchEnd::Deadline;
    }
  }
  return found.end == SearchEnd::Deadline;
}

bool FastSearch::is_over(Candidates& found) noexcept {
  if (is_late(found)) {
    return true;
  }
  const std::uint64_t enough = is_contested(found) ? kTrianglesContested : kTrianglesEnough;
  if (has_lead(found) && work_ >= kWorkEnough && found.vertices_searched >= enough) {
    found.end = SearchEnd::Share;
    return true;
  }
  if (work_ >= config_.effort_max) {
    found.end = SearchEnd::Deadline;  // cut: what was not looked at may be better
    return true;
  }
  return false;
}

void FastSearch::query(std::uint32_t apex, std::uint32_t second, std::uint32_t third,
                       LandmarkIndex::Turn turn, Candidates& found) noexcept {
  const Point2 to_second = scan_[second] - scan_[apex];
  const Point2 to_third = scan_[third] - scan_[apex];
  LandmarkIndex::Sides sides;
  sides.longest_m = static_cast<float>((to_second - to_third).norm());
  sides.middle_m = static_cast<float>(to_second.norm());
  sides.shortest_m = static_cast<float>(to_third.norm());
  const auto window_m = static_cast<float>(window_m_);
  const auto low2 = [&](float side_m) {
    const float low_m = std::max(0.0F, side_m - window_m);
    return low_m * low_m;
  };
  const auto high2 = [&](float side_m) { return (side_m + window_m) * (side_m + window_m); };
  const Wanted wanted{{apex, second, third},
                      static_cast<float>(scan_[apex].x()),
                      static_cast<float>(scan_[apex].y()),
                      static_cast<float>(to_second.x()),
                      static_cast<float>(to_second.y()),
                      static_cast<float>(to_third.x()),
                      static_cast<float>(to_third.y()),
                      {low2(sides.middle_m), low2(sides.shortest_m), low2(sides.longest_m)},
                      {high2(sides.middle_m), high2(sides.shortest_m), high2(sides.longest_m)}};
  work_ += kWorkPerQuery;
  Turned turned;  // NOLINT: written before it is read
  index_->visit_triangles(
      sides, window_m, turn,
      [&](std::uint32_t slot, LandmarkIndex::Pair pair) {
        work_ += kWorkPerStar;
        if (is_witnessed(wanted, index_->star(slot), pair, turned)) {
          try_pose(wanted, turned, slot, found);
        }
      },
      [&](std::uint32_t entries) {
        work_ += entries * kWorkPerEntry;
        return work_ < config_.effort_max && !is_late(found);
      });
}

/// Whether the scan shows enough of the neighbours that the star has beside the triangle where the triangle
/// says that they are.
bool FastSearch::is_witnessed(const Wanted& wanted, std::span<const LandmarkIndex::Offset> star,
                              LandmarkIndex::Pair pair, Turned& turned) const noexcept {
  float bx = star[pair.first].x_m();
  float by = star[pair.first].y_m();
  float cx = star[pair.second].x_m();
  float cy = star[pair.second].y_m();
  float b2 = bx * bx + by * by;
  float c2 = cx * cx + cy * cy;
  if (b2 < c2) {
    std::swap(bx, cx);
    std::swap(by, cy);
    std::swap(b2, c2);
  }
  const float a2 = (bx - cx) * (bx - cx) + (by - cy) * (by - cy);
  if (b2 < wanted.low2_m2[0] || b2 > wanted.high2_m2[0] || c2 < wanted.low2_m2[1] ||
      c2 > wanted.high2_m2[1] || a2 < wanted.low2_m2[2] || a2 > wanted.high2_m2[2]) {
    return false;  // its bucket is shared with other sides
  }
  constexpr float kThird = 1.0F / 3.0F;
  turned.middle_map_x_m = (bx + cx) * kThird;
  turned.middle_map_y_m = (by + cy) * kThird;
  turned.middle_scan_x_m = (wanted.second_x_m + wanted.third_x_m) * kThird;
  turned.middle_scan_y_m = (wanted.second_y_m + wanted.third_y_m) * kThird;
  const float dot =
      wanted.second_x_m * bx + wanted.second_y_m * by + wanted.third_x_m * cx + wanted.third_y_m * cy -
      3.0F *
          (turned.middle_scan_x_m * turned.middle_map_x_m + turned.middle_scan_y_m * turned.middle_map_y_m);
  const float across =
      wanted.second_x_m * by - wanted.second_y_m * bx + wanted.third_x_m * cy - wanted.third_y_m * cx -
      3.0F *
          (turned.middle_scan_x_m * turned.middle_map_y_m - turned.middle_scan_y_m * turned.middle_map_x_m);
  const float scale = 1.0F / std::sqrt(std::max(dot * dot + across * across, 1e-12F));
  turned.cosine = dot * scale;
  turned.sine = across * scale;
  const float base_x = wanted.apex_x_m + turned.middle_scan_x_m;
  const float base_y = wanted.apex_y_m + turned.middle_scan_y_m;
  if (witnesses_ == 0) {
    return true;
  }
  std::uint32_t left = 0;
  std::uint32_t seen = 0;
  for (std::uint32_t ray = 0; ray < star.size(); ++ray) {
    if (ray == pair.first || ray == pair.second || !star[ray].is_some()) {
      continue;
    }
    const float dx = star[ray].x_m() - turned.middle_map_x_m;
    const float dy = star[ray].y_m() - turned.middle_map_y_m;
    ++left;
    seen += mask_.has(base_x + turned.cosine * dx + turned.sine * dy,
                      base_y - turned.sine * dx + turned.cosine * dy)
                ? 1U
                : 0U;
  }
  return seen >= std::min(witnesses_, left);
}

void FastSearch::try_pose(const Wanted& wanted, const Turned& turned, std::uint32_t apex,
                          Candidates& found) noexcept {
  const MapSlot map = index_->map_of(apex);
  if (map == except_) {
    return;
  }
  const Point2 middle_B = scan_[wanted.scan[0]] + Point2(static_cast<double>(turned.middle_scan_x_m),
                                                         static_cast<double>(turned.middle_scan_y_m));
  const Point2 middle_W = index_->place(apex) + Point2(static_cast<double>(turned.middle_map_x_m),
                                                       static_cast<double>(turned.middle_map_y_m));
  const RigidMotion move = RigidMotion::from_direction(middle_B, middle_W, static_cast<double>(turned.cosine),
                                                       static_cast<double>(turned.sine));
  ++found.poses_tried;
  if (witnesses_ == 0 && !is_confirmed(move, map, wanted)) {
    return;
  }
  Tried& tried = tried_at(move, map);
  if (tried.failures >= kFailuresMax) {
    return;
  }
  // So many matches are worth something even if all lie where they should.
  const auto enough = std::max<std::uint32_t>(
      kMatchesMin, static_cast<std::uint32_t>(std::ceil(std::max(0.0, worth_) / per_match_ + 1.5)));
  if (count(move, map, enough) < enough) {
    ++tried.failures;
    return;
  }
  tried.failures = kFailuresMax;
  refine(move.pose(), map, wanted, found);
}

/// Whether enough of the landmarks of the scan about the triangle are in the map where the pose says.
bool FastSearch::is_confirmed(const RigidMotion& move, MapSlot map, const Wanted& wanted) noexcept {
  const double gate_m = kLooseGate * config_.tolerance_m;
  const std::uint32_t enough = std::min(kWitnesses, static_cast<std::uint32_t>(scan_.size()) - 3U);
  std::uint32_t hits = 0;
  std::uint32_t tries = 0;
  for (const std::uint32_t corner : wanted.scan) {
    find_neighbourhood(corner);
    for (const Neighbour& n : neighbourhoods_[corner]) {
      if (n.index == wanted.scan[0] || n.index == wanted.scan[1] || n.index == wanted.scan[2]) {
        continue;
      }
      double distance2 = 0.0;
      work_ += kWorkPerLookUp;
      hits += index_->nearest_within(map, move(scan_[n.index]), gate_m, distance2) != LandmarkIndex::kNone
                  ? 1U
                  : 0U;
      if (hits >= enough || ++tries >= kConfirmationTries || (tries == 5 && hits == 0)) {
        return hits >= enough;
      }
    }
  }
  return hits >= enough;
}

/// The landmarks of the scan that have one of the map near under `move`; fewer than `enough` as soon as
/// `enough` is out of reach.
std::uint32_t FastSearch::count(const RigidMotion& move, MapSlot map, std::uint32_t enough) noexcept {
  const double gate_m = kLooseGate * config_.tolerance_m;
  auto left = static_cast<std::uint32_t>(scan_.size());
  std::uint32_t seen = 0;
  double distance2 = 0.0;
  for (const Point2& p : scan_) {
    work_ += kWorkPerLookUp;
    seen += index_->nearest_within(map, move(p), gate_m, distance2) != LandmarkIndex::kNone ? 1U : 0U;
    --left;
    if (seen >= enough || seen + left < enough) {
      break;
    }
  }
  return seen;
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

double FastSearch::score(std::size_t matches, double residual_m2) const noexcept {
  return per_match_ * (static_cast<double>(matches) - 1.5) -
         residual_m2 / (2.0 * model_.sigma_m * model_.sigma_m);
}

void FastSearch::refine(const Pose2& pose, MapSlot map, const Wanted& wanted, Candidates& found) noexcept {
  Candidate candidate;
  candidate.map = map;
  candidate.pose_W = pose;
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
  candidate.residual_m2 = match(candidate.pose_W, map, tight_m, candidate.matches);
  candidate.score = score(candidate.matches.size(), candidate.residual_m2);
  if (candidate.matches.size() >= kMatchesMin) {
    tried_at(RigidMotion(candidate.pose_W), map).failures = kFailuresMax;
    candidate.name_triangle(wanted.scan);
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

/// Keeps the best candidate of each place, by rank. Most places are too far apart for a closer look.
void FastSearch::offer(const Candidate& candidate, Candidates& found) noexcept {
  const double apart_m = config_.tolerance_m + 2.0 * middle_.norm();
  const auto is_same = [&](const Candidate& other) {
    return other.map == candidate.map &&
           (other.pose_W.translation() - candidate.pose_W.translation()).norm() <= apart_m &&
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
  if (found.list.size() == kCandidatesMax) {
    worth_ = found.list.back().score;
  }
}

}  // namespace slamsensor::core
