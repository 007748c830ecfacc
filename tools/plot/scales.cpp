#include "tools/plot/scales.hpp"

#include "tools/output/text_output.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace slamsensor::tools {
namespace {

constexpr std::size_t kTicksMax = 1000;
constexpr int kLogTicksMax = 10;
// Steps and limits are sums of a few roundings; a tick this close to its limit is meant to be on it.
constexpr double kSlack = 1e-9;

int exponent_of(double value) {
  return static_cast<int>(std::floor(std::log10(value) + kSlack));
}

bool reaches(double value, double limit) {
  return value >= limit * (1.0 - kSlack);
}

}  // namespace

double round_step_up(double step) {
  const double base = std::pow(10.0, exponent_of(step));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (reaches(factor * base, step)) return factor * base;
  }
  return 10.0 * base;
}

double round_step_down(double step) {
  const double base = std::pow(10.0, exponent_of(step));
  for (const double factor : {5.0, 2.0}) {
    if (reaches(step, factor * base)) return factor * base;
  }
  return base;
}

std::vector<double> linear_ticks(double low, double high, double step) {
  std::vector<double> ticks;
  const double first = std::ceil(low / step - kSlack);
  const double last = std::floor(high / step + kSlack);
  for (double i = first; i <= last && ticks.size() < kTicksMax; i += 1.0) ticks.push_back(i * step);
  return ticks;
}

std::string tick_text(double value, double step) {
  std::string text;
  if (step >= 1e6 || step < 1e-6) {
    append_general(text, std::abs(value) < 0.5 * step ? 0.0 : value, 6);
  } else {
    append_fixed(text, value, std::max(0, -exponent_of(step)));
  }
  return text;
}

std::vector<LogTick> log_ticks(double low, double high) {
  const int first = exponent_of(low);
  const int last = exponent_of(high);
  const int powers = last - first + 1;
  const int stride = std::max(1, (powers + kLogTicksMax - 1) / kLogTicksMax);
  std::vector<LogTick> ticks;
  for (int exponent = first; exponent <= last; ++exponent) {
    for (const int factor : {1, 2, 5}) {
      if (factor > 1 && powers > 3) break;
      const double value = factor * std::pow(10.0, exponent);
      const bool is_inside = reaches(value, low) && reaches(high, value);
      if (is_inside && exponent % stride == 0) ticks.push_back({factor, exponent, value});
    }
  }
  return ticks;
}

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
