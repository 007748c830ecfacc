#include "tools/replay/replay.hpp"

#include "firmware/pipeline.hpp"
#include "tools/input/scan_source.hpp"

#include <chrono>

namespace slamsensor::tools {
namespace {

/// A scan from a file has no clock: its number stands for the seconds.
core::ScanTime time_of(std::int64_t number) {
  const std::chrono::nanoseconds at = std::chrono::seconds(number);
  return {at, at, at, at};
}

FixRow localise(const InputScan& scan, firmware::Pipeline& pipeline) {
  const auto begin = std::chrono::steady_clock::now();
  FixRow row;
  row.scan = scan.number;
  row.t_s = static_cast<double>(scan.number);
  row.fix = scan.is_landmark_list ? pipeline.process_landmarks(scan.landmarks, time_of(scan.number), {})
                                  : pipeline.process(scan.scanlines, time_of(scan.number), {});
  row.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return row;
}

/// The map with its scans named as the input names them.
void take_map(const core::HypothesisSet& hypotheses, Replay& result) {
  if (hypotheses.empty()) {
    return;
  }
  const core::Hypothesis& best = hypotheses.best();
  const std::uint32_t last_in_map = best.path.back().scan;
  for (std::size_t i = 0; i < best.map.size(); ++i) {
    const core::MapLandmark& l = best.map.landmarks()[i];
    result.map.push_back({l.id, best.map.positions_W()[i], l.xi, l.sightings, result.rows[l.first_scan].scan,
                          result.rows[l.last_scan].scan});
    result.matched.push_back(l.last_scan == last_in_map && l.first_scan != last_in_map);
  }
  result.counters = hypotheses.counters();
  result.landmarks_evicted = best.landmarks_evicted;
  result.path_thinnings = best.path_thinnings;
}

}  // namespace

tl::expected<Replay, InputError> replay(const std::vector<std::filesystem::path>& inputs,
                                        const firmware::Config& config, const ReplayProgress& progress) {
  auto source = open_scans(inputs, config);
  if (!source) {
    return tl::unexpected(source.error());
  }
  firmware::Pipeline pipeline(config.core);
  Replay result;
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
    result.rows.push_back(localise(**scan, pipeline));
    if (progress) {
      progress(result.rows.size() + result.refused.size(), (*source)->count(), result.rows.back());
    }
  }
  take_map(pipeline.slam().hypotheses(), result);
  result.cells_dropped = pipeline.slam().detector().cells_dropped();
  result.readings_refused = pipeline.slam().detector().readings_refused();
  return result;
}

}  // namespace slamsensor::tools
