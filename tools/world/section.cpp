#include "tools/world/section.hpp"

#include <charconv>
#include <cmath>

namespace slamsensor::tools {
namespace {

std::string name_of(const Section& section, const std::string& key) {
  return section.name.empty() ? key : section.name + "." + key;
}

}  // namespace

std::optional<double> number_of(const Field& field) noexcept {
  if (const auto* real = std::get_if<double*>(&field.value)) {
    return **real / field.scale;
  }
  if (const auto* small = std::get_if<std::uint32_t*>(&field.value)) {
    return **small;
  }
  return std::nullopt;
}

std::string text_of(double number) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof(buffer), number).ptr;
  return {buffer, end};
}

std::string out_of_range(const Section& section, const Field& field, double number) {
  return name_of(section, field.key) + " = " + text_of(number) + " is out of range: " + text_of(field.min) +
         " to " + text_of(field.max);
}

std::optional<WorldError> find_problem(const Section& section) {
  for (const Field& field : section.fields) {
    const std::optional<double> number = number_of(field);
    const double slack = number ? 1e-9 * std::abs(*number) : 0.0;  // degrees that went to radians and back
    if (number && !(*number >= field.min - slack && *number <= field.max + slack)) {
      return WorldError{out_of_range(section, field, *number)};
    }
  }
  for (const auto& [name, interval] : section.intervals) {
    if (interval->min > interval->max) {
      return WorldError{name_of(section, name) + ": the least, " + text_of(interval->min) +
                        ", exceeds the greatest, " + text_of(interval->max) + "; swap them"};
    }
  }
  return std::nullopt;
}

}  // namespace slamsensor::tools
