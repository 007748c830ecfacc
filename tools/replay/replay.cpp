#include "tools/replay/replay.hpp"

#include "tools/input/scan_source.hpp"
#include "tools/replay/replay_run.hpp"

#include <chrono>

namespace slamsensor::tools {
namespace {

core::Fix localise(const InputScan& scan, firmware::Pipeline& pipeline) {
  const core::ScanTime time{scan.time, scan.time, scan.time, scan.time};
  return scan.is_landmark_list ? pipeline.process_landmarks(scan.landmarks, time, {})
                               : pipeline.process(scan.scanlines, time, {});
}

/// As trajectories and truths count time.
double seconds_of(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

tl::expected<Replay, InputError> replay(const std::vector<std::filesystem::path>& inputs,
                                        const firmware::Config& config, const ReplayProgress& progress) {
  auto source = open_scans(inputs, config);
  if (!source) {
    return tl::unexpected(source.error());
  }
  ReplayRun run(config);
  Replay& result = run.result();
  result.order = (*source)->order();
  result.not_read.assign((*source)->not_read().begin(), (*source)->not_read().end());
  for (;;) {
    const auto scan = (*source)->next();
    if (!scan) {
      result.refused.push_back(scan.error().message);
      continue;
    }
    if (!*scan) {
      break;
    }
    result.points_skipped += (*scan)->points_skipped;
    if (!(*scan)->remark.empty()) {
      result.notes.push_back((*scan)->remark);
    }
    const FixRow& row =
        run.add((*scan)->number, seconds_of((*scan)->time), [&] { return localise(**scan, run.pipeline()); });
    if (progress) {
      progress(result.rows.size() + result.refused.size(), (*source)->count(), row);
    }
  }
  return run.finish();
}

}  // namespace slamsensor::tools
