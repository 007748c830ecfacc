#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// Colours of the pictures. Those of lines are Okabe and Ito's, told apart by all kinds of colour vision; the
/// scale is viridis without its lightest end, which is lost on white paper.
inline constexpr std::string_view kInk = "#1a1a1a";
inline constexpr std::string_view kSoftInk = "#555555";
inline constexpr std::string_view kGrid = "#e6e6e6";
inline constexpr std::string_view kPathColour = "#1a1a1a";
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
