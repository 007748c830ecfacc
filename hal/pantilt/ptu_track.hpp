#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "hal/stamp.hpp"

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
/// within what the stamps allow.
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
  enum class State : std::uint8_t { Resting, Following, Roaming };
  struct Lag {
    double low_s = 0.0;
    double high_s = 0.0;
    bool bounded = false;  // seen between start and target
  };

  [[nodiscard]] PtuJudgement doubt(PtuVerdict verdict) noexcept;
  [[nodiscard]] PtuJudgement believe(const PtuSighting& sighting) noexcept;
  [[nodiscard]] PtuJudgement judge_way(const PtuSighting& sighting) noexcept;
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
  int agreed_ = 0;   // with candidate_, in a row
  int same_ = 0;     // places in a row, at the target or roaming
  int doubted_ = 0;  // in a row
};

}  // namespace slamsensor::hal
