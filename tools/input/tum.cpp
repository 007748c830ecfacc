#include "tools/input/tum.hpp"

#include "tools/input/file.hpp"
#include "tools/input/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

namespace slamsensor::tools {
namespace {

constexpr double kLengthTolerance = 0.01;  // of a quaternion; files are written with two or more decimals
constexpr double kLevelMin = 1e-6;         // cosine of the pitch below which there is no heading to speak of

struct Row {
  TimedPose pose;
  std::size_t line = 0;
};

tl::expected<std::array<double, 8>, InputError> parse_numbers(std::string_view line, std::string_view name,
                                                              std::size_t number) {
  constexpr std::array<std::string_view, 8> kNames{"t", "x", "y", "z", "qx", "qy", "qz", "qw"};
  std::array<double, 8> values{};
  std::string_view rest = line;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string_view word = take_word(rest);
    const std::optional<double> value = parse_number(word);
    if (!value || !std::isfinite(*value)) {
      return refuse_line(name, number,
                         std::string(kNames[i]) + " is " + in_quotes(word) +
                             "; a line must hold eight finite numbers: t x y z qx qy qz qw");
    }
    values[i] = *value;
  }
  if (const std::string_view more = take_word(rest); !more.empty()) {
    return refuse_line(name, number,
                       in_quotes(more) + " follows the eight numbers t x y z qx qy qz qw; remove it");
  }
  return values;
}

// Yaw of the rotation R_z(yaw) R_y(pitch) R_x(roll); nothing when the x axis points straight up or down.
std::optional<double> yaw_rad(double qx, double qy, double qz, double qw) {
  const double forward_x = 1.0 - 2.0 * (qy * qy + qz * qz);
  const double forward_y = 2.0 * (qw * qz + qx * qy);
  if (std::hypot(forward_x, forward_y) < kLevelMin) {
    return std::nullopt;
  }
  return core::wrap_angle(std::atan2(forward_y, forward_x));
}

tl::expected<Row, InputError> parse_row(std::string_view line, std::string_view name, std::size_t number) {
  const auto values = parse_numbers(line, name, number);
  if (!values) {
    return tl::unexpected(values.error());
  }
  const auto& [t, x_m, y_m, z_m, qx, qy, qz, qw] = *values;
  const double length = std::sqrt(qx * qx + qy * qy + qz * qz + qw * qw);
  if (!(std::abs(length - 1.0) <= kLengthTolerance)) {
    return refuse_line(
        name, number,
        "the quaternion has length " + shown(length) + "; it must be 1 within 1 %, in the order qx qy qz qw");
  }
  const std::optional<double> heading_rad = yaw_rad(qx / length, qy / length, qz / length, qw / length);
  if (!heading_rad) {
    return refuse_line(name, number, "the pose points straight up or down and so has no heading; remove it");
  }
  return Row{TimedPose{t, core::Pose2{x_m, y_m, *heading_rad}}, number};
}

}  // namespace

tl::expected<std::vector<TimedPose>, InputError> parse_tum(std::string_view text, std::string_view name) {
  if (auto checked = check_encoding(text, name); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  std::vector<Row> rows;
  LineReader lines(text);
  while (lines.next()) {
    auto row = parse_row(lines.line(), name, lines.number());
    if (!row) {
      return tl::unexpected(std::move(row.error()));
    }
    rows.push_back(*row);
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.pose.t < b.pose.t; });
  std::vector<TimedPose> poses;
  poses.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && rows[i].pose.t == rows[i - 1].pose.t) {
      return refuse_line(
          name, rows[i].line,
          "t has the same value as in line " + std::to_string(rows[i - 1].line) + "; remove one");
    }
    poses.push_back(rows[i].pose);
  }
  return poses;
}

tl::expected<std::vector<TimedPose>, InputError> read_tum(const std::filesystem::path& path) {
  return read_file(path).and_then([&](const std::string& text) { return parse_tum(text, path.string()); });
}

}  // namespace slamsensor::tools
