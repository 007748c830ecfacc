#pragma once

#include <cstdint>
#include <string>
#include <string_view>
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

/// Colours of the pictures. Those of lines are Okabe and Ito's, told apart by all kinds of colour vision; the
/// scale is viridis without its lightest end, which is lost on white paper.
inline constexpr std::string_view kInk = "#1a1a1a";
inline constexpr std::string_view kSoftInk = "#555555";
inline constexpr std::string_view kGrid = "#e6e6e6";
inline constexpr std::string_view kHeadingColour = "#0072b2";
inline constexpr std::string_view kTruthColour = "#d55e00";
inline constexpr std::string_view kMatchColour = "#cc79a7";

/// A class of xi with a colour of its own: first <= xi <= last.
struct XiClass {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  std::string colour;  ///< "#rrggbb"
};

/// Classes that cover 0..max_xi without a gap, at most 10, all of the same round width.
[[nodiscard]] std::vector<XiClass> xi_classes(std::uint32_t max_xi);

/// The class's label: "3" or "10–19".
[[nodiscard]] std::string class_text(const XiClass& xi_class);

}  // namespace slamsensor::tools
