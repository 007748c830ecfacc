#pragma once

#include "hal/pantilt/ptu_config.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace slamsensor::hal {

/// Which line rate to try next: the one that worked last first, then the configured ones in turn.
class PtuRates {
 public:
  /// `config` is valid (at least one rate).
  explicit PtuRates(const PtuConfig& config);

  [[nodiscard]] std::uint32_t current() const noexcept { return rates_[index_]; }

  /// Goes on to the next rate, or back from a trial to the rate before it. What happened:
  enum class Step : std::uint8_t { Next, WentRound, TrialFailed };
  Step advance() noexcept;

  /// Whether the unit should be brought to the fast rate from here.
  [[nodiscard]] bool wants_fast() const noexcept;

  /// Goes to the fast rate, to come back at the next advance().
  void try_fast() noexcept;

  /// The current rate works.
  void confirm() noexcept;

  /// The fast rate is not tried again.
  void refuse_fast() noexcept { fast_refused_ = true; }

  /// A new line: the fast rate may be tried again.
  void renew() noexcept { fast_refused_ = false; }

  /// Goes to the rate that units in a network use, if it is among the configured ones.
  void go_to_network_rate() noexcept;

 private:
  std::vector<std::uint32_t> rates_;  // the fast one last, if it is not among the others
  std::size_t index_ = 0;
  std::size_t fast_index_ = 0;
  std::size_t before_trial_ = 0;
  std::size_t tried_ = 0;  // since the last one that worked
  bool fast_wanted_ = false;
  bool fast_refused_ = false;
  bool on_trial_ = false;
};

}  // namespace slamsensor::hal
