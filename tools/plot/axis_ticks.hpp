#pragma once

#include <string>
#include <vector>

namespace slamsensor::tools {

/// The smallest of 1, 2 and 5 times a power of ten that is at least `step` (> 0).
[[nodiscard]] double round_step_up(double step);

/// The largest of 1, 2 and 5 times a power of ten that is at most `step` (> 0).
[[nodiscard]] double round_step_down(double step);

/// All multiples of `step` (> 0) in [low, high], at most 1000.
[[nodiscard]] std::vector<double> linear_ticks(double low, double high, double step);

/// `value` with as many decimals as `step` has; an exponent for steps of 1e6 and more or below 1e-6.
[[nodiscard]] std::string tick_text(double value, double step);

/// A tick of a logarithmic axis: factor * 10^exponent.
struct LogTick {
  int factor = 1;
  int exponent = 0;
  double value = 1.0;
};

/// The ticks of a logarithmic axis in [low, high] (> 0): powers of ten, every so many that there are at most
/// 10; with their double and fivefold where there are fewer than three powers of ten.
[[nodiscard]] std::vector<LogTick> log_ticks(double low, double high);

}  // namespace slamsensor::tools
