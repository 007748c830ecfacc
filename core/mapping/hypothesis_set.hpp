#pragma once

#include "core/association/candidate.hpp"
#include "core/association/paper_search.hpp"
#include "core/config.hpp"
#include "core/deadline.hpp"
#include "core/fix.hpp"
#include "core/mapping/hypothesis.hpp"
#include "core/mapping/map_builder.hpp"
#include "core/mapping/map_state.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"
#include "core/memory/fixed_vector.hpp"
#include "core/reading.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::core {

/// The paper's multi-hypothesis rule, literally (II-D): on a scan each hypothesis spawns its candidates; all
/// are ranked by W, the accumulated match count; the best Lambda_max survive; the best of them is the
/// solution. Overlap is assumed. One thread; no allocation after construction.
class HypothesisSet {
 public:
  HypothesisSet(Arena& arena, const Config& config) noexcept;

  /// Localises the scan and brings it into the maps. `landmarks` come heaviest first. The first scan with
  /// enough landmarks defines the map frame: its pose is the origin. Fix::time is the caller's.
  [[nodiscard]] Fix process(std::span<const ScanLandmark> landmarks, const Deadline& deadline) noexcept;

  /// Forgets everything; the next scan starts a new map, unless frozen.
  void reset() noexcept;

  /// Replaces all hypotheses by the one that `state` was taken of; scans go on being counted from there. The
  /// next scan is localised in it like any other, as the hypothesis itself would have done it. A flawed state
  /// is refused and changes nothing. Where there was a hypothesis before, this counts as a jump.
  [[nodiscard]] MapCheck restore(const MapState& state) noexcept;

  /// From the next scan on maps, paths and weights change no more, or do again. A frozen set without a map
  /// gives no fix and starts none.
  void set_frozen(Frozen frozen) noexcept { frozen_ = frozen; }
  [[nodiscard]] Frozen frozen() const noexcept { return frozen_; }

  /// The best hypothesis as it stands, valid until the next change; without landmarks when there is none.
  [[nodiscard]] MapState state() const noexcept;

  /// Grows whenever map or path of the best hypothesis change, and never falls.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }

  /// Goes on with the best hypothesis alone, as if it had been restored.
  void drop_rivals() noexcept;

  /// Number of hypotheses that are kept now.
  [[nodiscard]] std::size_t size() const noexcept { return kept_.size(); }

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
  using Generation = FixedVector<Offspring, kHypothesesMax>;

  void take_landmarks(std::span<const ScanLandmark> landmarks) noexcept;
  void start(Fix& fix) noexcept;
  void localise(const Deadline& deadline, Fix& fix) noexcept;
  void associate_first(std::size_t hypotheses, const Deadline& deadline) noexcept;
  [[nodiscard]] Generation spawn() const noexcept;
  void replace(const Generation& generation) noexcept;
  void report(const Offspring& best, Fix& fix) noexcept;
  void extend(std::uint32_t slot, const Offspring& offspring) noexcept;

  Config config_;
  PaperSearch search_;
  MapBuilder builder_;
  std::array<std::optional<Hypothesis>, kHypothesesMax> pool_;  // the first hypotheses_max exist
  FixedVector<std::uint32_t, kHypothesesMax> kept_;             // slots of pool_, best W first
  BoundedVector<Point2> scan_B_;     // in the body frame: what core localises is the body
  BoundedVector<Candidates> found_;  // per place in kept_
  Counters counters_;
  Frozen frozen_ = Frozen::No;
  std::uint64_t revision_ = 0;
  std::uint32_t scans_ = 0;
  std::uint32_t jumps_ = 0;
};

}  // namespace slamsensor::core
