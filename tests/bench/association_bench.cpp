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
#include <string>
#include <vector>

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

std::size_t size_index(std::uint32_t landmarks) {
  return static_cast<std::size_t>(std::find(kMapSizes.begin(), kMapSizes.end(), landmarks) -
                                  kMapSizes.begin());
}

Row& add_tally(Row& row, const Tally& tally, const Times& times) {
  return row.number("queries", static_cast<double>(times.count()), 0)
      .number("right %", tally.percent(tally.right), 2)
      .number("wrong %", tally.percent(tally.wrong), 2)
      .number("ambiguous %", tally.percent(tally.ambiguous), 2)
      .number("none %", tally.percent(tally.none), 2)
      .times(times);
}

/// Mean time of the index's changes by one scan, ms.
double index_update_ms(const MatchingTask& task) {
  constexpr std::uint32_t kScans = 200;
  IndexUnderChange index(task.map_W);
  tests::Draw draw(7);
  const double start_ms = cpu_now_ms();
  for (std::uint32_t scan = 0; scan < kScans; ++scan) {
    index.change_about(draw.below(static_cast<std::uint32_t>(task.map_W.size())));
  }
  return (cpu_now_ms() - start_ms) / kScans;
}

void measure_core(Row row, const MatchingTask& task, const TaskShape& shape, core::SearchMethod search) {
  CoreMatcher matcher(task.map_W, search);
  Tally tally;
  Times times(task.queries.size());
  for (const Query& query : task.queries) {
    CoreMatcher::Answer answer;
    times.add(cpu_of_ms([&] { answer = matcher.locate(query.scan_L); }));
    // Nowhere in the map is a scan of another forest right.
    tally.add(answer.status, answer.pose_W,
              shape.world == World::Foreign ? core::Pose2{1e9, 1e9, 0.0} : query.truth_W);
  }
  add_tally(row, tally, times);
  if (search == core::SearchMethod::Fast) {
    const auto landmarks = static_cast<double>(task.map_W.size());
    row.number("index B/landmark", static_cast<double>(matcher.index_bytes()) / landmarks, 0)
        .number("all B/landmark", static_cast<double>(matcher.bytes()) / landmarks, 0)
        .number("index update ms/scan", index_update_ms(task), 3);
  }
  row.finish(times.mean_ms());
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
  add_tally(row, tally, times).number("peak MB", megabytes, 1).finish(times.mean_ms());
}

/// The tasks of the table.
std::vector<TaskShape> shapes() {
  std::vector<TaskShape> shapes;
  for (const std::uint32_t landmarks : kMapSizes) {
    for (const std::uint32_t nearest : {20U, 60U, 100U}) {
      for (const double sigma_m : {0.15, 0.30}) {
        for (const World world : {World::Forest, World::Half, World::Rows, World::Foreign}) {
          if (nearest < landmarks / 2) {
            shapes.push_back({world, landmarks, nearest, sigma_m});
          }
        }
      }
    }
  }
  return shapes;
}

/// Registers everything and keeps what the benchmarks write into.
class Program {
 public:
  explicit Program(const AssociationOptions& options) : options_(options) {
    for (const TaskShape& shape : shapes()) {
      add_core(shape, core::SearchMethod::Fast, "slamsensor, fast search");
      const bool is_plain = shape.nearest == 20 && shape.sigma_m < 0.2;
      if (is_plain && shape.landmarks <= kPaperLandmarksMost) {
        add_core(shape, core::SearchMethod::Paper, "slamsensor, the paper's search, exhaustive");
      }
      if (is_plain && shape.world == World::Forest && shape.landmarks <= kPeerLandmarksMost) {
        add_peers(shape);
      }
    }
    add_notes();
  }

  [[nodiscard]] int run_all(int argc, char** argv) { return run(argc, argv, report_); }

 private:
  static constexpr std::uint32_t kPaperLandmarksMost = 10'000;
  static constexpr std::uint32_t kPeerLandmarksMost = 1'000;  // they take all pairs of the map

  [[nodiscard]] MatchingTask task_of(const TaskShape& shape, std::size_t queries_most) const {
    return make_matching_task(shape, std::min(options_.queries[size_index(shape.landmarks)], queries_most));
  }

  void add_core(const TaskShape& shape, core::SearchMethod search, const std::string& method) {
    const std::string name = shape.name() + "/" + method;
    add_benchmark(name, [=, this](benchmark::State& state) {
      const std::size_t most = search == core::SearchMethod::Paper ? options_.paper_queries : SIZE_MAX;
      measure_core(Row(state, report_, name), task_of(shape, most), shape, search);
    });
  }

  void add_peer(const TaskShape& shape, const std::string& method, MakePeer make) {
    const std::string name = shape.name() + "/" + method;
    add_benchmark(name, [=, this](benchmark::State& state) {
      measure_peer(Row(state, report_, name), task_of(shape, options_.peer_queries), make, options_);
    });
  }

  void add_peers([[maybe_unused]] const TaskShape& shape) {
#ifdef SLAMSENSOR_BENCH_IGRAPH
    add_peer(shape, "igraph largest_cliques", make_igraph_peer);
#endif
#ifdef SLAMSENSOR_BENCH_PCL
    add_peer(shape, "PCL KFPCS", make_pcl_peer);
#endif
#ifdef SLAMSENSOR_BENCH_OPENCV
    add_peer(shape, "OpenCV estimateAffinePartial2D", make_opencv_peer);
#endif
  }

  void add_notes() {
    report_.add_note(
        "right: a valid pose within 1 m and 2 deg; wrong: a bad pose given as valid. A peer gives no "
        "verdict: each "
        "pose it returns counts as valid. (A transform that scales by more than 10 % is no pose: none.) "
        "Peers stop taking queries when their time is up. peak MB: a peer's highest heap use during a "
        "query. all B/landmark: the map, its index and the search. A scan's changes of the index: 24 "
        "landmarks "
        "moved, taken out and put in. Scans of a foreign forest: nothing is right.");
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
  Report report_{"Data association without a prior, with the decision"};
};

}  // namespace
}  // namespace slamsensor::bench

int main(int argc, char** argv) {
  const auto options = slamsensor::bench::take_options(argc, argv);
  slamsensor::bench::Program program(options);
  return program.run_all(argc, argv);
}
