#pragma once

#include "core/memory/fixed_vector.hpp"
#include "core/sweep/pair_alignment.hpp"
#include "core/sweep/sweep_config.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace slamsensor::core {

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
