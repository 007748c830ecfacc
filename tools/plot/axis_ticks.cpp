#include "tools/plot/axis_ticks.hpp"

#include "tools/output/number_text.hpp"

#include <algorithm>
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

}  // namespace slamsensor::tools
