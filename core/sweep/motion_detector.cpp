#include "core/sweep/motion_detector.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace slamsensor::core {
namespace {

constexpr int kHuberRounds = 4;
constexpr int kTukeyRounds = 4;
constexpr double kHuber = 1.345;
constexpr double kTukey = 4.685;
constexpr double kToSigma = 1.4826;  // median of absolute deviations to standard deviation
constexpr double kScaleMin = 0.5;    // of the expected sigmas
constexpr double kSectorsMin = 3.0;  // with marks
// 1 sigma of what is known before: next to nothing of the motion, not much recession.
// Nor much lean: 3 deg.
constexpr std::array<double, 6> kPrior = {20.0, 20.0, 2.0, 0.5, 0.05, 0.05};
constexpr double kCreepLines = 4.0;  // a creep shows in what was first seen so long ago

}  // namespace

/// Normal equations of some rows.
struct MotionFitter::Normal {
  using Matrix = Eigen::Matrix<double, 6, 6>;
  using Vector = Eigen::Matrix<double, 6, 1>;
  Matrix a = Matrix::Zero();
  Vector b = Vector::Zero();
  double rows = 0.0;

  void add(const Row& row) noexcept {
    const Eigen::Map<const Vector> c(row.coefficients.data());
    a.noalias() += row.weight * c * c.transpose();
    b += row.weight * row.value * c;
    rows += 1.0;
  }
  void add_prior() noexcept {
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double sigma = kPrior[static_cast<std::size_t>(i)];
      a(i, i) += 1.0 / (sigma * sigma);
    }
  }
  [[nodiscard]] Solution solve() const noexcept {
    const Vector x = a.ldlt().solve(b);
    return {x[0], x[1], x[2], x[3], x[4], x[5]};
  }
};

std::optional<MotionEstimate> MotionFitter::fit(std::span<const MarkShift> shifts, MotionKind kind,
                                                std::uint32_t things_min) noexcept {
  const auto things = std::count_if(shifts.begin(), shifts.end(), [kind](const MarkShift& shift) {
    return kind == MotionKind::Jump || shift.lines >= kCreepLines;
  });
  if (things < static_cast<std::ptrdiff_t>(things_min) || shifts.size() > kMarksMax) {
    return std::nullopt;
  }
  collect(shifts, kind);
  for (int round = 0; round < kHuberRounds + kTukeyRounds; ++round) {
    Normal normal;
    normal.add_prior();
    for (const Row& row : rows_) {
      normal.add(row);
    }
    update_residuals(normal.solve());
    scale_ = round < kHuberRounds ? scale() : scale_;
    round < kHuberRounds ? weigh_huber() : weigh_tukey();
  }
  return judge();
}

void MotionFitter::collect(std::span<const MarkShift> shifts, MotionKind kind) noexcept {
  rows_.clear();
  double longest = 1.0;
  for (const MarkShift& shift : shifts) {
    longest = std::max(longest, shift.lines);
  }
  for (const MarkShift& shift : shifts) {
    if (kind == MotionKind::Creep && shift.lines < kCreepLines) {
      continue;
    }
    const double share = shift.lines / longest;
    rise_m_ = shift.rise_m;
    age_share_ = kind == MotionKind::Creep ? share : 1.0;
    const double turns = (shift.bearing_rad + std::numbers::pi) / (2.0 * std::numbers::pi);
    sector_ = static_cast<std::size_t>(std::clamp(turns, 0.0, 0.999) * kSectors);
    const double c = std::cos(shift.bearing_rad);
    const double s = std::sin(shift.bearing_rad);
    const double near_range_m = std::max(0.1, shift.range_m);
    // Seen from a place that is (x, y, turn) on, a thing is at bearing + (x s - y c) / range - turn.
    const std::array<double, 3> bearing = {s / near_range_m, -c / near_range_m, -1.0};
    std::array<double, 3> range = {-c, -s, 0.0};
    if (shift.kind == MarkKind::Post) {
      add_row(bearing, 0.0, shift.bearing_off_rad, shift.bearing_sigma);
    } else {
      for (std::size_t i = 0; i < 3; ++i) {
        range[i] -= shift.slope_mprad * bearing[i];  // the same bearing shows another place of the surface
      }
    }
    add_row(range, share, shift.range_off_m, shift.range_sigma_m);
  }
}

void MotionFitter::add_row(const std::array<double, 3>& motion, double recession, double value,
                           double sigma) noexcept {
  if (!(sigma > 0.0)) {
    return;
  }
  Row row;
  for (std::size_t i = 0; i < 3; ++i) {
    row.coefficients[i] = age_share_ * motion[i] / sigma;
  }
  row.coefficients[3] = recession / sigma;
  row.coefficients[4] = -rise_m_ * motion[0] / sigma;  // as if the thing were displaced the other way
  row.coefficients[5] = -rise_m_ * motion[1] / sigma;
  row.value = value / sigma;
  row.sector = sector_;
  static_cast<void>(rows_.try_push_back(row));  // there is room for two of each mark
}

void MotionFitter::update_residuals(const Solution& solution) noexcept {
  for (Row& row : rows_) {
    row.residual = row.value;
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      row.residual -= row.coefficients[i] * solution[i];
    }
  }
}

/// Robust standard deviation of the residuals, in expected sigmas.
double MotionFitter::scale() noexcept {
  const auto count = static_cast<std::ptrdiff_t>(rows_.size());
  std::transform(rows_.begin(), rows_.end(), sorted_.begin(),
                 [](const Row& row) { return std::abs(row.residual); });
  std::nth_element(sorted_.begin(), sorted_.begin() + count / 2, sorted_.begin() + count);
  return std::max(kScaleMin, kToSigma * sorted_[static_cast<std::size_t>(count / 2)]);
}

void MotionFitter::weigh_huber() noexcept {
  for (Row& row : rows_) {
    const double off = std::abs(row.residual) / scale_;
    row.weight = off <= kHuber ? 1.0 : kHuber / off;
  }
}

void MotionFitter::weigh_tukey() noexcept {
  for (Row& row : rows_) {
    const double off = row.residual / (kTukey * scale_);
    const double left = std::max(0.0, 1.0 - off * off);
    row.weight = left * left;
  }
}

MotionEstimate MotionFitter::judge() noexcept {
  std::array<Normal, kSectors> sectors;
  Normal all;
  all.add_prior();
  double weight = 0.0;
  for (const Row& row : rows_) {
    sectors[row.sector].add(row);
    all.add(row);
    weight += row.weight;
  }
  const Solution whole = all.solve();
  MotionEstimate estimate{whole[0],
                          whole[1],
                          whole[2],
                          std::hypot(whole[0], whole[1]),
                          0.0,
                          0.0,
                          weight / static_cast<double>(rows_.size())};
  const double along_x = estimate.distance_m > 0.0 ? estimate.x_m / estimate.distance_m : 1.0;
  const double along_y = estimate.distance_m > 0.0 ? estimate.y_m / estimate.distance_m : 0.0;
  double used = 0.0;
  double distance_m2 = 0.0;
  double turn_rad2 = 0.0;
  for (const Normal& sector : sectors) {
    if (sector.rows > 0.0) {
      Normal rest = all;
      rest.a -= sector.a;
      rest.b -= sector.b;
      const Solution without = rest.solve();
      const double off_m = along_x * (without[0] - whole[0]) + along_y * (without[1] - whole[1]);
      distance_m2 += off_m * off_m;
      turn_rad2 += (without[2] - whole[2]) * (without[2] - whole[2]);
      used += 1.0;
    }
  }
  // Column by column: Eigen's inverse keeps static variables, which core must not.
  const auto factors = all.a.ldlt();
  Normal::Matrix spread;
  for (Eigen::Index i = 0; i < spread.cols(); ++i) {
    spread.col(i) = scale_ * scale_ * factors.solve(Normal::Vector::Unit(i));
  }
  const double along_m2 = along_x * along_x * spread(0, 0) + along_y * along_y * spread(1, 1) +
                          2.0 * along_x * along_y * spread(0, 1);
  const double share = used >= kSectorsMin ? (used - 1.0) / used : 1e6;  // one direction tells nothing
  estimate.distance_sigma_m = std::sqrt(std::max(along_m2, share * distance_m2));
  estimate.turn_sigma_rad = std::sqrt(std::max(spread(2, 2), share * turn_rad2));
  return estimate;
}

namespace {

constexpr double kAgreeingMin = 0.4;      // of an estimate
constexpr std::uint32_t kRisenMin = 2;    // new things before old background ...
constexpr double kRisenShare = 0.3;       // ... and this many for each that stood
constexpr double kBreakShare = 0.4;       // of what was known of the line before
constexpr double kRisenAtBreak = 0.15;    // of what such a line sees
constexpr double kRisenNowShare = 0.25;   // of what an incoherent line sees
constexpr std::uint32_t kLinesInRow = 3;  // without an agreement

/// Whether two lines tell of the same motion.
bool agree(const MotionEstimate& a, const MotionEstimate& b, const MotionConfig& config) noexcept {
  const bool same_way = a.x_m * b.x_m + a.y_m * b.y_m > 0.5 * a.distance_m * b.distance_m &&
                        std::min(a.distance_m, b.distance_m) > config.distance_min_m;
  const bool same_turn = a.turn_rad * b.turn_rad > 0.0 &&
                         std::min(std::abs(a.turn_rad), std::abs(b.turn_rad)) > config.angle_min_rad;
  return same_way || same_turn;
}

}  // namespace

void MotionDetector::begin_scan() noexcept {
  tracks_.clear();
  report_ = {};
  suspects_ = {};
  incoherent_ = suspect_ = 0;
  known_shares_.clear();
  last_known_ = {};
  is_broken_ = has_moved_ = false;
}

void MotionDetector::add(const Scanline& line) noexcept {
  if (!config_.enabled || has_moved_) {
    return;
  }
  marks_.build(line, config_.range_max_m);
  const std::uint64_t dropped = tracks_.dropped();
  tracks_.add(marks_);
  counters_.count(MotionEvent::MarksDropped, tracks_.dropped() - dropped);
  report_.tally = tracks_.tally();
  report_.jump = fitter_.fit(tracks_.shifts(), MotionKind::Jump, config_.things_min);
  report_.creep = fitter_.fit(tracks_.shifts(), MotionKind::Creep, config_.things_min);
  counters_.count(report_.jump ? MotionEvent::LinesJudged : MotionEvent::LinesNotJudged);
  if (is_displaced()) {
    give_up(MotionEvent::ScansDisplaced);
  } else if (is_changed()) {
    give_up(MotionEvent::ScansChanged);
  } else if (is_incoherent()) {
    give_up(MotionEvent::ScansIncoherent);
  }
}

void MotionDetector::end_scan() noexcept {
  if (!config_.enabled || has_moved_ || known_shares_.size() == kFewLines) {
    return;
  }
  const auto* const most =
      std::max_element(known_shares_.begin(), known_shares_.end(),
                       [](const KnownShare& a, const KnownShare& b) { return a.known < b.known; });
  if (std::any_of(known_shares_.begin(), known_shares_.end(),
                  [&](const KnownShare& line) { return breaks_off_from(*most, line); })) {
    give_up(MotionEvent::ScansChanged);
  }
}

bool MotionDetector::is_suspect(const std::optional<MotionEstimate>& estimate) const noexcept {
  if (!estimate || estimate->agreeing < kAgreeingMin) {
    return false;
  }
  const bool is_far = estimate->distance_m > config_.distance_min_m &&
                      estimate->distance_m > config_.sigmas * estimate->distance_sigma_m;
  const double turn_rad = std::abs(estimate->turn_rad);
  return is_far || (turn_rad > config_.angle_min_rad && turn_rad > config_.sigmas * estimate->turn_sigma_rad);
}

bool MotionDetector::is_displaced() noexcept {
  bool agreed = false;
  bool suspect = false;
  const std::array<std::optional<MotionEstimate>, 2> estimates = {report_.jump, report_.creep};
  for (std::size_t kind = 0; kind < estimates.size(); ++kind) {
    const bool is_one = is_suspect(estimates[kind]);
    agreed = agreed || (is_one && suspects_[kind] && agree(*estimates[kind], *suspects_[kind], config_));
    suspects_[kind] = is_one ? estimates[kind] : std::nullopt;
    suspect = suspect || is_one;
  }
  counters_.count(MotionEvent::LinesSuspect, suspect ? 1 : 0);
  suspect_ = suspect ? suspect_ + 1 : 0;
  return agreed || suspect_ >= kLinesInRow;
}

/// What stood is gone, and other things stand before what was seen behind it; or all of a sudden next to
/// nothing of a line was known, and what had stood has not come back in the next one either.
bool MotionDetector::is_changed() noexcept {
  const MarkTally& tally = report_.tally;
  const bool is_gone =
      tally.standing >= config_.things_min && tally.lost >= config_.lost_share_min * tally.standing;
  const bool has_risen = tally.risen >= std::max<double>(kRisenMin, kRisenShare * tally.standing);
  const bool was_broken = std::exchange(is_broken_, breaks_off());
  return is_gone && (has_risen || was_broken);
}

/// Whether fewer marks are known in this line than in the one before by more than chance does.
bool MotionDetector::breaks_off() noexcept {
  const KnownShare known = known_share(report_.tally);
  if (report_.tally.seen > 0) {
    static_cast<void>(known_shares_.try_push_back(known));  // a scan of more lines is judged as it goes on
  }
  return breaks_off_from(std::exchange(last_known_, known), known);
}

MotionDetector::KnownShare MotionDetector::known_share(const MarkTally& tally) noexcept {
  const double seen = std::max(1.0, static_cast<double>(tally.seen));
  const double known = tally.known / seen;
  return {known, std::sqrt(known * (1.0 - known) / seen) + 0.5 / seen,
          tally.risen_now > kRisenAtBreak * seen};
}

bool MotionDetector::breaks_off_from(const KnownShare& other, const KnownShare& line) const noexcept {
  return line.has_risen && line.known < kBreakShare * other.known &&
         other.known - line.known > config_.sigmas * other.sigma;
}

/// Whether line after line sees new things before what was seen until then, and nothing stands.
bool MotionDetector::is_incoherent() noexcept {
  const MarkTally& tally = report_.tally;
  const bool something_stands =
      tally.standing >= config_.things_min && tally.lost < config_.lost_share_min * tally.standing;
  const bool is_one = !something_stands && tally.seen >= 2 * config_.things_min &&
                      tally.known < config_.coherent_share_min * tally.seen &&
                      tally.risen_now > kRisenNowShare * tally.seen;
  incoherent_ = is_one ? incoherent_ + 1 : 0;
  return incoherent_ >= kLinesInRow;
}

void MotionDetector::give_up(MotionEvent why) noexcept {
  has_moved_ = true;
  counters_.count(why);
}

}  // namespace slamsensor::core
