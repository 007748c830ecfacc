// Data association without a prior (DESIGN 7, ALGORITHMS): the product's search beside other programs'
// methods on the same queries, and on scans of a forest that the map does not hold.
#include "tests/bench/association_options.hpp"
#include "tests/bench/core_matcher.hpp"
#include "tests/bench/heap_watch.hpp"
#include "tests/bench/matching_task.hpp"
#include "tests/bench/peers.hpp"
#include "tests/bench/report.hpp"
#include "tests/support/forest.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <string>

namespace slamsensor::bench {
namespace {

constexpr double kMegabyte = 1e6;

/// What became of the queries.
struct Tally {
  std::size_t right = 0;
  std::size_t wrong = 0;  // a bad pose given as valid
  std::size_t ambiguous = 0;
  std::size_t none = 0;

  void add(core::FixStatus status, const core::Pose2& pose_W, const core::Pose2& truth_W) {
    if (status == core::FixStatus::Fix) {
      ++(tests::is_right(pose_W, truth_W) ? right : wrong);
    } else {
      ++(status == core::FixStatus::Ambiguous ? ambiguous : none);
    }
  }
  [[nodiscard]] double percent(std::size_t part) const {
    const std::size_t all = right + wrong + ambiguous + none;
    return all == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(all);
  }
};

/// The tasks, each made when it is first needed.
class Tasks {
 public:
  explicit Tasks(const AssociationOptions& options) : options_(options) {}
  const MatchingTask& of(std::size_t size) {
    auto task = tasks_.find(size);
    if (task == tasks_.end()) {
      task = tasks_
                 .emplace(size, make_matching_task(kMapSizes[size], options_.queries[size],
                                                   options_.foreign_queries[size]))
                 .first;
    }
    return task->second;
  }

 private:
  AssociationOptions options_;
  std::map<std::size_t, MatchingTask> tasks_;
};

void finish(Row& row, const Tally& tally, const Times& times, double megabytes) {
  row.number("queries", static_cast<double>(times.count()), 0)
      .number("right %", tally.percent(tally.right), 1)
      .number("wrong %", tally.percent(tally.wrong), 1)
      .number("ambiguous %", tally.percent(tally.ambiguous), 1)
      .number("none %", tally.percent(tally.none), 1)
      .times(times)
      .number("MB", megabytes, 1)
      .finish(times.mean_ms());
}

void measure_core(Row row, const MatchingTask& task, core::SearchMethod search) {
  CoreMatcher matcher(task.map_W, search);
  Tally tally;
  Times times(task.queries.size());
  for (const Query& query : task.queries) {
    CoreMatcher::Answer answer;
    times.add(cpu_of_ms([&] { answer = matcher.locate(query.scan_L); }));
    tally.add(answer.status, answer.pose_W, query.truth_W);
  }
  finish(row, tally, times, static_cast<double>(matcher.bytes()) / kMegabyte);
}

void measure_foreign(Row row, const MatchingTask& task) {
  CoreMatcher matcher(task.map_W, core::SearchMethod::Fast);
  std::size_t accepted = 0;
  std::size_t ambiguous = 0;
  Times times(task.foreign.size());
  for (const Query& query : task.foreign) {
    CoreMatcher::Answer answer;
    times.add(cpu_of_ms([&] { answer = matcher.locate(query.scan_L); }));
    accepted += answer.status == core::FixStatus::Fix ? 1 : 0;
    ambiguous += answer.status == core::FixStatus::Ambiguous ? 1 : 0;
  }
  const auto queries = static_cast<double>(task.foreign.size());
  row.number("queries", queries, 0)
      .number("accepted", static_cast<double>(accepted), 0)
      .number("ambiguous", static_cast<double>(ambiguous), 0)
      .number("false accepts per query", static_cast<double>(accepted) / queries, 5)
      .times(times)
      .finish(times.mean_ms());
}

using MakePeer = std::function<std::unique_ptr<Peer>(std::span<const core::Point2>)>;

/// Memory is the peak of the heap over one query, on an extra run that is not timed.
void measure_peer(Row row, const MatchingTask& task, const MakePeer& make,
                  const AssociationOptions& options) {
  const std::unique_ptr<Peer> peer = make(task.map_W);
  double megabytes = 0.0;
  {
    const HeapWatch watch;
    benchmark::DoNotOptimize(peer->locate(task.queries[0].scan_L));
    megabytes = static_cast<double>(watch.use().peak_bytes) / kMegabyte;
  }
  const std::size_t queries = std::min(options.peer_queries, task.queries.size());
  Tally tally;
  Times times(queries);
  const double start_ms = cpu_now_ms();
  for (std::size_t q = 0; q < queries && cpu_now_ms() - start_ms < 1e3 * options.peer_seconds; ++q) {
    std::optional<core::Pose2> pose_W;
    times.add(cpu_of_ms([&] { pose_W = peer->locate(task.queries[q].scan_L); }));
    tally.add(pose_W ? core::FixStatus::Fix : core::FixStatus::NoFix, pose_W.value_or(core::Pose2{}),
              task.queries[q].truth_W);
  }
  finish(row, tally, times, megabytes);
}

/// Registers everything and keeps what the benchmarks write into.
class Program {
 public:
  explicit Program(const AssociationOptions& options) : options_(options), tasks_(options) {
    for (std::size_t size = 0; size < kMapSizes.size(); ++size) {
      add_core(size, core::SearchMethod::Fast, "fast search");
      add_core(size, core::SearchMethod::Paper, "the paper's search, exhaustive");
      add_peers(size);
    }
    for (std::size_t size = 0; size < kMapSizes.size(); ++size) {
      const std::string name = name_of("foreign", size, "fast search");
      add_benchmark(name, [this, name, size](benchmark::State& state) {
        measure_foreign(Row(state, foreign_report_, "n = " + std::to_string(kMapSizes[size])),
                        tasks_.of(size));
      });
    }
    add_notes();
  }

  [[nodiscard]] int run_all(int argc, char** argv) {
    const int exit_code = run(argc, argv, report_);
    foreign_report_.print();
    return exit_code;
  }

 private:
  static std::string name_of(const std::string& kind, std::size_t size, const std::string& method) {
    return kind + "/n=" + std::to_string(kMapSizes[size]) + "/" + method;
  }

  void add_core(std::size_t size, core::SearchMethod search, const std::string& words) {
    const std::string method = "slamsensor, " + words;
    add_benchmark(name_of("association", size, method), [=, this](benchmark::State& state) {
      measure_core(Row(state, report_, row_name(size, method)), tasks_.of(size), search);
    });
  }

  void add_peer(std::size_t size, const std::string& method, MakePeer make) {
    add_benchmark(name_of("association", size, method), [=, this](benchmark::State& state) {
      measure_peer(Row(state, report_, row_name(size, method)), tasks_.of(size), make, options_);
    });
  }

  static std::string row_name(std::size_t size, const std::string& method) {
    return "n = " + std::to_string(kMapSizes[size]) + ": " + method;
  }

  void add_peers(std::size_t size) {
    if (kMapSizes[size] > 1000) {
      return;  // they take all pairs of the map: a hundred times the work at 1,000
    }
#ifdef SLAMSENSOR_BENCH_IGRAPH
    add_peer(size, "igraph largest_cliques", make_igraph_peer);
#endif
#ifdef SLAMSENSOR_BENCH_PCL
    add_peer(size, "PCL KFPCS", make_pcl_peer);
#endif
#ifdef SLAMSENSOR_BENCH_OPENCV
    add_peer(size, "OpenCV estimateAffinePartial2D", make_opencv_peer);
#endif
  }

  void add_notes() {
    report_.add_note(
        "right: a valid pose within 1 m and 2 deg; wrong: a bad pose given as valid. A peer gives no "
        "verdict: each "
        "pose it returns counts as valid. (A transform that scales by more than 10 % is no pose: none.) "
        "Peers stop taking queries when their time is up. MB: the product's "
        "map, "
        "index and search; a peer's highest heap use during a query.");
#ifndef SLAMSENSOR_BENCH_IGRAPH
    report_.add_note("LEFT OUT: igraph (not found when this was configured; run tests/bench/install).");
#endif
#ifndef SLAMSENSOR_BENCH_PCL
    report_.add_note("LEFT OUT: PCL KFPCS (not found when this was configured; run tests/bench/install).");
#endif
#ifndef SLAMSENSOR_BENCH_OPENCV
    report_.add_note("LEFT OUT: OpenCV (not found when this was configured; run tests/bench/install).");
#endif
  }

  AssociationOptions options_;
  Tasks tasks_;
  Report report_{
      "Data association without a prior: 20 nearest trees, 30 % dropped, 5 spurious, sigma 0.15 m"};
  Report foreign_report_{"Scans of another forest: none may be accepted (aim: 1e-4 per query)"};
};

}  // namespace
}  // namespace slamsensor::bench

int main(int argc, char** argv) {
  const auto options = slamsensor::bench::take_options(argc, argv);
  slamsensor::bench::Program program(options);
  return program.run_all(argc, argv);
}
