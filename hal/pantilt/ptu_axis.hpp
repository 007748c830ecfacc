#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "hal/pantilt/ptu_command.hpp"
#include "hal/pantilt/ptu_config.hpp"
#include "hal/pantilt/ptu_exchange.hpp"
#include "hal/pantilt/ptu_track.hpp"
#include "hal/ring.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace slamsensor::hal {

/// What a unit reports of one axis, in its own units.
struct PtuAxisFacts {
  std::int32_t min_position = 0;
  std::int32_t max_position = 0;
  std::int32_t speed_min_ps = 0;  ///< positions/s, as the next two
  std::int32_t speed_max_ps = 0;
  std::int32_t base_speed_ps = 0;
  double acceleration_ps2 = 0.0;  ///< positions/s^2
  double position_rad = 0.0;      ///< of one position, positive

  [[nodiscard]] bool operator==(const PtuAxisFacts&) const noexcept = default;
};

/// How an axis speeds up, compared with what the unit tells of it.
enum class PtuRamp : std::uint8_t {
  AsTold,
  Learnt,   ///< otherwise; what its positions show is used
  Unknown,  ///< otherwise, and not as any ramp would explain
};

/// Asks a unit for everything that must not be assumed. Each question is put until two answers in a row
/// are the same, so that neither a lost digit nor a reply out of step becomes a fact.
class PtuInquiry {
 public:
  void restart() noexcept;

  [[nodiscard]] bool done() const noexcept { return asked_ == kQuestions; }

  /// The next question; only while not done().
  [[nodiscard]] PtuCommand question() const noexcept;

  /// Takes the answer to question().
  void answer(double value) noexcept;

  /// What was answered for `axis`; nothing unless done() and every figure is possible: minimum below maximum
  /// with the zero between them, resolution 1e-6 to 1 degree, whole speeds with 0 <= minimum < maximum <=
  /// 1e6 and 0 <= base <= 1e6, acceleration 0 to 1e9.
  [[nodiscard]] std::optional<PtuAxisFacts> facts(Axis axis) const noexcept;

 private:
  static constexpr std::size_t kPerAxis = 7;
  static constexpr std::size_t kQuestions = 2 * kPerAxis;

  std::array<double, kQuestions> values_{};
  std::size_t asked_ = 0;
  std::optional<double> before_;
};

/// `facts` in rad, with the axis turned round where it counts the other way.
[[nodiscard]] AxisInfo ptu_axis_info(const PtuAxisFacts& facts, PtuSense sense) noexcept;

using PtuSamples = Ring<AxisSample, kAxisSamplesMax>;

/// One axis of a unit that is Ready: the move asked for, the move under way, and which of the reported
/// positions are believed.
class PtuAxis {
 public:
  /// All of them outlive this.
  PtuAxis(Axis axis, const PtuConfig& config, PtuCounters& counters, PtuSamples& samples) noexcept
      : axis_(axis), config_(config), counters_(counters), samples_(samples) {}

  /// The axis rests at `position` of a unit that reports `facts`.
  void set_up(const PtuAxisFacts& facts, std::int32_t position, Stamp now) noexcept;

  /// The unit is lost: no move, no position.
  void forget() noexcept;

  /// Takes a move, to be sent as next_command() says. Accepted, Busy or OutOfRange.
  [[nodiscard]] MoveStatus ask(double target_rad, double speed_radps) noexcept;

  /// What must be sent for the move asked for: its speed when the unit's may differ, then its target.
  [[nodiscard]] std::optional<PtuCommand> next_command() const noexcept;

  /// The answer to what next_command() said.
  void on_moved(const PtuAnswer& answer, Stamp now) noexcept;

  /// The unit's speed setting is no longer sure.
  void forget_speed() noexcept { speed_set_ = 0; }

  void drop_request() noexcept { request_.reset(); }

  /// The unit has confirmed a halt.
  void on_halted(Stamp now) noexcept;

  /// When the next poll is due.
  [[nodiscard]] Stamp due() const noexcept { return due_; }
  /// A poll is out. The next ones come at the configured rate on the average, at uneven distances: a steady
  /// axis is then polled at ever other places between two of its positions, which all round alike otherwise.
  void on_poll_sent(Stamp now) noexcept;
  void poll_again(Stamp now) noexcept { due_ = now; }

  /// Judges a position and delivers it if believed. False when the axis must be set up again.
  [[nodiscard]] bool on_sighting(const PtuSighting& sighting, Stamp now) noexcept;

  [[nodiscard]] const AxisStatus& status() const noexcept { return status_; }

  /// As the unit tells it, but for a ramp that was learnt.
  [[nodiscard]] const AxisInfo& info() const noexcept { return info_; }
  [[nodiscard]] PtuRamp ramp() const noexcept { return ramp_; }
  /// What the unit told.
  [[nodiscard]] const PtuAxisFacts& told() const noexcept { return told_; }

 private:
  struct Request {
    std::int32_t target = 0;
    std::int32_t speed_ps = 0;
    std::optional<Stamp> first_sent;  // of a target whose confirmation is missing
  };

  void on_speed_set() noexcept;
  void begin_move(const Request& request, const PtuAnswer& answer) noexcept;
  void deliver(const PtuSighting& sighting) noexcept;
  void end_move() noexcept;
  void judge_ramp() noexcept;
  void use(const AxisDynamics& dynamics) noexcept;
  [[nodiscard]] std::int32_t position_at(Stamp when) const noexcept;

  Axis axis_;
  const PtuConfig& config_;
  PtuCounters& counters_;
  PtuSamples& samples_;
  PtuAxisFacts facts_;
  PtuAxisFacts told_;
  PtuRamp ramp_ = PtuRamp::AsTold;
  std::optional<AxisDynamics> learnt_;
  PtuRampFit ramp_fit_;
  int ramps_off_ = 0;      // moves in a row that did not follow the ramp in use
  double unit_rad_ = 0.0;  // of one position, signed by the sense
  AxisInfo info_;
  AxisStatus status_;
  PtuTrack track_;
  std::optional<Request> request_;
  std::int32_t speed_set_ = 0;   // 0: not known
  std::int32_t move_speed_ = 0;  // of the move under way
  std::int32_t target_ = 0;      // of the move under way
  Stamp due_{};
  double dither_ = 0.0;  // 0..1
};

}  // namespace slamsensor::hal
