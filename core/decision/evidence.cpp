#include "core/decision/evidence.hpp"

#include "core/association/rigid_fit.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamsensor::core {
namespace {

constexpr double kGateSigmas = 3.7;  // beyond, a match explains less than no match
constexpr int kRounds = 4;
// Matches that lie wider than the learned spread open the gate by this share at most, while nothing was
// learned yet, and less with experience: so many axes halve it.
constexpr double kWider = 0.6;
constexpr double kWiderAxes = 40.0;
constexpr double kSigmaPrior = 12.0;  // axes that the learned spread counts as
// Pseudo-observations of the beta distributions: few while nothing is known of this world, more with
// experience.
constexpr double kContradictionPrior = 4.0;
constexpr double kContradictionLearned = 0.1;  // per observation ...
constexpr double kContradictionMost = 25.0;    // ... up to so many in all
constexpr double kHalfWidth_m = 0.3;           // of what stands in the way
constexpr std::size_t kAboutBins = 2;  // bearing bins on either side of a landmark that it shows as looked at
// The size of what may come in copies where nothing is set: a copse, a bicycle stand, a parking bay. In a
// complete survey copies are all known, and what is left is chance: this share of the mean spacing.
constexpr double kCopy_m = 15.0;
constexpr double kCopyShare = 0.8;
constexpr double kCopyReach = 0.75;  // of a sensor of short reach: the size of a copy as a share of it
constexpr double kGroupCap = std::numbers::ln10;  // a group is worth one decade at most
constexpr double kShownPrior = 20.0;  // pseudo-observations of the share of a survey that a scan shows
constexpr double kConfirmedClutter =
    0.05;  // share of the confirmed landmarks that another map may lack at least ...
constexpr double kConfirmedShare = 0.5;  // ... or this share of what a scan's landmarks may
constexpr double kLookedAt = 0.5;        // explored this much, ground counts as explored
constexpr std::uint32_t kSizesMin = 6;   // witnesses with a size that show how sizes differ here
constexpr double kSizeWrong = 0.1;       // share of sizes that were not measured of the landmark alone ...
constexpr double kSizeMost = 20.0;       // ... and the most that one size can say for a match
constexpr double kSizeSigmas = 2.0;      // beyond, a match has an odd size
constexpr double kSizeOdd = 0.15;        // share of odd sizes at the right pose ...
constexpr double kSizeOddUsual = 0.43;  // ... and the decades that their chance is away from 1 on the average

/// ln Gamma for x >= 0.5 (Stirling with two terms after shifting up; error below 1e-7).
double ln_gamma(double x) noexcept {
  double shift = 0.0;
  while (x < 8.0) {
    shift -= std::log(x);
    x += 1.0;
  }
  const double inverse = 1.0 / x;
  return shift + (x - 0.5) * std::log(x) - x + 0.5 * std::log(2.0 * std::numbers::pi) + inverse / 12.0 -
         inverse * inverse * inverse / 360.0;
}

double ln_beta(double a, double b) noexcept {
  return ln_gamma(a) + ln_gamma(b) - ln_gamma(a + b);
}

/// A witness' spread is one part of a match's variance, the landmark's own the other.
double variance_share(const Standing& standing, double sigma_share) noexcept {
  return sigma_share * sigma_share + 1.0 / static_cast<double>(std::max(1U, standing.sightings));
}

/// How firmly the learned shares are believed.
double experience(double observations) noexcept {
  return std::min(kContradictionMost, kContradictionPrior + kContradictionLearned * observations);
}

std::size_t bearing_bin_of(const Point2& p_L) noexcept {
  return Rates::bearing_bin(std::atan2(p_L.y(), p_L.x()));
}

using BearingBins = std::array<bool, Rates::kBearingBins>;

/// Without a field of view the sensor looks where it has ever seen a landmark; while nothing was learned, in
/// a survey or a map from a file, about the landmarks of this scan.
BearingBins seen_bearings(const Rates& rates, const Witnesses& witnesses) noexcept {
  BearingBins bins{};
  for (std::size_t bin = 0; bin < Rates::kBearingBins; ++bin) {
    bins[bin] = rates.bearings[bin] > 0.0F;
  }
  if (std::find(bins.begin(), bins.end(), true) != bins.end()) {
    return bins;
  }
  for (const Point2& point_B : witnesses.points_B) {
    const std::size_t bin = bearing_bin_of(witnesses.T_L_B * point_B);
    for (std::size_t step = 0; step <= 2 * kAboutBins; ++step) {
      bins[(bin + Rates::kBearingBins - kAboutBins + step) % Rates::kBearingBins] = true;
    }
  }
  return bins;
}

/// Chance that a map which looked `looks` times at a landmark has confirmed it: that two looks showed it.
double chance_of_two(double once, double looks) noexcept {
  const double none = std::pow(1.0 - once, looks);
  const double one = looks * once * none / (1.0 - once);
  return std::clamp((1.0 - kConfirmedClutter) * (1.0 - none - one), 0.02, 0.97);
}

}  // namespace

struct EvidenceScale::Scene {
  const Witnesses& witnesses;
  const Maps& maps;
  double reach_m = 0.0;  // the farthest witness
  double area_m2 = 0.0;  // of the witnesses' field
  double density_per_m2 = 0.0;
  BearingBins bearings{};  // in which the sensor looks

  [[nodiscard]] bool is_looked_at(const ScanView& view, const Point2& p_L) const noexcept {
    const bool is_known = !view.free_m.empty() || view.field_of_view_rad > 0.0;
    return view.shows(p_L, kHalfWidth_m) && (is_known || bearings[bearing_bin_of(p_L)]);
  }
};

double chance_to_be_shown(const Rates& rates, const Standing& standing, double range_m) noexcept {
  constexpr double kPrior = 3.0;
  const double mean = rates.mean_detection();
  // The first sighting says that there is something, not how often it is seen.
  const auto sightings = static_cast<double>(standing.sightings);
  const double chances = std::max(static_cast<double>(standing.chances), sightings);
  const double start = standing.sightings < 2 ? rates.second_detection() : mean;
  const double own = (sightings - 1.0 + kPrior * start) / (chances - 1.0 + kPrior);
  return std::clamp(own * rates.detection(range_m) / mean, 0.02, 0.97);
}

double log10_beta_binomial_tail(std::uint32_t trials, std::uint32_t hits, double mean,
                                double weight) noexcept {
  if (hits == 0 || trials == 0) {
    return 0.0;
  }
  const double a = std::clamp(mean, 1e-3, 1.0 - 1e-3) * weight;
  const double b = weight - a;
  double ln_term = 0.0;  // of no hit
  for (std::uint32_t i = 0; i < trials; ++i) {
    ln_term += std::log((b + i) / (a + b + i));
  }
  double tail = 0.0;
  double scale = 0.0;
  bool is_first = true;
  for (std::uint32_t k = 0; k <= trials; ++k) {
    if (k >= hits) {
      scale = is_first ? ln_term : scale;
      is_first = false;
      tail += std::exp(ln_term - scale);
    }
    if (k < trials) {
      ln_term += std::log((trials - k) / (k + 1.0) * (k + a) / (trials - k - 1.0 + b));
    }
  }
  return std::min(0.0, (scale + std::log(tail)) / std::numbers::ln10);
}

Evidence EvidenceScale::weigh(const Witnesses& witnesses, const Maps& maps, Candidate& candidate) noexcept {
  Scene scene{witnesses, maps, 0.0, 0.0, 0.0, seen_bearings(maps.rates, witnesses)};
  for (const Point2& p : witnesses.points_B) {
    scene.reach_m = std::max(scene.reach_m, (witnesses.T_L_B * p).norm());
  }
  // The field: as far as the farthest witness, over the bearings that the sensor looks at.
  const double angle_rad = witnesses.view != nullptr && witnesses.view->field_of_view_rad > 0.0
                               ? witnesses.view->field_of_view_rad
                               : 2.0 * std::numbers::pi;
  scene.area_m2 = std::max(1.0, 0.5 * angle_rad * scene.reach_m * scene.reach_m);
  scene.density_per_m2 = static_cast<double>(witnesses.points_B.size()) / scene.area_m2;
  Evidence evidence;
  const double learned_m = maps.rates.sigma_m(start_sigma_m());
  const double widest_m = learned_m * (1.0 + kWider * kWiderAxes / (kWiderAxes + maps.rates.spread_count));
  double sigma_m = learned_m;
  for (int round = 0; round < kRounds; ++round) {
    const std::size_t before = candidate.matches.size();
    match(scene, kGateSigmas * sigma_m, candidate);
    if (candidate.matches.size() < 3) {
      return evidence;
    }
    fit(scene, sigma_m, candidate);
    sigma_m = std::clamp(spread_of(scene, candidate, learned_m), learned_m, widest_m);
    if (round > 0 && candidate.matches.size() == before) {
      break;
    }
  }
  weigh_matches(scene, candidate, evidence);
  weigh_unmatched(scene, candidate, evidence);
  weigh_missing(scene, candidate, evidence);
  weigh_sizes(scene, candidate, evidence);
  double copy_m = acceptance_.copy_size_m;
  if (copy_m <= 0.0) {
    copy_m = witnesses.is_surveyed ? kCopyShare * std::sqrt(1.0 / scene.density_per_m2) : kCopy_m;
  }
  evidence.group_decades = group_decades(scene, candidate, copy_m);
  const bool is_short = acceptance_.copy_size_m <= 0.0 && witnesses.sensor_reach_m > 0.0 &&
                        kCopyReach * witnesses.sensor_reach_m < copy_m;
  evidence.small_group_decades = is_short
                                     ? group_decades(scene, candidate, kCopyReach * witnesses.sensor_reach_m)
                                     : evidence.group_decades;
  return evidence;
}

void EvidenceScale::match(const Scene& scene, double gate_m, Candidate& candidate) noexcept {
  const RigidMotion move(candidate.pose_W);
  candidate.matches.clear();
  candidate.residual_m2 = 0.0;
  const std::span<const Point2> points = scene.witnesses.points_B;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Point2 seen_W = move(points[i]);
    double d2 = 0.0;
    const std::uint32_t slot = scene.maps.index.nearest_within(candidate.map, seen_W, gate_m, d2);
    if (slot == LandmarkIndex::kNone) {
      continue;
    }
    d2 = (seen_W - scene.maps.positions[slot]).squaredNorm();
    std::size_t m = 0;
    while (m < candidate.matches.size() && candidate.matches[m].map != slot) {
      ++m;
    }
    if (m == candidate.matches.size()) {
      SLAMSENSOR_ASSERT(candidate.matches.try_push_back({i, slot}));
      distance2_[m] = d2;
    } else if (d2 < distance2_[m]) {  // the nearer of two that claim a landmark has it
      candidate.matches[m] = {i, slot};
      distance2_[m] = d2;
    }
  }
  std::sort(candidate.matches.begin(), candidate.matches.end(),
            [](const Match& a, const Match& b) { return a.scan < b.scan; });
}

void EvidenceScale::fit(const Scene& scene, double sigma_m, Candidate& candidate) const noexcept {
  // Well above the spread, so that two sightings that disagree are averaged and not chosen between.
  constexpr double kRobustSigmas = 3.0;
  candidate.pose_W = fit_pose_robust(candidate.pose_W, candidate.matches.span(), scene.witnesses.points_B,
                                     scene.maps.positions, kRobustSigmas * sigma_m);
}

/// 1 sigma of the matches per axis, of the witnesses alone; `learned_m` counts as kSigmaPrior axes.
double EvidenceScale::spread_of(const Scene& scene, const Candidate& candidate, double learned_m) noexcept {
  const RigidMotion move(candidate.pose_W);
  double scaled2 = 0.0;
  for (const Match& match : candidate.matches) {
    scaled2 += (move(scene.witnesses.points_B[match.scan]) - scene.maps.positions[match.map]).squaredNorm() /
               variance_share(scene.maps.standing[match.map], scene.witnesses.sigma_share);
  }
  const double freedom = std::max(0.0, 2.0 * static_cast<double>(candidate.matches.size()) - 3.0);
  return std::sqrt((kSigmaPrior * learned_m * learned_m + scaled2) / (kSigmaPrior + freedom));
}

void EvidenceScale::weigh_matches(const Scene& scene, const Candidate& candidate,
                                  Evidence& evidence) noexcept {
  const Rates& rates = scene.maps.rates;
  const RigidMotion move(candidate.pose_W);
  const double start_m = rates.sigma_m(start_sigma_m());
  ln_density_ = std::log(scene.density_per_m2);
  double scaled2 = 0.0;  // squared residuals over their variance share
  double ln_shares = 0.0;
  double ln_shown = 0.0;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  const auto count = static_cast<double>(candidate.matches.size());
  for (std::size_t m = 0; m < candidate.matches.size(); ++m) {
    const Match& match = candidate.matches[m];
    const Point2 seen_W = move(scene.witnesses.points_B[match.scan]);
    const Standing& standing = scene.maps.standing[match.map];
    const double share = variance_share(standing, scene.witnesses.sigma_share);
    distance2_[m] = (seen_W - scene.maps.positions[match.map]).squaredNorm() / share;
    scaled2 += distance2_[m];
    ln_shares += std::log(share);
    const double range_m = (scene.witnesses.T_L_B * scene.witnesses.points_B[match.scan]).norm();
    nats_[m] = std::log(chance_to_be_shown(rates, standing, range_m)) - ln_density_ - std::log(share);
    ln_shown += nats_[m] + std::log(share);
    const Point2 arm = seen_W - candidate.pose_W.translation();
    Eigen::Matrix<double, 2, 3> J;
    J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    information += J.transpose() * J / share;
  }
  // Sigma integrated out: an inverse gamma prior of kSigmaPrior axes at the learned spread.
  const double freedom = 2.0 * count - 3.0;
  const double alpha = 0.5 * kSigmaPrior;
  const double beta = 0.5 * kSigmaPrior * start_m * start_m;
  const double determinant = std::max(information.determinant(), 1e-9);
  evidence.ln_bayes = ln_shown - ln_shares + ln_gamma(alpha + 0.5 * freedom) - ln_gamma(alpha) +
                      alpha * std::log(beta) - (alpha + 0.5 * freedom) * std::log(beta + 0.5 * scaled2) -
                      0.5 * freedom * std::log(2.0 * std::numbers::pi) - 0.5 * std::log(determinant) -
                      std::log(2.0 * std::numbers::pi * std::max(scene.maps.ground.area_m2(), scene.area_m2));
  const double variance =
      (kSigmaPrior * start_m * start_m + scaled2) / (kSigmaPrior + std::max(0.0, freedom));
  evidence.sigma_m = std::sqrt(variance);
  Eigen::Matrix3d inverse;
  bool is_invertible = false;
  information.computeInverseWithCheck(inverse, is_invertible);
  evidence.covariance = is_invertible ? Eigen::Matrix3d(variance * inverse)
                                      : Eigen::Matrix3d(Eigen::Matrix3d::Identity() * 1e6);
  for (std::size_t m = 0; m < candidate.matches.size(); ++m) {
    nats_[m] -= std::log(2.0 * std::numbers::pi * variance) + 0.5 * distance2_[m] / variance;
  }
}

void EvidenceScale::weigh_unmatched(const Scene& scene, const Candidate& candidate,
                                    Evidence& evidence) const noexcept {
  const RigidMotion move(candidate.pose_W);
  // A landmark that two scans saw is hardly ever nothing.
  const double clutter =
      scene.witnesses.view != nullptr
          ? scene.maps.rates.clutter_share()
          : std::max(kConfirmedClutter, kConfirmedShare * scene.maps.rates.clutter_share());
  double expected = 0.0;
  std::size_t m = 0;
  const std::span<const Point2> points = scene.witnesses.points_B;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const double e = scene.maps.ground.explored(candidate.map, move(points[i]));
    const bool is_matched = m < candidate.matches.size() && candidate.matches[m].scan == i;
    m += is_matched ? 1 : 0;
    expected += e;
    if (!is_matched) {
      evidence.ln_bayes += std::log(1.0 - e + e * clutter);
    }
    if (is_matched || e >= kLookedAt) {
      ++evidence.explored;
      evidence.unmatched += is_matched ? 0 : 1;
    }
  }
  evidence.ln_bayes += (1.0 - clutter) * expected;
  evidence.log10_unmatched = log10_beta_binomial_tail(evidence.explored, evidence.unmatched, clutter,
                                                      experience(scene.maps.rates.clutter_count));
}

void EvidenceScale::weigh_missing(const Scene& scene, const Candidate& candidate,
                                  Evidence& evidence) const noexcept {
  const Pose2 T_B_W = candidate.pose_W.inverse();
  const Witnesses& witnesses = scene.witnesses;
  double expected_missing = 0.0;
  double ln_shown = 0.0;  // of all in view, matched or not, each by its own chance
  scene.maps.index.visit_within(
      candidate.map, candidate.pose_W.translation(), scene.reach_m + 2.0, [&](std::uint32_t slot, double) {
        const Point2 p_B = T_B_W * scene.maps.positions[slot];
        const Point2 p_L = witnesses.T_L_B * p_B;
        const double range_m = p_L.norm();
        double looked = 1.0;
        if (witnesses.view != nullptr) {
          looked = range_m <= scene.reach_m && scene.is_looked_at(*witnesses.view, p_L) ? 1.0 : 0.0;
        } else {
          looked = scene.maps.ground.explored(witnesses.own_map, witnesses.T_own_B * p_B);
        }
        if (looked < kLookedAt) {
          return;
        }
        const Standing& standing = scene.maps.standing[slot];
        const double once = chance_to_be_shown(scene.maps.rates, standing, range_m);
        // A map that looked at the mean landmark with chance `looked` looked at this one as often.
        const double looks =
            std::log1p(-std::min(looked, 0.999)) / std::log1p(-scene.maps.rates.mean_detection());
        const double shown = witnesses.view != nullptr ? once : chance_of_two(once, looks);
        ++evidence.in_view;
        expected_missing += 1.0 - shown;
        const bool is_matched = std::any_of(candidate.matches.begin(), candidate.matches.end(),
                                            [&](const Match& match) { return match.map == slot; });
        ln_shown += is_matched ? std::log(shown) : std::log1p(-shown);
        if (!is_matched) {
          ++evidence.missing;
          evidence.ln_bayes += std::log1p(-shown);
        }
      });
  if (witnesses.is_surveyed) {
    // The share of a survey that a scan shows is not known: it is integrated out.
    const double mean = scene.maps.rates.mean_detection();
    const double a = kShownPrior * mean;
    const double b = kShownPrior - a;
    evidence.ln_bayes +=
        ln_beta(a + evidence.in_view - evidence.missing, b + evidence.missing) - ln_beta(a, b) - ln_shown;
  }
  if (evidence.in_view > 0) {
    evidence.log10_missing =
        log10_beta_binomial_tail(evidence.in_view, evidence.missing, expected_missing / evidence.in_view,
                                 experience(scene.maps.rates.clutter_count));
  }
}

/// A landmark's ln diameter is normal with the mean and variance that the witnesses show, less the variance
/// of a measurement, which is learned. So the map's mean says what the witness should have measured. A share
/// kSizeWrong of the measurements says nothing of the landmark.
void EvidenceScale::weigh_sizes(const Scene& scene, const Candidate& candidate, Evidence& evidence) noexcept {
  const std::span<const LandmarkSize> sizes = scene.witnesses.sizes;
  double sum = 0.0;
  double sum2 = 0.0;
  double count = 0.0;
  for (const LandmarkSize& size : sizes) {
    const double ln_diameter = size.is_known() ? static_cast<double>(size.ln_diameter) : 0.0;
    sum += ln_diameter;
    sum2 += ln_diameter * ln_diameter;
    count += size.is_known() ? 1.0 : 0.0;
  }
  const double measured2 = scene.maps.rates.size_variance();
  const double mean = sum / std::max(1.0, count);
  const double spread2 = (sum2 - sum * mean) / std::max(1.0, count - 1.0) - measured2;
  if (count < kSizesMin || spread2 <= 0.0) {
    return;  // all alike, as far as can be measured
  }
  std::uint32_t sized = 0;
  std::uint32_t odd = 0;
  for (const Match& match : candidate.matches) {
    const LandmarkSize& seen = sizes[match.scan];
    const LandmarkSize& known = scene.maps.standing[match.map].size;
    if (!seen.is_known() || !known.is_known()) {
      continue;
    }
    const double own2 = measured2 * seen.variance_share();
    const double weight = 1.0 / (measured2 * known.variance_share());
    const double variance = 1.0 / (1.0 / spread2 + weight);
    const double expected = variance * (mean / spread2 + weight * static_cast<double>(known.ln_diameter));
    const double off = static_cast<double>(seen.ln_diameter) - expected;
    const double off_mean = static_cast<double>(seen.ln_diameter) - mean;
    const double ln_ratio = 0.5 * (std::log((spread2 + own2) / (variance + own2)) -
                                   off * off / (variance + own2) + off_mean * off_mean / (spread2 + own2));
    evidence.ln_sizes +=
        std::log(kSizeWrong + (1.0 - kSizeWrong) * std::min(kSizeMost, std::exp(std::min(ln_ratio, 10.0))));
    ++sized;
    odd += off * off > kSizeSigmas * kSizeSigmas * (variance + own2) ? 1 : 0;
  }
  evidence.ln_bayes += evidence.ln_sizes;
  const double log10_odd =
      log10_beta_binomial_tail(sized, odd, kSizeOdd, experience(scene.maps.rates.size_count));
  evidence.log10_odd_sizes = std::min(0.0, log10_odd + kSizeOddUsual);
}

/// Matches within the size of a copy of the strongest are one group, then those within it of the strongest
/// that is left.
double EvidenceScale::group_decades(const Scene& scene, const Candidate& candidate,
                                    double copy_m) const noexcept {
  std::array<bool, kScanLandmarksMax> taken{};
  double sum = 0.0;
  double largest = 0.0;
  std::size_t left = candidate.matches.size();
  while (left > 0) {
    std::size_t strongest = kScanLandmarksMax;
    for (std::size_t m = 0; m < candidate.matches.size(); ++m) {
      if (!taken[m] && (strongest == kScanLandmarksMax || nats_[m] > nats_[strongest])) {
        strongest = m;
      }
    }
    double group = 0.0;
    const Point2& centre = scene.witnesses.points_B[candidate.matches[strongest].scan];
    for (std::size_t m = 0; m < candidate.matches.size(); ++m) {
      if (!taken[m] && (scene.witnesses.points_B[candidate.matches[m].scan] - centre).norm() <= copy_m) {
        taken[m] = true;
        group += std::max(0.0, nats_[m]);
        --left;
      }
    }
    group = std::min(group, kGroupCap);
    sum += group;
    largest = std::max(largest, group);
  }
  return (sum - largest) / std::numbers::ln10;
}

}  // namespace slamsensor::core
