#pragma once

#include "tools/eval/evaluation.hpp"
#include "tools/input/text.hpp"
#include "tools/plot/curve_plot.hpp"

#include <tl/expected.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace slamsensor::tools {

/// A scan of a replay as fixes.csv tells it; what is empty there is absent.
struct ReportRow {
  double t_s = 0.0;  ///< the time stamp of its line in trajectory.tum
  bool is_fix = false;
  std::optional<double> sigma_m;  ///< of the position in the home frame: the root of the sum of the variances
  std::optional<double> protection_radius_m;
  std::optional<double> xi;
  double matches = 0.0;
  double seen = 0.0;
  std::optional<double> milliseconds;
};

/// The rows of fixes.csv. An error names file and line.
[[nodiscard]] tl::expected<std::vector<ReportRow>, InputError> parse_report_rows(std::string_view text,
                                                                                 std::string_view name);

/// A plot of a report and the name of its file, without the suffix.
struct ReportPlot {
  std::string name;
  CurvePlot plot;
};

/// The plots that `rows` allow: matches and time per scan, and, given the fixes' errors against the truth,
/// the error along the path, sigma against error, and error against xi.
[[nodiscard]] std::vector<ReportPlot> report_plots(const std::vector<ReportRow>& rows,
                                                   const std::optional<AlignedErrors>& errors);

}  // namespace slamsensor::tools
