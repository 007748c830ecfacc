#include "tests/bench/report.hpp"

#include <algorithm>
#include <cstdio>
#include <string_view>

namespace slamsensor::bench {
namespace {

/// Says which benchmark is done, with its numbers: a long run that is ended early has not been for nothing.
class ProgressReporter : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      std::fprintf(stderr, "  %s%s%s\n", run.benchmark_name().c_str(), run.error_occurred ? ": " : "",
                   run.error_message.c_str());
      for (const auto& [name, counter] : run.counters) {
        std::fprintf(stderr, "    %s %g", name.c_str(), counter.value);
      }
      std::fputs("\n", stderr);
      failed_ = failed_ || run.error_occurred;
    }
  }
  [[nodiscard]] bool failed() const noexcept { return failed_; }

 private:
  bool failed_ = false;
};

using Columns = std::vector<std::pair<std::string, std::size_t>>;  // name, width

void widen(Columns& columns, const std::string& name, std::size_t width) {
  auto column = std::find_if(columns.begin(), columns.end(), [&](const auto& c) { return c.first == name; });
  if (column == columns.end()) {
    column = columns.insert(columns.end(), {name, name.size()});
  }
  column->second = std::max(column->second, width);
}

const std::string& cell_of(const Report::Cells& cells, const std::string& column) {
  static const std::string none;
  const auto cell =
      std::find_if(cells.begin(), cells.end(), [&](const auto& c) { return c.first == column; });
  return cell == cells.end() ? none : cell->second;
}

}  // namespace

void Report::print() const {
  if (rows_.empty()) {
    return;  // the filter left nothing of it
  }
  Columns columns;
  std::size_t name_width = 0;
  for (const auto& [name, cells] : rows_) {
    name_width = std::max(name_width, name.size());
    for (const auto& [column, text] : cells) {
      widen(columns, column, text.size());
    }
  }
  const auto line = [&](const std::string& name, const auto& text_of) {
    std::printf("| %-*s |", static_cast<int>(name_width), name.c_str());
    for (const auto& [column, width] : columns) {
      std::printf(" %*s |", static_cast<int>(width), text_of(column).c_str());
    }
    std::printf("\n");
  };
  std::printf("\n## %s\n\n", title_.c_str());
  line("", [](const std::string& column) { return column; });
  std::printf("|%s|", std::string(name_width + 2, '-').c_str());
  for (const auto& [column, width] : columns) {
    std::printf("%s:|", std::string(width + 1, '-').c_str());
  }
  std::printf("\n");
  for (const auto& row : rows_) {
    line(row.first, [&](const std::string& column) { return cell_of(row.second, column); });
  }
  for (const std::string& note : notes_) {
    std::printf("\n%s\n", note.c_str());
  }
}

Row& Row::number(const std::string& column, double value, int digits) {
  state_.counters[column] = value;
  std::vector<char> text(64);
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return this->text(column, text.data());
}

Row& Row::text(const std::string& column, std::string words) {
  cells_.emplace_back(column, std::move(words));
  return *this;
}

Row& Row::times(const Times& times) {
  return number("median ms", times.quantile_ms(0.5), 3)
      .number("p99 ms", times.quantile_ms(0.99), 3)
      .number("worst ms", times.worst_ms(), 3);
}

void Row::finish(double iteration_ms) {
  state_.SetIterationTime(1e-3 * iteration_ms);
  report_.add_row(name_, cells_);
}

void add_benchmark(const std::string& name, std::function<void(benchmark::State&)> body) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [body = std::move(body)](benchmark::State& state) {
                                 for (auto _ : state) {
                                   body(state);
                                 }
                               })
      ->Iterations(1)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

int run(int argc, char** argv, const Report& report) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 64;  // EX_USAGE
  }
  ProgressReporter progress;
  benchmark::RunSpecifiedBenchmarks(&progress);
  benchmark::Shutdown();
  report.print();
  return progress.failed() ? 1 : 0;
}

}  // namespace slamsensor::bench
