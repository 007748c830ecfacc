#pragma once

#include "core/association/acceptance.hpp"
#include "core/association/paper_search.hpp"
#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/fix.hpp"
#include "core/landmark.hpp"
#include "core/mapping/hypothesis.hpp"
#include "core/mapping/map_builder.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"
#include "core/memory/fixed_vector.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::core {

/// Events of the fixed memory and of the search, counted since construction.
struct Counters {
  std::uint64_t landmarks_cut = 0;       ///< scan landmarks beyond capacities.scan_landmarks, lightest first
  std::uint64_t landmarks_refused = 0;   ///< scan landmarks that were not finite or out of reach
  std::uint64_t neighbours_dropped = 0;  ///< correspondence neighbours beyond kVertexNeighboursMax
  std::uint64_t searches_cut = 0;        ///< by the deadline
};

/// The kept hypotheses (DESIGN 2.4). On a scan each spawns its candidates; all are ranked by W; the best
/// Lambda_max survive; the best of them is the solution. A scan that is not believed changes no map. One
/// thread; no allocation after construction.
class HypothesisSet {
 public:
  HypothesisSet(Arena& arena, const Config& config) noexcept;

  /// Localises the scan and brings it into the maps. `landmarks` come heaviest first. The first scan with
  /// enough landmarks defines the map frame: its pose is the origin. Fix::time is the caller's.
  [[nodiscard]] Fix process(std::span<const ScanLandmark> landmarks, const Deadline& deadline) noexcept;

  /// Forgets everything; the next scan starts a new map.
  void reset() noexcept;

  [[nodiscard]] bool empty() const noexcept { return kept_.empty(); }
  [[nodiscard]] const Hypothesis& best() const noexcept { return *pool_[kept_[0]]; }
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

 private:
  /// A hypothesis of the next generation: a parent extended by one of its candidates, or left as it is.
  struct Offspring {
    std::uint32_t parent = 0;  // place in kept_
    std::int32_t candidate = -1;
    std::uint64_t weight = 0;
  };
  /// Candidates of one parent that may become offspring.
  struct Litter {
    Verdict verdict;
    Candidates found;
  };
  using Generation = FixedVector<Offspring, kHypothesesMax>;

  void take_landmarks(std::span<const ScanLandmark> landmarks) noexcept;
  void associate_all(const Deadline& deadline) noexcept;
  [[nodiscard]] Generation spawn() const noexcept;
  void replace(const Generation& generation) noexcept;
  void report(const Offspring& best, Fix& fix) noexcept;
  void extend(std::uint32_t slot, const Offspring& offspring) noexcept;

  Config config_;
  PaperSearch search_;
  MapBuilder builder_;
  std::array<std::optional<Hypothesis>, kHypothesesMax> pool_;  // the first hypotheses_max exist
  FixedVector<std::uint32_t, kHypothesesMax> kept_;             // slots of pool_, best W first
  BoundedVector<Point2> scan_B_;   // in the body frame: what core localises is the body
  BoundedVector<Litter> litters_;  // per place in kept_
  Counters counters_;
  std::uint32_t scans_ = 0;
  std::uint32_t jumps_ = 0;
};

}  // namespace slamsensor::core
