#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "hal/stamp.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace slamsensor::hal {

/// A position as the unit reported it: the axis was there within stamp - half_width and stamp + half_width.
struct PtuSighting {
  Stamp stamp{};
  Stamp half_width{};
  std::int32_t position = 0;
};

enum class PtuVerdict : std::uint8_t {
  Believed,
  Held,         ///< plausible; believed as soon as the next one agrees with it
  Unproven,     ///< plausible, but the way of the axis is not known
  Implausible,  ///< not believed; poll again
  Stuck,        ///< the axis has not left the start of its move: the move never reached it
  Lost,         ///< positions are steadily not what they should be; the axis must be set up again
};

struct PtuJudgement {
  PtuVerdict verdict = PtuVerdict::Implausible;
  std::optional<PtuSighting> earlier;  ///< was Held, now believed too
};

/// What the driver knows of where an axis must be, against which reported positions are judged. A terse
/// position has no check sum: a lost digit or sign leaves a number as good as any. So a resting axis must
/// report its place exactly, and a moving one must lag behind its profile by the same time from poll to poll,
/// within what the stamps allow. An axis that is under way to its target, but not as its profile says, is
/// judged by what no ramp can break: it stays between start and target, goes no way back, and is not faster
/// than its speed.
class PtuTrack {
 public:
  /// One position of the unit in rad, signed by the sense of the axis; the axis rests at `position`.
  /// `speed_max_radps`: no axis is faster. `slack`: what stamps may err beyond their half width.
  void set_up(double position_rad, double speed_max_radps, Stamp slack) noexcept;

  void rest(std::int32_t position) noexcept;

  /// A move whose course is known, begun at `begun` but for a constant lag between -`early` and `late`.
  struct Way {
    MotionProfile profile;
    Stamp begun{};
    std::int32_t start = 0;
    std::int32_t target = 0;
    Stamp early{};
    Stamp late{};
    double speed_radps = 0.0;  ///< that the axis is to reach; 0: the greatest that it can
  };
  void follow(const Way& way) noexcept;

  /// The axis is under way on a course that is not known; it rests when it reports the same place three
  /// times.
  void roam() noexcept;

  [[nodiscard]] PtuJudgement judge(const PtuSighting& sighting) noexcept;

  [[nodiscard]] bool resting() const noexcept { return state_ == State::Resting; }

  /// Where it rests, else where it was last believed to be.
  [[nodiscard]] std::int32_t position() const noexcept { return position_; }

 private:
  enum class State : std::uint8_t { Resting, Following, Bounded, Roaming };
  struct Lag {
    double low_s = 0.0;
    double high_s = 0.0;
    bool bounded = false;  // seen between start and target
  };

  [[nodiscard]] PtuJudgement doubt(PtuVerdict verdict) noexcept;
  [[nodiscard]] PtuJudgement believe(const PtuSighting& sighting) noexcept;
  [[nodiscard]] PtuJudgement judge_way(const PtuSighting& sighting) noexcept;
  [[nodiscard]] PtuJudgement judge_profile(const PtuSighting& sighting) noexcept;
  [[nodiscard]] PtuJudgement judge_bounded(const PtuSighting& sighting) noexcept;
  [[nodiscard]] bool is_on_way(const PtuSighting& sighting,
                               const std::optional<PtuSighting>& before) const noexcept;
  [[nodiscard]] double way_speed_radps() const noexcept;
  [[nodiscard]] PtuJudgement judge_lag(const PtuSighting& sighting, const Lag& lag) noexcept;
  [[nodiscard]] PtuJudgement judge_roaming(const PtuSighting& sighting) noexcept;
  [[nodiscard]] std::optional<Lag> lag_of(const PtuSighting& sighting) const noexcept;
  void narrow(const Lag& lag, Stamp seen) noexcept;
  [[nodiscard]] bool agree(const Lag& a, const Lag& b) const noexcept;

  double position_rad_ = 0.0;
  double speed_max_radps_ = 0.0;
  double slack_s_ = 0.0;
  State state_ = State::Resting;
  std::int32_t position_ = 0;
  Way way_;
  std::optional<Lag> anchor_;  // what those believed between start and target have in common
  Stamp anchored_{};
  std::optional<Lag> candidate_;  // of the last one that was not
  std::optional<PtuSighting> last_;
  int agreed_ = 0;                       // with candidate_, in a row
  int same_ = 0;                         // places in a row, at the target or roaming
  int doubted_ = 0;                      // in a row
  std::optional<PtuSighting> way_seen_;  // the last one; when Bounded, that was believed
  std::optional<PtuSighting> held_;      // when Bounded, after it
  int on_way_ = 0;                       // of those, in a row ...
  std::int32_t on_way_from_ = 0;         // ... beginning here
  Stamp still_since_{};                  // at the place of the last one
};

/// Compares what was seen of whole moves, from rest to rest, with how the axis says that it speeds up, and
/// finds a ramp that explains it better. No allocation; one search costs about a millisecond.
class PtuRampFit {
 public:
  /// A move begins whose start and target are known. `position_rad` and `slack` as of PtuTrack::set_up().
  void begin(const PtuTrack::Way& way, double position_rad, Stamp slack) noexcept;
  /// The move under way is not one from rest to rest.
  void cancel() noexcept { is_active_ = false; }
  void add(const PtuSighting& sighting) noexcept;

  struct Result {
    bool is_off = false;                 ///< `told` does not explain what was seen
    std::optional<AxisDynamics> better;  ///< that which does
  };
  /// The move has ended at its target. Nothing when too little was seen of it.
  [[nodiscard]] std::optional<Result> end(const AxisDynamics& told) noexcept;

 private:
  static constexpr std::size_t kSeenMax = 64;

  void thin_out() noexcept;
  [[nodiscard]] double misfit(const AxisDynamics& dynamics) const noexcept;
  [[nodiscard]] AxisDynamics best_ramp(double base_speed_radps) const noexcept;

  PtuTrack::Way way_;
  double position_rad_ = 0.0;
  double slack_s_ = 0.0;
  bool is_active_ = false;
  std::array<PtuSighting, kSeenMax> seen_;
  std::size_t seen_size_ = 0;
  std::uint32_t stride_ = 1;  // one in so many is kept
  std::uint32_t skipped_ = 0;
};

}  // namespace slamsensor::hal
