#include "tools/report/report_plots.hpp"

#include "tools/input/csv.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace slamsensor::tools {
namespace {

enum Column : std::size_t {
  kTime,
  kStatus,
  kSigmaX,
  kSigmaY,
  kXi,
  kProtection,
  kMatches,
  kSeen,
  kMilliseconds
};
constexpr std::array<CsvColumn, 9> kColumns{{{"t_s"},
                                             {"status"},
                                             {"sigma_x_m"},
                                             {"sigma_y_m"},
                                             {"error_xi"},
                                             {"protection_radius_m"},
                                             {"matches"},
                                             {"landmarks_seen"},
                                             {"milliseconds"}}};
constexpr CsvRange kAny{-1e300, 1e300, ""};

/// Reads fields of the current row; the first that is no number is the error.
class RowReader {
 public:
  explicit RowReader(const CsvReader& csv) : csv_(csv) {}

  std::optional<double> maybe(Column column) {
    return csv_.text(column).empty() ? std::nullopt : read(column);
  }
  double must(Column column) { return read(column).value_or(0.0); }
  [[nodiscard]] const std::optional<InputError>& error() const { return error_; }

 private:
  std::optional<double> read(Column column) {
    auto value = csv_.number(column, kAny);
    if (!value && !error_) {
      error_ = std::move(value.error());
    }
    return value ? std::optional(*value) : std::nullopt;
  }

  const CsvReader& csv_;
  std::optional<InputError> error_;
};

CurvePlot plot_of(std::string title, std::string x_label, std::string y_label) {
  CurvePlot plot;
  plot.title = std::move(title);
  plot.x_label = std::move(x_label);
  plot.y_label = std::move(y_label);
  return plot;
}

ReportPlot matches_plot(const std::vector<ReportRow>& rows) {
  CurvePlot plot = plot_of("Landmarks of each scan", "scan", "landmarks");
  plot.x_step_min = plot.y_step_min = 1.0;
  CurveSeries seen{"seen", {}, CurveStyle::Line};
  CurveSeries matches{"matched", {}, CurveStyle::Line};
  CurveSeries none{"no fix", {}, CurveStyle::Markers};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto scan = static_cast<double>(i);
    seen.points.emplace_back(scan, rows[i].seen);
    matches.points.emplace_back(scan, rows[i].matches);
    if (!rows[i].is_fix) {
      none.points.emplace_back(scan, rows[i].matches);
    }
  }
  const std::size_t without = none.points.size();
  plot.summary = {std::to_string(rows.size() - without) + " of " + std::to_string(rows.size()) +
                  " scans gave a fix"};
  plot.series = {seen, matches};
  if (without > 0) {
    plot.series.push_back(none);
  }
  return {"matches", plot};
}

ReportPlot time_plot(const std::vector<ReportRow>& rows) {
  CurvePlot plot = plot_of("Time of each scan", "scan", "ms");
  plot.x_step_min = 1.0;
  plot.y_scale = AxisScale::Logarithmic;
  CurveSeries times{"", {}, CurveStyle::Markers};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].milliseconds) {
      times.points.emplace_back(static_cast<double>(i), *rows[i].milliseconds);
    }
  }
  plot.series = {times};
  return {"time", plot};
}

/// A fix with its row and its error.
struct Judged {
  double scan = 0.0;
  const ReportRow* row = nullptr;
  double error_m = 0.0;
};

std::vector<Judged> judged_fixes(const std::vector<ReportRow>& rows, const AlignedErrors& errors) {
  std::map<double, std::size_t> by_time;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    by_time.emplace(rows[i].t_s, i);
  }
  std::vector<Judged> judged;
  for (const FixError& error : errors.fixes) {
    if (const auto found = by_time.find(error.t); found != by_time.end()) {
      judged.push_back({static_cast<double>(found->second), &rows[found->second], error.distance_m});
    }
  }
  return judged;
}

ReportPlot error_plot(const std::vector<Judged>& fixes) {
  CurvePlot plot = plot_of("Error against the truth along the path", "scan", "m");
  plot.x_step_min = 1.0;
  CurveSeries error{"error", {}, CurveStyle::LineAndMarkers};
  CurveSeries sigma{"sigma", {}, CurveStyle::Line};
  CurveSeries protection{"protection radius", {}, CurveStyle::Line};
  std::size_t beyond = 0;
  for (const Judged& fix : fixes) {
    error.points.emplace_back(fix.scan, fix.error_m);
    if (fix.row->sigma_m) {
      sigma.points.emplace_back(fix.scan, *fix.row->sigma_m);
    }
    if (fix.row->protection_radius_m) {
      protection.points.emplace_back(fix.scan, *fix.row->protection_radius_m);
      beyond += fix.error_m > *fix.row->protection_radius_m ? 1 : 0;
    }
  }
  plot.summary = {std::to_string(beyond) + " of " + std::to_string(fixes.size()) +
                  " errors exceed the protection radius"};
  plot.series = {error, sigma, protection};
  return {"error", plot};
}

ReportPlot sigma_plot(const std::vector<Judged>& fixes) {
  CurvePlot plot = plot_of("Error against the reported sigma", "sigma, m", "error, m");
  CurveSeries points{"fixes", {}, CurveStyle::Markers};
  double largest_m = 0.0;
  std::size_t beyond = 0;
  for (const Judged& fix : fixes) {
    if (fix.row->sigma_m) {
      points.points.emplace_back(*fix.row->sigma_m, fix.error_m);
      largest_m = std::max(largest_m, *fix.row->sigma_m);
      beyond += fix.error_m > 3.0 * *fix.row->sigma_m ? 1 : 0;
    }
  }
  plot.summary = {std::to_string(beyond) + " of " + std::to_string(points.points.size()) +
                  " errors exceed three sigma"};
  plot.series = {points,
                 {"1 sigma", {{0.0, 0.0}, {largest_m, largest_m}}, CurveStyle::Line},
                 {"3 sigma", {{0.0, 0.0}, {largest_m, 3.0 * largest_m}}, CurveStyle::Line}};
  return {"sigma", plot};
}

ReportPlot xi_plot(const std::vector<Judged>& fixes) {
  CurvePlot plot = plot_of("Error against xi", "xi, triangulations from the origin", "error, m");
  plot.x_step_min = 1.0;
  CurveSeries points{"fixes", {}, CurveStyle::Markers};
  std::map<double, std::pair<double, std::size_t>> squares;
  for (const Judged& fix : fixes) {
    if (fix.row->xi) {
      points.points.emplace_back(*fix.row->xi, fix.error_m);
      auto& [sum, count] = squares[*fix.row->xi];
      sum += fix.error_m * fix.error_m;
      ++count;
    }
  }
  CurveSeries rms{"RMS", {}, CurveStyle::Line};
  for (const auto& [xi, entry] : squares) {
    rms.points.emplace_back(xi, std::sqrt(entry.first / static_cast<double>(entry.second)));
  }
  plot.series = {points, rms};
  return {"xi", plot};
}

}  // namespace

tl::expected<std::vector<ReportRow>, InputError> parse_report_rows(std::string_view text,
                                                                   std::string_view name) {
  auto csv = CsvReader::open(text, name, kColumns, CsvOthers::Ignored);
  if (!csv) {
    return tl::unexpected(std::move(csv.error()));
  }
  std::vector<ReportRow> rows;
  const auto take_row = [&]() -> tl::expected<void, InputError> {
    RowReader in(*csv);
    ReportRow row;
    row.t_s = in.must(kTime);
    row.is_fix = csv->text(kStatus) == "fix";
    const auto sigma_x = in.maybe(kSigmaX);
    const auto sigma_y = in.maybe(kSigmaY);
    if (sigma_x && sigma_y) {
      row.sigma_m = std::hypot(*sigma_x, *sigma_y);
    }
    row.xi = in.maybe(kXi);
    row.protection_radius_m = in.maybe(kProtection);
    row.matches = in.must(kMatches);
    row.seen = in.must(kSeen);
    row.milliseconds = in.maybe(kMilliseconds);
    if (in.error()) {
      return tl::unexpected(*in.error());
    }
    rows.push_back(row);
    return {};
  };
  if (auto taken = for_each_row(*csv, take_row); !taken) {
    return tl::unexpected(std::move(taken.error()));
  }
  if (rows.empty()) {
    return refuse(name, "holds no scan");
  }
  return rows;
}

std::vector<ReportPlot> report_plots(const std::vector<ReportRow>& rows,
                                     const std::optional<AlignedErrors>& errors) {
  std::vector<ReportPlot> plots = {matches_plot(rows)};
  if (std::any_of(rows.begin(), rows.end(),
                  [](const ReportRow& row) { return row.milliseconds.has_value(); })) {
    plots.push_back(time_plot(rows));
  }
  if (errors) {
    const std::vector<Judged> fixes = judged_fixes(rows, *errors);
    plots.push_back(error_plot(fixes));
    plots.push_back(sigma_plot(fixes));
    plots.push_back(xi_plot(fixes));
  }
  return plots;
}

}  // namespace slamsensor::tools
