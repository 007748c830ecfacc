#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "hal/pantilt/ptu_axis.hpp"
#include "hal/pantilt/ptu_config.hpp"
#include "hal/pantilt/ptu_exchange.hpp"
#include "hal/pantilt/ptu_finder.hpp"
#include "hal/stamp.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace slamsensor::hal {

/// Finds out that both axes rest: their positions stay the same over several rounds of polls, without a limit
/// report in between (a reset drives from stop to stop, and may hold an axis still for a while).
class PtuRest {
 public:
  void restart() noexcept;

  /// The axis to ask next: they take turns.
  [[nodiscard]] Axis next() const noexcept { return next_; }

  void answer(std::int32_t position) noexcept;

  /// Something says that an axis moves.
  void disturb() noexcept { rounds_ = 0; }

  [[nodiscard]] bool resting() const noexcept;
  [[nodiscard]] std::int32_t position(Axis axis) const noexcept {
    return positions_[static_cast<std::size_t>(axis)];
  }

 private:
  std::array<std::int32_t, 2> positions_{};
  Axis next_ = Axis::Pan;
  int rounds_ = 0;  // answers in a row that were as before
};

/// Brings a unit from whatever state it is in to one the driver can work with: finds it, leaves slaved and
/// velocity mode, turns the limits on, waits until it rests, asks for its facts, resets it where configured.
/// Never saves anything in the unit (but for the network recovery, if configured) and never sets its
/// acceleration, base or bounding speeds, which takes some firmware minutes.
class PtuStartup {
 public:
  /// All of them outlive this.
  PtuStartup(ByteLink& link, const PtuConfig& config, PtuCounters& counters, PtuExchange& exchange);

  /// Starts from the top at the rate that worked last.
  void begin(Stamp now) noexcept;

  /// As begin(), for a unit that has been switched on just now.
  void begin_powered(Stamp now) noexcept;

  /// The line is new: what was learnt of the unit's rates no longer counts.
  void renew() noexcept { finder_.renew(); }

  /// The unit has refused a move because an axis has not found its zero: reset it at the next start-up, if
  /// the configuration allows it.
  void want_reset() noexcept { reset_wanted_ = config_.reset != PtuReset::Never; }

  /// The unit was lost sight of while it was not at home. If it is found there, it has reset itself or was
  /// switched off meanwhile, and nobody saw whether that went well: it is reset, if the configuration allows.
  void note_away() noexcept { is_away_ = true; }

  enum class Progress : std::uint8_t { Running, Done, Faulted };

  /// Goes on; the exchange has been stepped.
  Progress step(Stamp now, const PtuExchange::Notices& notices) noexcept;

  /// What is being waited for.
  [[nodiscard]] std::string_view problem() const noexcept;

  /// Of a unit that is Done.
  [[nodiscard]] const PtuAxisFacts& facts(Axis axis) const noexcept {
    return axis == Axis::Pan ? pan_ : tilt_;
  }
  [[nodiscard]] std::int32_t position(Axis axis) const noexcept { return rest_.position(axis); }

 private:
  enum class Phase : std::uint8_t {
    Finding,
    Independent,
    Immediate,
    Halt,
    Limits,
    Rest,
    Facts,
    Reset,
    Done,
    Faulted
  };

  void enter(Phase phase, Stamp now) noexcept;
  void settle_again(Stamp now) noexcept;
  void heed(const PtuExchange::Notices& notices, Stamp now) noexcept;
  void send_next(Stamp now) noexcept;
  [[nodiscard]] std::optional<PtuCommand> next_command() const noexcept;
  void on_answer(const PtuAnswer& answer, Stamp now) noexcept;
  void on_setting(const PtuAnswer& answer, Stamp now) noexcept;
  void on_rest(const PtuAnswer& answer, Stamp now) noexcept;
  void on_fact(const PtuAnswer& answer, Stamp now) noexcept;
  void on_reset(const PtuAnswer& answer, Stamp now) noexcept;
  void judge_facts(Stamp now) noexcept;
  [[nodiscard]] bool take_facts() noexcept;
  void fault(std::string_view problem, Stamp now) noexcept;
  [[nodiscard]] bool limits_quiet(Stamp now) const noexcept;

  const PtuConfig& config_;
  PtuCounters& counters_;
  PtuExchange& exchange_;
  PtuFinder finder_;
  PtuInquiry inquiry_;
  PtuRest rest_;
  PtuAxisFacts pan_;
  PtuAxisFacts tilt_;
  Phase phase_ = Phase::Finding;
  std::string_view fault_;
  Stamp wait_until_{};
  Stamp rest_end_{};            // a unit that does not rest until then is at fault
  std::optional<Stamp> limit_;  // last limit report
  std::uint32_t resets_ = 0;
  std::uint32_t settled_again_ = 0;
  bool reset_wanted_ = false;
  Stamp seen_{};             // its last answer
  bool refused_ = false;     // the last query
  bool reset_done_ = false;  // and neither another one nor a time unseen since
  bool is_away_ = false;
};

}  // namespace slamsensor::hal
