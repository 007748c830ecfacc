#pragma once

#include "hal/stamp.hpp"

#include <cstdint>

namespace slamsensor::firmware {

/// Says when a map that has changed is to be saved. Time is an argument.
class AutosavePolicy {
 public:
  /// `period` between two saves; 0: none is ever due. `now` is the start.
  AutosavePolicy(hal::Stamp period, hal::Stamp now) noexcept : period_(period), next_(now + period) {}

  /// What stands in the store is `revision` (Slam::revision): it was loaded, or saved by whomever.
  void saved(std::uint64_t revision, hal::Stamp now) noexcept;

  /// A save was tried and failed: the next is due after twice the time of the last, at first after the period
  /// or a second, whichever is longer, at last every 15 minutes or the period, whichever is longer.
  void failed(hal::Stamp now) noexcept;

  /// Takes effect from the last save on, and at once when a shorter period is over.
  void set_period(hal::Stamp period) noexcept;

  /// Whether `revision` is not in the store.
  [[nodiscard]] bool is_unsaved(std::uint64_t revision) const noexcept { return revision != saved_; }

  /// Whether `revision` is to be saved now.
  [[nodiscard]] bool is_due(std::uint64_t revision, hal::Stamp now) const noexcept {
    return period_ > hal::Stamp{} && is_unsaved(revision) && now >= next_;
  }

 private:
  hal::Stamp period_;
  hal::Stamp next_;        // no save is due before
  hal::Stamp back_off_{};  // after the last failure; 0: the last save did not fail
  std::uint64_t saved_ = 0;
};

}  // namespace slamsensor::firmware
