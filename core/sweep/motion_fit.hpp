#pragma once

#include "core/memory/fixed_vector.hpp"
#include "core/sweep/marks.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace slamsensor::core {

/// How the sensor would have moved.
enum class MotionKind : std::uint8_t {
  Jump,   ///< once: all that was seen before is displaced by the same
  Creep,  ///< steadily: what was first seen longer ago is displaced by more
};

/// How the sensor moved in its own plane between two lines, by what they saw: x' forward, y' left, turned
/// counter-clockwise. Of a creep: over the longest time between two sights of a mark.
struct MotionEstimate {
  double x_m = 0.0;
  double y_m = 0.0;
  double turn_rad = 0.0;
  double distance_m = 0.0;        ///< of x_m, y_m
  double distance_sigma_m = 0.0;  ///< 1 sigma along x_m, y_m
  double turn_sigma_rad = 0.0;
  double agreeing = 0.0;  ///< [0, 1] share of what the marks say that bears it out
};

/// Fits MotionEstimate to the shifts of marks, robustly (Huber, then Tukey). What is
/// seen at different heights is displaced also without motion: by a mount that leans, all along one line, and
/// by shapes that recede with height; both are fitted beside it. Its sigmas are the greater of those by
/// scatter and of those by leaving out one sector of bearings after the other (jackknife), so that what moves
/// by itself in one direction moves nothing. No allocation after construction; one thread.
class MotionFitter {
 public:
  /// Nothing when the shifts are fewer than `things_min`, or all in one direction.
  [[nodiscard]] std::optional<MotionEstimate> fit(std::span<const MarkShift> shifts, MotionKind kind,
                                                  std::uint32_t things_min) noexcept;

 private:
  static constexpr std::size_t kUnknowns = 6;  // x, y, turn, recession, lean along x and y
  static constexpr std::size_t kSectors = 12;

  /// One equation: coefficients * unknowns = value, in sigmas.
  struct Row {
    std::array<double, kUnknowns> coefficients{};
    double value = 0.0;
    double residual = 0.0;
    double weight = 1.0;
    std::size_t sector = 0;
  };
  using Solution = std::array<double, kUnknowns>;
  struct Normal;  // equations

  void collect(std::span<const MarkShift> shifts, MotionKind kind) noexcept;
  void add_row(const std::array<double, 3>& motion, double recession, double value, double sigma) noexcept;
  void update_residuals(const Solution& solution) noexcept;
  [[nodiscard]] double scale() noexcept;
  void weigh_huber() noexcept;
  void weigh_tukey() noexcept;
  [[nodiscard]] MotionEstimate judge() noexcept;

  FixedVector<Row, 2 * kMarksMax> rows_;
  std::array<double, 2 * kMarksMax> sorted_{};
  double scale_ = 1.0;
  double age_share_ = 1.0;  // of the shift that is being collected
  double rise_m_ = 0.0;
  std::size_t sector_ = 0;
};

}  // namespace slamsensor::core
