#pragma once

#include "hal/pantilt/pan_tilt.hpp"
#include "hal/pantilt/ptu_command.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace slamsensor::hal {

/// What a unit tells of one axis, in its own units.
struct PtuAxisFacts {
  std::int32_t min_position = 0;
  std::int32_t max_position = 0;
  std::int32_t speed_min_ps = 0;  ///< positions/s, as the next two
  std::int32_t speed_max_ps = 0;
  std::int32_t base_speed_ps = 0;
  double acceleration_ps2 = 0.0;  ///< positions/s^2
  double position_rad = 0.0;      ///< of one position, positive
};

/// Asks a unit for everything that must not be assumed of it. Each question is put until two answers in a row
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

}  // namespace slamsensor::hal
