#pragma once

#include "tests/bench/measure.hpp"

#include <benchmark/benchmark.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace slamsensor::bench {

/// The table that a benchmark program prints last: a row per benchmark, columns in the order they were first
/// named.
class Report {
 public:
  using Cells = std::vector<std::pair<std::string, std::string>>;  // column, text

  explicit Report(std::string title) : title_(std::move(title)) {}

  void add_row(std::string name, Cells cells) { rows_.emplace_back(std::move(name), std::move(cells)); }

  /// A line under the table.
  void add_note(std::string note) { notes_.push_back(std::move(note)); }

  /// Writes title, table and notes to the standard output; nothing when there is no row.
  void print() const;

 private:
  std::string title_;
  std::vector<std::pair<std::string, Cells>> rows_;
  std::vector<std::string> notes_;
};

/// A row in the making. Every number becomes a counter of the benchmark and a cell of the table.
class Row {
 public:
  Row(benchmark::State& state, Report& report, std::string name)
      : state_(state), report_(report), name_(std::move(name)) {}

  Row& number(const std::string& column, double value, int digits);
  Row& text(const std::string& column, std::string words);
  /// Median, p99 and worst.
  Row& times(const Times& times);
  /// Puts the row into the report; `times_ms` is what Google Benchmark takes as the time of an iteration.
  void finish(double iteration_ms);

 private:
  benchmark::State& state_;
  Report& report_;
  std::string name_;
  Report::Cells cells_;
};

/// Registers a benchmark that runs `body` once; it times its own work and calls Row::finish.
void add_benchmark(const std::string& name, std::function<void(benchmark::State&)> body);

/// Runs the registered benchmarks (Google Benchmark's own options are understood, --benchmark_filter and
/// --benchmark_out above all), with their names as progress on the standard error, and prints `report`.
/// Returns the exit code of the program.
[[nodiscard]] int run(int argc, char** argv, const Report& report);

}  // namespace slamsensor::bench
