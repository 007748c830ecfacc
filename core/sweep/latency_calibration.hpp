#pragma once

#include "core/memory/fixed_vector.hpp"
#include "core/sweep/sweep_config.hpp"
#include "core/sweep/swept_line.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace slamsensor::core {

/// Even cells of pan that profiles of lines are laid out on: cell i is at min_rad + i * cell_rad.
struct ProfileGrid {
  double min_rad = 0.0;
  double cell_rad = 0.0;
  std::size_t cells = 0;
};

/// Most cells of a profile; bounds what it costs to compare two.
inline constexpr std::size_t kProfileCellsMax = 8192;

/// The grid of pan_min_rad to pan_max_rad (greater) with a cell for each reading when they are `reading_rad`
/// apart (positive), or wider cells when those would be more than kProfileCellsMax.
[[nodiscard]] ProfileGrid make_grid(double pan_min_rad, double pan_max_rad, double reading_rad) noexcept;

/// How far the world is over pan, as one line saw it: the logarithm of the range, so that an edge counts by
/// the ratio of its two ranges, lightly smoothed. No allocation after construction.
class RangeProfile {
 public:
  static constexpr std::int16_t kHole = -1;   ///< not looked at
  static constexpr double kPerUnit = 1000.0;  ///< of a natural logarithm of (range / m + 1)

  /// Takes the steady part of `line`. What is beyond `range_max_m` and what did not return count as equally
  /// far.
  void build(const Scanline& line, const ProfileGrid& grid, double range_max_m) noexcept;

  /// Per cell of the grid.
  [[nodiscard]] std::span<const std::int16_t> cells() const noexcept { return smooth_.span(); }

  [[nodiscard]] SweepDirection direction() const noexcept { return direction_; }
  [[nodiscard]] std::uint32_t line() const noexcept { return line_; }
  [[nodiscard]] double pan_radps() const noexcept { return pan_radps_; }
  [[nodiscard]] double fit_sigma_s() const noexcept { return fit_sigma_s_; }
  [[nodiscard]] double latency_s() const noexcept { return latency_s_; }

 private:
  void draw(const ProfileGrid& grid, const Reading& from, const Reading& to, double range_max_m) noexcept;
  void smooth() noexcept;

  FixedVector<double, kProfileCellsMax> raw_;  // per cell; negative where there is no reading nearby
  FixedVector<std::int16_t, kProfileCellsMax> smooth_;
  SweepDirection direction_ = SweepDirection::Leftwards;
  std::uint32_t line_ = 0;
  double pan_radps_ = 0.0;
  double fit_sigma_s_ = 0.0;
  double latency_s_ = 0.0;
};

/// Why two lines do not tell the latency.
enum class PairProblem : std::uint8_t {
  NoOverlap,  ///< the sweep is too narrow for the latencies looked for
  NoEdges,    ///< the world looks the same wherever one looks
  Ambiguous,  ///< another latency fits about as well: things at even distances
  AtLimit,    ///< the best latency is at the end of those looked for
  Unsure,     ///< the edges agree too badly with one another
};

/// What a pair of lines says of the latency.
struct PairEstimate {
  double latency_s = 0.0;
  double sigma_s = 0.0;
  double cell_s = 0.0;                               ///< latency that displaces the lines by one cell
  SweepDirection first = SweepDirection::Leftwards;  ///< of the earlier line
};

using PairOutcome = Outcome<PairEstimate, PairProblem>;

/// Finds the latency at which two lines swept in opposite directions show the same world. A latency tau
/// moves what a line sees by speed * tau against its direction, so that two opposite lines are displaced by
/// twice as much. All displacements by whole cells are tried, a few in each step; the cost is the mean
/// absolute difference of the profiles, cut off so that what differs (people, twigs, another tilt) counts no
/// more than an edge; below a cell, the middle between the valley's flanks counts. Its sigma is that of
/// leaving out one sector of the pan range after another (jackknife). No allocation after construction; one
/// thread.
class PairAlignment {
 public:
  explicit PairAlignment(const LatencyConfig& config) noexcept : config_(config) {}

  /// Starts on two profiles of the same grid with opposite directions, `earlier` swept first; they stay as
  /// they are until is_busy() is false.
  void begin(const RangeProfile& earlier, const RangeProfile& later, const ProfileGrid& grid) noexcept;
  void abandon() noexcept { next_lag_ = lags_; }
  [[nodiscard]] bool is_busy() const noexcept { return next_lag_ < lags_; }

  /// Tries a few displacements, at most 10^5 cells in all; the outcome when it was the last of them.
  [[nodiscard]] std::optional<PairOutcome> step() noexcept;

 private:
  static constexpr std::size_t kLagsMax = 1025;
  static constexpr std::size_t kSectors = 16;
  using SectorCosts = std::array<std::int32_t, kSectors>;

  void try_lag(std::size_t index) noexcept;
  [[nodiscard]] PairOutcome conclude() const noexcept;
  [[nodiscard]] std::int64_t cost(std::size_t index) const noexcept;
  [[nodiscard]] std::int64_t typical_cost() const noexcept;
  [[nodiscard]] std::int64_t second_best(std::size_t best) const noexcept;
  [[nodiscard]] double lean(std::size_t centre, std::size_t sector_left_out) const noexcept;
  [[nodiscard]] double valley(std::size_t best, std::size_t sector_left_out) const noexcept;
  [[nodiscard]] double latency_of(double lag) const noexcept;

  LatencyConfig config_;
  const RangeProfile* leftwards_ = nullptr;
  const RangeProfile* rightwards_ = nullptr;
  SweepDirection first_ = SweepDirection::Leftwards;
  double lag_s_ = 0.0;          // latency per cell of displacement
  double base_s_ = 0.0;         // latency without displacement
  std::int64_t first_lag_ = 0;  // cells
  std::size_t margin_ = 0;
  std::size_t lags_ = 0;
  std::size_t next_lag_ = 0;
  std::size_t window_ = 0;  // cells compared
  std::array<SectorCosts, kLagsMax> costs_{};
};

/// The latency between the two devices as it is known: what must be added to the stamp of a reading to get
/// the time at which the polls show the axis where the reading was made.
struct Latency {
  double latency_s = 0.0;
  double sigma_s = 0.0;
  std::uint32_t pairs = 0;  ///< that the last pass taken was made of; 0 while it is the configured value
  /// Of the polls that it was found with (Scanline::half_width_s). Polls with a greater one may be off by the
  /// difference: their stamps have moved within it by nobody knows how much. Infinite while not known.
  double half_width_s = std::numeric_limits<double>::infinity();
};

enum class LatencyEvent : std::uint8_t {
  PairsUsed,
  PairsNoOverlap,  ///< left out: see PairProblem
  PairsNoEdges,
  PairsAmbiguous,
  PairsAtLimit,
  PairsUnsure,
  PairsDropped,      ///< not done in time, or no room
  PassesRefused,     ///< a pass without enough pairs
  PassesTaken,       ///< a pass that agreed with what was known, or was the first
  LatencyDeparted,   ///< a pass that did not agree
  LatencyTakenOver,  ///< departures that were believed in the end
};
inline constexpr std::size_t kLatencyEvents = 11;

/// Keeps the latency from what lines see. Lines come in passes (a scan, or the lines swept at one tilt at
/// start-up); neighbouring lines swept in opposite directions are aligned (PairAlignment), and at the end of
/// a pass its pairs are put together: robustly, and the pairs that were swept leftwards first by themselves,
/// rightwards first by themselves, so that what the step of the tilt displaces (a leaning stem) cancels.
/// A pass that agrees is merged with what is known; departures are counted and believed after some in a row
/// that agree with one another. No allocation after construction; one thread.
class LatencyCalibration {
 public:
  /// Of a pass; more are dropped.
  static constexpr std::size_t kPairsMax = 10'000;

  explicit LatencyCalibration(const LatencyConfig& config) noexcept;

  /// A new pass of lines with readings about `reading_rad` apart between pan_min_rad and pan_max_rad. What is
  /// left of an earlier one is dropped.
  void begin_pass(double pan_min_rad, double pan_max_rad, double reading_rad) noexcept;
  /// Copies what it needs of `line`.
  void add(const Scanline& line) noexcept;
  /// A bounded piece of the work on the last pair.
  void step() noexcept;
  /// Whether step() has work left.
  [[nodiscard]] bool is_busy() const noexcept { return alignment_.is_busy(); }
  /// Whether a pair of the pass under way has been looked at.
  [[nodiscard]] bool has_looked() const noexcept { return looked_at_ > 0; }
  /// Whether the pass under way, as far as it was looked at, shows another latency than is known: as a whole,
  /// or in two fifths of its pairs to one side; by more than `limit_s`, and more than chance does.
  [[nodiscard]] bool departs(double limit_s) noexcept;
  /// Puts the pass together. Pairs that step() had not come to are dropped.
  void end_pass() noexcept;

  [[nodiscard]] const Latency& latency() const noexcept { return latency_; }
  [[nodiscard]] std::span<const PairEstimate> pairs() const noexcept { return pairs_.span(); }
  [[nodiscard]] std::uint64_t count(LatencyEvent event) const noexcept { return counters_[event]; }

 private:
  void drop_pair() noexcept;
  [[nodiscard]] std::optional<Latency> combine() noexcept;
  [[nodiscard]] double median_latency_s() noexcept;
  [[nodiscard]] double scatter_s(double median_s) noexcept;
  void take(const Latency& pass) noexcept;
  void depart(const Latency& pass) noexcept;
  [[nodiscard]] double limit_s(double a_sigma_s, double b_sigma_s) const noexcept;
  [[nodiscard]] bool agree(const Latency& a, const Latency& b) const noexcept;

  LatencyConfig config_;
  ProfileGrid grid_;
  PairAlignment alignment_;
  std::array<RangeProfile, 2> profiles_;
  std::size_t newest_ = 0;  // of the profiles
  bool has_line_ = false;
  FixedVector<PairEstimate, kPairsMax> pairs_;
  std::array<double, kPairsMax> sorted_{};
  std::uint32_t looked_at_ = 0;  // pairs of this pass
  double half_widths_sum_s_ = 0.0;
  std::uint32_t half_widths_ = 0;
  Latency latency_;
  Latency departed_;
  std::uint32_t departures_ = 0;  // in a row that agree with departed_
  EventCounts<LatencyEvent, kLatencyEvents> counters_;
};

}  // namespace slamsensor::core
