#pragma once

#include "firmware/scan/range_profile.hpp"
#include "firmware/scan/scan_config.hpp"

#include <tl/expected.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace slamsensor::firmware {

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

/// Finds the latency at which two lines swept in opposite directions show the same world. A latency tau
/// moves what a line sees by speed * tau against its direction, so that two opposite lines are displaced by
/// twice as much. All displacements by whole cells are tried, a few in each step; the cost is the mean
/// absolute difference of the profiles, cut off so that what differs (people, twigs, another tilt) counts no
/// more than an edge; below a cell, the middle between the valley's flanks counts. Its sigma is that of
/// leaving out one sector of the pan range after another (jackknife). No allocation after construction; one
/// thread.
class PairAlignment {
 public:
  explicit PairAlignment(const LatencyConfig& config);

  /// Starts on two profiles of the same grid with opposite directions, `earlier` swept first; they stay as
  /// they are until is_busy() is false.
  void begin(const RangeProfile& earlier, const RangeProfile& later, const ProfileGrid& grid) noexcept;
  void abandon() noexcept { next_lag_ = lags_; }
  [[nodiscard]] bool is_busy() const noexcept { return next_lag_ < lags_; }

  /// Tries a few displacements, at most 10^5 cells in all; the outcome when it was the last of them.
  [[nodiscard]] std::optional<tl::expected<PairEstimate, PairProblem>> step() noexcept;

 private:
  static constexpr std::size_t kSectors = 16;
  using SectorCosts = std::array<std::int32_t, kSectors>;

  void try_lag(std::size_t index) noexcept;
  [[nodiscard]] tl::expected<PairEstimate, PairProblem> conclude() const noexcept;
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
  std::vector<SectorCosts> costs_;
};

}  // namespace slamsensor::firmware
