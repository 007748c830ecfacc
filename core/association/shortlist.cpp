#include "core/association/shortlist.hpp"

#include <algorithm>

namespace slamsensor::core {
namespace {

constexpr double kSamePoseShare = 0.1;  // of the distance within which two poses are at the same place

}  // namespace

Shortlist::Shortlist(Arena& arena, const AssociationConfig& config, std::size_t vertices_max) noexcept
    : rank_(config.rank),
      same_place_m_(config.tolerance_m),
      covered_by_(arena, "association: vertex candidates", vertices_max) {
}

bool Shortlist::start(std::size_t vertices, std::uint32_t map_size, std::uint32_t variants_max,
                      const ScanMoments& moments, Candidates& found) noexcept {
  found.list.clear();
  slot_of_.clear();
  free_slots_ = UINT32_MAX;
  map_size_ = map_size;
  variants_max_ = variants_max;
  moments_ = moments;
  if (!covered_by_.try_resize(vertices)) {
    return false;
  }
  std::fill(covered_by_.begin(), covered_by_.end(), 0U);
  return true;
}

bool Shortlist::leads(const Candidate& a, const Candidate& b) const noexcept {
  return rank_ == CandidateRank::Matches ? a.matches_more_than(b) : a.more_significant_than(b);
}

void Shortlist::mark(const MatchList& matches, std::uint32_t slot, bool covered) noexcept {
  for (const Match& m : matches) {
    std::uint32_t& mask = covered_by_[m.scan * map_size_ + m.map];
    mask = covered ? mask | (1U << slot) : mask & ~(1U << slot);
  }
}

void Shortlist::drop(std::size_t index, Candidates& found) noexcept {
  mark(found.list[index].matches, slot_of_[index], false);
  free_slots_ |= 1U << slot_of_[index];
  for (std::size_t i = index + 1; i < found.list.size(); ++i) {
    found.list[i - 1] = found.list[i];
    slot_of_[i - 1] = slot_of_[i];
  }
  found.list.truncate(found.list.size() - 1);
  slot_of_.truncate(slot_of_.size() - 1);
}

/// False when the candidate is not wanted; else what it makes superfluous is gone and there is room for it.
bool Shortlist::make_place(const Candidate& candidate, Candidates& found) noexcept {
  std::uint32_t here = 0;  // better ones at the same place, then worse ones that may stay beside it
  for (std::size_t i = 0; i < found.list.size();) {
    const double apart_m = moments_.displacement_m(found.list[i].pose_W, candidate.pose_W);
    const bool same_pose = apart_m <= kSamePoseShare * same_place_m_;
    here += apart_m <= same_place_m_ ? 1 : 0;
    if (!leads(candidate, found.list[i])) {
      if (same_pose || here >= variants_max_) {
        return false;
      }
      ++i;
    } else if (same_pose || (apart_m <= same_place_m_ && here >= variants_max_)) {
      drop(i, found);
    } else {
      ++i;
    }
  }
  if (found.list.size() == kCandidatesMax) {
    if (!leads(candidate, found.list.back())) {
      return false;
    }
    drop(kCandidatesMax - 1, found);
  }
  return true;
}

void Shortlist::insert(const Candidate& candidate, Candidates& found) noexcept {
  const auto slot = static_cast<std::uint32_t>(__builtin_ctz(free_slots_));
  free_slots_ &= ~(1U << slot);
  mark(candidate.matches, slot, true);
  std::size_t place = found.list.size();
  SLAMSENSOR_ASSERT(found.list.try_push_back(candidate) && slot_of_.try_push_back(slot));
  for (; place > 0 && leads(candidate, found.list[place - 1]); --place) {
    found.list[place] = found.list[place - 1];
    slot_of_[place] = slot_of_[place - 1];
  }
  found.list[place] = candidate;
  slot_of_[place] = slot;
}

void Shortlist::offer(const Candidate& candidate, Candidates& found) noexcept {
  if (make_place(candidate, found)) {
    insert(candidate, found);
  }
}

}  // namespace slamsensor::core
