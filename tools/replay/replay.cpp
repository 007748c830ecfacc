#include "tools/replay/replay.hpp"

#include "tools/input/scan_source.hpp"
#include "tools/replay/replay_run.hpp"

#include <chrono>
#include <iterator>
#include <utility>

namespace slamsensor::tools {
namespace {

core::Fix localise(const InputScan& scan, const core::ScanView& list_view, const core::Deadline& deadline,
                   firmware::Pipeline& pipeline) {
  const core::ScanTime time{scan.time, scan.time, scan.time, scan.time};
  return scan.is_landmark_list ? pipeline.process_landmarks(scan.landmarks, list_view, time, deadline)
                               : pipeline.process(scan.scanlines, time, deadline);
}

/// As trajectories and truths count time.
double seconds_of(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

Replay joined(Replay first, Replay second) {
  const auto put_before = [](auto& list, auto& before) {
    list.insert(list.begin(), std::make_move_iterator(before.begin()), std::make_move_iterator(before.end()));
  };
  put_before(second.rows, first.rows);
  put_before(second.refused, first.refused);
  put_before(second.notes, first.notes);
  second.is_damaged = second.is_damaged || first.is_damaged;
  second.fixes_compared += first.fixes_compared;
  second.fixes_alike += first.fixes_alike;
  second.counters.landmarks_cut += first.counters.landmarks_cut;
  second.counters.landmarks_refused += first.counters.landmarks_refused;
  second.counters.neighbours_dropped += first.counters.neighbours_dropped;
  second.counters.searches_cut += first.counters.searches_cut;
  second.cells_dropped += first.cells_dropped;
  second.readings_refused += first.readings_refused;
  second.landmarks_evicted += first.landmarks_evicted;
  second.path_thinnings += first.path_thinnings;
  return second;
}

tl::expected<Replay, InputError> replay(const std::vector<std::filesystem::path>& inputs,
                                        const firmware::Config& config, const ReplayProgress& progress,
                                        ReplayClock clock) {
  auto source = open_scans(inputs, config);
  if (!source) {
    return tl::unexpected(source.error());
  }
  ReplayRun run(config, clock);
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
        run.add((*scan)->number, seconds_of((*scan)->time), [&](const core::Deadline& deadline) {
          return localise(**scan, config.landmark_list.view(), deadline, run.pipeline());
        });
    if (progress) {
      progress(result.rows.size() + result.refused.size(), (*source)->count(), row);
    }
  }
  return run.finish();
}

}  // namespace slamsensor::tools
