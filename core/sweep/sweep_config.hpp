#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamsensor::core {

/// How a unit makes a whole position out of where its axis is.
enum class PositionRounding : std::uint8_t {
  Nearest,     ///< to the nearest position
  Down,        ///< to the next position to the right or below
  TowardZero,  ///< to the next position towards 0
};

/// How the pan angle is fitted over a line's polls.
struct PanFitConfig {
  std::uint32_t polls_min = 5;        ///< [3, 1000] polls of the moving axis that a line needs
  double poll_jitter_s = 0.001;       ///< [0, 0.1] s: 1 sigma of when a poll is answered, half width apart
  double speed_error_sigma = 300e-6;  ///< [0, 0.1] share: 1 sigma of the unit's clock, known before the line
  double speed_error_max = 0.02;      ///< [0, 0.5] share: a line that ran more off than this is rejected
  double outliers_max_share = 0.3;    ///< [0, 0.5] a line with more polls off the fit is rejected
  double path_tolerance_rad = 1.75e-3;  ///< [0, 10 deg]: 0.1 deg; a stretch of a line off the motion model by
                                        ///< this much, and more than chance does, rejects the line
  PositionRounding rounding = PositionRounding::Nearest;  ///< nearest, down, toward_zero
};

/// How the constant latency between the two devices is found by the sensor itself.
struct LatencyConfig {
  bool self_calibration = true;  ///< false: `initial_s` is used as it stands
  double initial_s = 0.0;  ///< [-0.5, 0.5] s: added to a reading's stamp until something better is known
  double initial_sigma_s = 0.02;    ///< [1e-6, 0.5] s: how well that is known
  double search_s = 0.06;           ///< [0.001, 0.5] s: looked for within this of `initial_s`
  double pair_sigma_max_s = 0.003;  ///< [1e-5, 0.1] s: a pair of lines that tells less is left out
  double range_max_m = 300.0;       ///< [1, 10000] what is farther counts as no return
  std::uint32_t pairs_min = 1;      ///< [1, 1000] pairs that an estimate is made of
  double departure_sigmas = 5.0;    ///< [1, 100] a later estimate farther off than this is a departure ...
  double departure_min_s = 0.0002;  ///< [0, 0.1] s: ... if it is off by this at least
  std::uint32_t confirmations = 3;  ///< [1, 100] departures in a row that agree, until they are believed
  double drift_sigma_s = 2e-5;      ///< [0, 0.01] s: 1 sigma by which the latency may change in a scan
};

/// How a scan is recognised that was not made from one place, because the carrier moved meanwhile.
struct MotionConfig {
  bool enabled = true;           ///< false: every scan is taken for one made at rest
  double distance_min_m = 0.15;  ///< [0.01, 10] m: a move that is shorter, and ...
  double angle_min_rad = 0.015;  ///< [0.001, 1] rad ([0.06, 57] deg): ... a turn that is less, are let pass
  double sigmas = 6.0;           ///< [3, 100] standard deviations that a move must be sure by
  double range_max_m = 100.0;    ///< [5, 1000] m: what is farther is not looked at
  double lost_share_min = 0.6;   ///< [0.1, 1] of what stood for some lines: so much of it has to be gone
  std::uint32_t things_min = 6;  ///< [3, 100] things that a judgement needs at least
  double coherent_share_min = 0.5;  ///< [0, 1] of what a line sees: so much the lines before must have seen
};

/// Room of a ScanAssembler, and how long it waits for late samples after the end of a line.
struct AssemblerConfig {
  std::uint32_t readings_per_line_max = 120'000;
  std::uint32_t polls_per_line_max = 2'000;
  double late_data_s = 0.1;
};

/// A value, or why there is none.
template <typename Value, typename Problem>
class Outcome {
 public:
  Outcome(const Value& value) noexcept : value_(value), has_value_(true) {}
  Outcome(Problem problem) noexcept : problem_(problem) {}

  [[nodiscard]] bool has_value() const noexcept { return has_value_; }
  [[nodiscard]] explicit operator bool() const noexcept { return has_value_; }
  [[nodiscard]] const Value& operator*() const noexcept { return value_; }
  [[nodiscard]] const Value* operator->() const noexcept { return &value_; }
  [[nodiscard]] Problem error() const noexcept { return problem_; }

 private:
  Value value_{};
  Problem problem_{};
  bool has_value_ = false;
};

/// How often each event of a station happened since construction, by the number of its enumerator.
template <typename Event, std::size_t kCount>
class EventCounts {
 public:
  void count(Event event, std::uint64_t times = 1) noexcept {
    counts_[static_cast<std::size_t>(event)] += times;
  }
  [[nodiscard]] std::uint64_t operator[](Event event) const noexcept {
    return counts_[static_cast<std::size_t>(event)];
  }
  [[nodiscard]] std::span<const std::uint64_t> all() const noexcept { return counts_; }

 private:
  std::array<std::uint64_t, kCount> counts_{};
};

}  // namespace slamsensor::core
