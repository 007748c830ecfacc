#include "tools/replay/replay_report.hpp"

#include "core/fix.hpp"
#include "firmware/output/nmea.hpp"
#include "tools/output/result_files.hpp"
#include "tools/plot/map_plot.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>
#include <system_error>
#include <vector>

namespace slamsensor::tools {
namespace {

template <typename... Args>
std::string text(const char* format, Args... args) {
  std::array<char, 256> line{};
  std::snprintf(line.data(), line.size(), format, args...);
  return line.data();
}

std::size_t count_of(const Replay& replay, core::FixStatus status) {
  return static_cast<std::size_t>(std::count_if(replay.rows.begin(), replay.rows.end(),
                                                [&](const FixRow& row) { return row.fix.status == status; }));
}

std::string track_nmea(const Replay& replay, const firmware::Config& config) {
  std::optional<firmware::GeoReference> geo;
  if (config.datum) {
    geo.emplace(*config.datum);
  }
  const firmware::NmeaContext context =
      firmware::nmea_context(config.nmea, geo ? &*geo : nullptr, firmware::NmeaMode::Simulated);
  std::string track;
  std::array<char, firmware::kNmeaEpochBytesMax> epoch{};
  for (const FixRow& row : replay.rows) {
    track.append(epoch.data(), firmware::format_nmea(row.fix, context, epoch));
  }
  return track;
}

MapPlot plot_of(const Replay& replay, std::span<const TimedPose> truth,
                const std::optional<Evaluation>& evaluation) {
  MapPlot plot;
  plot.title = "Path and landmarks";
  plot.summary.push_back(text("%zu scans, %zu fixes, %zu landmarks", replay.rows.size(),
                              count_of(replay, core::FixStatus::Fix), replay.map.size()));
  for (std::size_t i = 0; i < replay.map.size(); ++i) {
    plot.landmarks.push_back({replay.map[i].position_W, replay.map[i].xi, replay.matched[i]});
  }
  for (const FixRow& row : replay.rows) {
    plot.poses.push_back({row.fix.pose_W, row.scan, row.fix.status});
  }
  if (evaluation && evaluation->first_fix) {
    const AlignedErrors& errors = *evaluation->first_fix;
    plot.summary.push_back(text("against truth: %zu wrong, error RMS %.3f m, worst %.3f m",
                                errors.wrong_fixes, errors.ate_rms_m, errors.ate_max_m));
    for (const TimedPose& pose : truth) {
      plot.truth_W.push_back(errors.T_truth_map.inverse() * pose.pose);
    }
  }
  return plot;
}

std::string times_text(const Replay& replay) {
  std::vector<double> times;
  for (const FixRow& row : replay.rows) {
    times.push_back(row.milliseconds.value_or(0.0));
  }
  if (times.empty()) {
    return {};
  }
  std::sort(times.begin(), times.end());
  return text("time per scan    median %.2f ms, worst %.2f ms\n", times[times.size() / 2], times.back());
}

std::string reasons_text(const Replay& replay) {
  std::string lines;
  for (const core::FixReason reason :
       {core::FixReason::TooFewLandmarks, core::FixReason::NoOverlap, core::FixReason::Symmetric,
        core::FixReason::Copy, core::FixReason::LocalMap, core::FixReason::Deadline}) {
    const auto count = std::count_if(replay.rows.begin(), replay.rows.end(),
                                     [&](const FixRow& row) { return row.fix.reason == reason; });
    if (count > 0) {
      const std::string_view name = core::to_string(reason);
      lines += text("  %-19.*s%td\n", static_cast<int>(name.size()), name.data(), count);
    }
  }
  return lines;
}

std::string local_maps_text(const Replay& replay) {
  if (replay.maps.local_maps == 0) {
    return {};
  }
  return text("local maps       %u, whose place in the home map is not known: %u landmarks\n",
              replay.maps.local_maps, replay.maps.local_landmarks);
}

std::string recording_text(const Replay& replay) {
  std::string lines;
  if (replay.fixes_compared > 0) {
    lines += text("as recorded      %llu of %llu fixes, bit for bit\n",
                  static_cast<unsigned long long>(replay.fixes_alike),
                  static_cast<unsigned long long>(replay.fixes_compared));
  }
  for (const std::string& note : replay.notes) {
    lines += note + '\n';
  }
  return lines;
}

std::string counters_text(const Replay& replay) {
  const std::array<std::pair<const char*, std::uint64_t>, 9> counters{{
      {"cloud points without a direction", replay.points_skipped},
      {"readings that were impossible", replay.readings_refused},
      {"sightings beyond capacities.occupied_cells", replay.cells_dropped},
      {"landmarks beyond capacities.scan_landmarks", replay.counters.landmarks_cut},
      {"landmarks that were no places", replay.counters.landmarks_refused},
      {"landmarks evicted from a full map", replay.landmarks_evicted},
      {"thinnings of a full path", replay.path_thinnings},
      {"correspondence neighbours dropped", replay.counters.neighbours_dropped},
      {"searches cut by the deadline", replay.counters.searches_cut},
  }};
  std::string lines;
  for (const auto& [name, count] : counters) {
    if (count > 0) {
      lines += text("%s: %llu\n", name, static_cast<unsigned long long>(count));
    }
  }
  return lines;
}

}  // namespace

std::vector<std::filesystem::path> replay_files(const std::filesystem::path& folder) {
  return {folder / "trajectory.tum", folder / "hindsight.tum", folder / "fixes.csv",
          folder / "map.csv",        folder / "track.nmea",    folder / "plot.svg"};
}

tl::expected<void, OutputError> write_replay(const Replay& replay, const firmware::Config& config,
                                             std::span<const TimedPose> truth,
                                             const std::optional<Evaluation>& evaluation, MeasuredTimes times,
                                             const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return tl::unexpected(OutputError{folder.string() + ": " + error.message() + "; choose another --out"});
  }
  const std::vector<std::filesystem::path> files = replay_files(folder);
  return write_trajectory(files[0], trajectory_of(replay.rows))
      .and_then([&] { return write_trajectory(files[1], replay.path); })
      .and_then([&] { return write_fixes(files[2], replay.rows, times); })
      .and_then([&] { return write_map(files[3], replay.map); })
      .and_then([&] { return write_file(files[4], track_nmea(replay, config)); })
      .and_then([&] { return write_file(files[5], draw_map(plot_of(replay, truth, evaluation))); });
}

bool is_incomplete(const Replay& replay) {
  return !replay.refused.empty() || replay.is_damaged ||
         std::any_of(replay.not_read.begin(), replay.not_read.end(),
                     [](const NotRead& entry) { return entry.kind == NotReadKind::Missed; });
}

std::string replay_summary(const Replay& replay) {
  const std::size_t fixes = count_of(replay, core::FixStatus::Fix);
  const double share = replay.rows.empty()
                           ? 0.0
                           : 100.0 * static_cast<double>(fixes) / static_cast<double>(replay.rows.size());
  return text("scans            %zu%s\n", replay.rows.size(),
              replay.refused.empty() ? "" : text(" (and %zu refused)", replay.refused.size()).c_str()) +
         (replay.order.empty() ? "" : "order            " + replay.order + '\n') +
         (replay.not_read.empty() ? "" : text("entries not read %zu\n", replay.not_read.size())) +
         text("fixes            %zu (%.1f %%)\n", fixes, share) +
         text("ambiguous        %zu\n", count_of(replay, core::FixStatus::Ambiguous)) +
         text("no fix           %zu\n", count_of(replay, core::FixStatus::NoFix)) + reasons_text(replay) +
         text("in hindsight     %zu scans known in the home map\n", replay.path.size()) +
         text("map              %zu landmarks\n", replay.map.size()) + local_maps_text(replay) +
         times_text(replay) + replay.left_out.text() + counters_text(replay) + recording_text(replay);
}

}  // namespace slamsensor::tools
