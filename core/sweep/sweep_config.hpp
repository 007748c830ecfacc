#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace slamsensor::core {

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

 private:
  std::array<std::uint64_t, kCount> counts_{};
};

}  // namespace slamsensor::core
