#pragma once

#include "hal/fixed_text.hpp"
#include "hal/pantilt/ptu_config.hpp"
#include "hal/pantilt/ptu_exchange.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>
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

/// Finds a unit on its line, whatever state it is in: tries the line rates, ends a monitor scan or half a
/// command, turns echo and sentences off, reads the version twice alike (the marker by which the exchange
/// gets back in step), and changes to the fast rate where configured. A unit that shows that it is resetting
/// is waited for.
class PtuFinder {
 public:
  /// All of them outlive this.
  PtuFinder(ByteLink& link, const PtuConfig& config, PtuCounters& counters, PtuExchange& exchange);

  /// Starts over at the rate that worked last.
  void begin(Stamp now) noexcept;

  /// Makes the settings again at a rate where the unit has answered just now.
  void settle(Stamp now) noexcept { enter(Phase::Echo, now); }

  /// Starts over at the same rate while the unit is resetting or has replied before, else at the next one.
  void fail(Stamp now) noexcept;

  /// The unit has been switched on just now: waits for its reset.
  void await_reset(Stamp now) noexcept;

  /// The line is new: the fast rate is tried again.
  void renew() noexcept { rates_.renew(); }

  /// Takes note of signs of life.
  void heed(const PtuExchange::Notices& notices, Stamp now) noexcept;

  void on_answer(const PtuAnswer& answer, Stamp now) noexcept;

  /// Sends what is due.
  void step(Stamp now) noexcept;

  [[nodiscard]] bool found() const noexcept { return phase_ == Phase::Found; }

  /// Whether a command is expected to be answered.
  [[nodiscard]] bool is_asking() const noexcept { return phase_ > Phase::Quiet && phase_ < Phase::Found; }
  [[nodiscard]] std::string_view problem() const noexcept { return problem_; }

 private:
  enum class Phase : std::uint8_t { Wake, Quiet, Echo, Feedback, Version, Rate, Found };

  void enter(Phase phase, Stamp now) noexcept;
  void wake(Stamp now) noexcept;
  void ask(Stamp now) noexcept;
  void on_version(Stamp now) noexcept;
  void on_rate(const PtuAnswer& answer, Stamp now) noexcept;
  void give_up_rate(Stamp now) noexcept;
  void recover_network(Stamp now) noexcept;
  [[nodiscard]] bool resetting() const noexcept;

  ByteLink& link_;
  const PtuConfig& config_;
  PtuCounters& counters_;
  PtuExchange& exchange_;
  PtuRates rates_;
  FixedText<kPtuLineMax> version_;  // as reported before
  Phase phase_ = Phase::Wake;
  std::string_view problem_;
  Stamp wait_until_{};
  Stamp resetting_since_{};
  std::uint32_t signs_ = 0;  // that a unit at this rate is resetting
  bool replied_ = false;     // at this rate
  std::uint32_t attempts_ = 0;
  bool recovering_ = false;
  bool recovered_ = false;
  bool refused_ = false;  // a command, since the last round of all rates
};

}  // namespace slamsensor::hal
