#include "hal/inclination/iio_numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>

namespace slamsensor::hal {
namespace {

constexpr double kRotationSlack = 0.01;
constexpr std::string_view kSpace = " \t\r\n";

bool is_rotation(const MountMatrix& m) noexcept {
  const auto row = [&](std::size_t i, std::size_t j) {
    return m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];
  };
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      if (!(std::abs(row(i, j) - (i == j ? 1.0 : 0.0)) <= kRotationSlack)) {
        return false;
      }
    }
  }
  const double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                             m[2] * (m[3] * m[7] - m[4] * m[6]);
  return determinant > 0.0;
}

}  // namespace

std::string_view trim_iio(std::string_view text) noexcept {
  const std::size_t first = text.find_first_not_of(kSpace);
  return first == std::string_view::npos ? std::string_view()
                                         : text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

std::optional<double> parse_iio_number(std::string_view text) noexcept {
  const std::string_view number = trim_iio(text);
  double value = 0.0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<MountMatrix> parse_mount_matrix(std::string_view text) noexcept {
  MountMatrix matrix{};
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    const bool is_last = i + 1 == matrix.size();
    const std::size_t end = is_last ? text.size() : text.find(i % 3 == 2 ? ';' : ',');
    if (end == std::string_view::npos) {
      return std::nullopt;
    }
    const auto number = parse_iio_number(text.substr(0, end));
    if (!number) {
      return std::nullopt;
    }
    matrix[i] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return is_rotation(matrix) ? std::optional(matrix) : std::nullopt;
}

}  // namespace slamsensor::hal
