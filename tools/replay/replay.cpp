#include "tools/replay/replay.hpp"

#include "tools/input/scan_source.hpp"
#include "tools/replay/replay_run.hpp"

#include <chrono>

namespace slamsensor::tools {
namespace {

/// A scan from a file has no clock: its number stands for the seconds.
core::ScanTime time_of(std::int64_t number) {
  const std::chrono::nanoseconds at = std::chrono::seconds(number);
  return {at, at, at, at};
}

core::Fix localise(const InputScan& scan, firmware::Pipeline& pipeline) {
  return scan.is_landmark_list ? pipeline.process_landmarks(scan.landmarks, time_of(scan.number), {})
                               : pipeline.process(scan.scanlines, time_of(scan.number), {});
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
    const FixRow& row = run.add((*scan)->number, static_cast<double>((*scan)->number),
                                [&] { return localise(**scan, run.pipeline()); });
    if (progress) {
      progress(result.rows.size() + result.refused.size(), (*source)->count(), row);
    }
  }
  return run.finish();
}

}  // namespace slamsensor::tools
