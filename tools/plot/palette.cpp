#include "tools/plot/palette.hpp"

#include "tools/plot/axis_ticks.hpp"

#include <array>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr double kClassesMax = 10.0;
constexpr double kScaleEnd = 0.85;

struct Rgb {
  double red;
  double green;
  double blue;
};

// Viridis (S. van der Walt, N. Smith; matplotlib), every tenth of the scale.
constexpr std::array<Rgb, 11> kViridis{{{68, 1, 84},
                                        {72, 36, 117},
                                        {65, 68, 135},
                                        {53, 95, 141},
                                        {42, 120, 142},
                                        {33, 145, 140},
                                        {34, 168, 132},
                                        {68, 191, 112},
                                        {122, 209, 81},
                                        {189, 223, 38},
                                        {253, 231, 37}}};

void append_hex(std::string& out, double channel) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  const auto value = static_cast<std::size_t>(std::lround(channel));
  out += kDigits[value / 16];
  out += kDigits[value % 16];
}

// `share` in [0, 1).
std::string viridis(double share) {
  const double place = share * static_cast<double>(kViridis.size() - 1);
  const auto index = static_cast<std::size_t>(place);
  const double rest = place - static_cast<double>(index);
  const Rgb& a = kViridis[index];
  const Rgb& b = kViridis[index + 1];
  std::string colour = "#";
  append_hex(colour, a.red + rest * (b.red - a.red));
  append_hex(colour, a.green + rest * (b.green - a.green));
  append_hex(colour, a.blue + rest * (b.blue - a.blue));
  return colour;
}

}  // namespace

std::vector<XiClass> xi_classes(std::uint32_t max_xi) {
  const double values = static_cast<double>(max_xi) + 1.0;
  const auto width = static_cast<std::uint64_t>(
      values <= kClassesMax ? 1.0 : std::round(round_step_up(values / kClassesMax)));
  const std::uint64_t count = max_xi / width + 1;
  std::vector<XiClass> classes;
  for (std::uint64_t i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / static_cast<double>(count - 1) : 0.0;
    classes.push_back({i * width, (i + 1) * width - 1, viridis(kScaleEnd * share)});
  }
  return classes;
}

std::string class_text(const XiClass& xi_class) {
  if (xi_class.first == xi_class.last) return std::to_string(xi_class.first);
  return std::to_string(xi_class.first) + "\xE2\x80\x93" + std::to_string(xi_class.last);
}

}  // namespace slamsensor::tools
