#pragma once

#include "core/association/candidate.hpp"
#include "core/config.hpp"
#include "core/limits.hpp"
#include "core/memory/arena.hpp"
#include "core/memory/bounded_vector.hpp"
#include "core/memory/fixed_vector.hpp"

#include <cstddef>
#include <cstdint>

namespace slamsensor::core {

/// The best candidates of a search, and which correspondence vertices (scan landmark * map size + map
/// landmark) their matches cover, a bit per candidate. One thread.
class Shortlist {
 public:
  Shortlist(Arena& arena, const AssociationConfig& config, std::size_t vertices_max) noexcept;

  /// Empties `found` for a search over `vertices` vertices of a map of `map_size` landmarks; at most
  /// `variants_max` candidates are kept at one place. False when there are more vertices than capacity.
  [[nodiscard]] bool start(std::size_t vertices, std::uint32_t map_size, std::uint32_t variants_max,
                           const ScanMoments& moments, Candidates& found) noexcept;

  /// Whether one kept candidate matches all three vertices.
  [[nodiscard]] bool covers(std::uint32_t a, std::uint32_t b, std::uint32_t c) const noexcept {
    return (covered_by_[a] & covered_by_[b] & covered_by_[c]) != 0;
  }

  /// Inserts the candidate in order, unless a better one has the same pose or `variants_max` better ones are
  /// at the same place already; drops what it makes superfluous.
  void offer(const Candidate& candidate, Candidates& found) noexcept;

 private:
  [[nodiscard]] bool leads(const Candidate& a, const Candidate& b) const noexcept;
  [[nodiscard]] bool make_place(const Candidate& candidate, Candidates& found) noexcept;
  void insert(const Candidate& candidate, Candidates& found) noexcept;
  void drop(std::size_t index, Candidates& found) noexcept;
  void mark(const MatchList& matches, std::uint32_t slot, bool covered) noexcept;

  CandidateRank rank_;
  double same_place_m_;
  BoundedVector<std::uint32_t> covered_by_;             // per vertex
  FixedVector<std::uint32_t, kCandidatesMax> slot_of_;  // bit of each kept candidate
  std::uint32_t free_slots_ = 0;
  std::uint32_t map_size_ = 0;
  std::uint32_t variants_max_ = 1;
  ScanMoments moments_{{}};
};

}  // namespace slamsensor::core
