// Landmark detection (DESIGN 7): a scan of the paper's size within 10 ms on one core, all scanlines together.
#include "core/config.hpp"
#include "core/detection/landmark_detector.hpp"
#include "tests/bench/detection_scans.hpp"
#include "tests/bench/heap_watch.hpp"
#include "tests/bench/report.hpp"
#include "tests/support/in_arena.hpp"

#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

namespace slamsensor::bench {
namespace {

constexpr std::size_t kStands = 5;
constexpr std::size_t kRunsPerScan = 40;

std::size_t readings_of(const Scan& scan) {
  std::size_t readings = 0;
  for (const auto& scanline : scan) {
    readings += scanline.size();
  }
  return readings;
}

std::size_t detect(core::LandmarkDetector& detector, const Scan& scan) {
  for (const auto& scanline : scan) {
    detector.add_scanline(scanline);
  }
  return detector.finish().size();
}

void measure(Row row, const std::vector<Scan>& scans, core::LandmarkPoint point) {
  if (!heap_watch_works()) {
    std::abort();  // a count of 0 would mean nothing
  }
  core::DetectionConfig config;
  config.point = point;
  tests::InArena<core::LandmarkDetector> detector(config);
  std::size_t landmarks = 0;
  for (const Scan& scan : scans) {
    landmarks += detect(*detector, scan);
  }
  Times times(scans.size() * kRunsPerScan);
  std::uint64_t allocations = 0;
  for (std::size_t run = 0; run < kRunsPerScan; ++run) {
    for (const Scan& scan : scans) {
      const HeapWatch watch;
      times.add(cpu_of_ms([&] { benchmark::DoNotOptimize(detect(*detector, scan)); }));
      allocations += watch.use().allocations;
    }
  }
  if (detector->cells_dropped() != 0 || detector->readings_refused() != 0) {
    std::abort();  // the scans are meant to fit
  }
  row.number("readings", static_cast<double>(readings_of(scans[0])), 0)
      .number("scans", static_cast<double>(times.count()), 0)
      .number("landmarks", static_cast<double>(landmarks) / static_cast<double>(scans.size()), 1)
      .times(times)
      .number("allocations", static_cast<double>(allocations), 0)
      .finish(times.mean_ms());
}

void add(Report& report, const std::string& world, const std::function<std::vector<Scan>()>& make_scans) {
  for (const auto point : {core::LandmarkPoint::HullCentroid, core::LandmarkPoint::ReadingMean}) {
    const std::string name =
        world + (point == core::LandmarkPoint::HullCentroid ? ", hull centroid" : ", mean of readings");
    add_benchmark("detection/" + name, [=, &report](benchmark::State& state) {
      measure(Row(state, report, name), make_scans(), point);
    });
  }
}

}  // namespace
}  // namespace slamsensor::bench

int main(int argc, char** argv) {
  using namespace slamsensor::bench;
  Report report("Landmark detection per scan, 51 scanlines together (target: 10 ms)");
  add(report, "bush world", [] { return bush_scans(kStands); });
  add(report, "worst case, most landmarks", [] { return std::vector<Scan>{most_groups_scan()}; });
  add(report, "worst case, most cells", [] { return std::vector<Scan>{most_cells_scan()}; });
  add(report, "worst case, noise", [] { return std::vector<Scan>{noise_scan()}; });
  return run(argc, argv, report);
}
