#include "core/fix.hpp"
#include "core/localizer.hpp"
#include "firmware/arena_block.hpp"
#include "hal/stamp.hpp"
#include "tools/commands/command.hpp"
#include "tools/input/scan_source.hpp"
#include "tools/input/text_files.hpp"
#include "tools/map_files/open_map.hpp"
#include "tools/output/text_output.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <span>
#include <vector>

namespace slamsensor::tools {
namespace {

struct Options {
  ConfigOptions config;
  std::filesystem::path map;
  std::filesystem::path scans;
  std::filesystem::path out;
  std::string search;
  bool no_deadline = false;
};

struct Query {
  std::int64_t scan = 0;
  core::Fix fix;
  double milliseconds = 0.0;
};

/// The configuration with room for the whole map: it is known before anything is taken.
core::Config with_room_for(core::Config config, std::size_t landmarks) {
  const auto count = static_cast<std::uint32_t>(std::max<std::size_t>(landmarks, 1));
  const double edges_each =
      static_cast<double>(config.capacities.map_edges) / config.capacities.map_landmarks;
  config.capacities.map_landmarks = count;
  config.capacities.map_edges = static_cast<std::uint32_t>(edges_each * count) + 64;
  config.capacities.path_poses = 1;  // nothing is mapped
  config.capacities.sightings = config.capacities.scan_landmarks;
  return config;
}

std::chrono::nanoseconds steady_now(void*) noexcept {
  return std::chrono::steady_clock::now().time_since_epoch();
}

core::Deadline deadline_from(std::chrono::steady_clock::time_point begin, const firmware::Config& config) {
  return {steady_now, nullptr,
          begin.time_since_epoch() + hal::from_seconds(config.daemon.realtime.slam_deadline_s)};
}

std::string poses_csv(const std::vector<Query>& queries) {
  std::string csv = "scan,status,x_m,y_m,heading_rad,matches,expected_false_alarms,milliseconds\n";
  std::array<char, 256> line{};
  for (const Query& q : queries) {
    const std::string_view status = core::to_string(q.fix.status);
    std::snprintf(line.data(), line.size(), "%lld,%.*s,", static_cast<long long>(q.scan),
                  static_cast<int>(status.size()), status.data());
    csv += line.data();
    if (q.fix.status == core::FixStatus::NoFix) {
      csv += ",,";
    } else {
      std::snprintf(line.data(), line.size(), "%.6f,%.6f,%.9f", q.fix.pose_W.x_m, q.fix.pose_W.y_m,
                    q.fix.pose_W.heading_rad);
      csv += line.data();
    }
    std::snprintf(line.data(), line.size(), ",%u,%.3g,%.4f\n", q.fix.matches, q.fix.expected_false_alarms,
                  q.milliseconds);
    csv += line.data();
  }
  return csv;
}

void print_summary(const std::vector<Query>& queries, std::size_t map_landmarks) {
  std::vector<double> times;
  std::array<std::size_t, 3> by_status{};
  std::size_t cut = 0;
  for (const Query& q : queries) {
    times.push_back(q.milliseconds);
    ++by_status[static_cast<std::size_t>(q.fix.status)];
    cut += q.fix.search_end == core::SearchEnd::Deadline ? 1 : 0;
  }
  std::sort(times.begin(), times.end());
  const auto at = [&](double share) {
    return times.empty() ? 0.0
                         : times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  std::printf("map        %zu landmarks\nqueries    %zu: %zu fixes, %zu ambiguous, %zu no fix\n",
              map_landmarks, queries.size(), by_status[2], by_status[1], by_status[0]);
  std::printf("time       median %.3f ms, 99 %% %.3f ms, worst %.3f ms\n", at(0.5), at(0.99), at(1.0));
  if (cut > 0) {
    std::printf("cut        %zu searches by the deadline (realtime.slam_deadline_s; --no-deadline)\n", cut);
  }
}

/// Names what was not read; whether a scan may be among it.
bool print_not_read(std::span<const NotRead> not_read) {
  for (const NotRead& entry : not_read) {
    std::fprintf(stderr, "slamsensor: not read: %s: %s\n", entry.path.c_str(), entry.reason.c_str());
  }
  return std::any_of(not_read.begin(), not_read.end(),
                     [](const NotRead& entry) { return entry.kind == NotReadKind::Missed; });
}

/// The landmarks of a map file of the sensor (by its suffix), else of a map.csv.
tl::expected<std::vector<core::Point2>, CommandError> read_landmarks(const std::filesystem::path& path) {
  if (path.extension() == ".slammap") {
    auto opened = open_map(path.string(), {});
    if (!opened) {
      return tl::unexpected(CommandError{opened.error() + '\n', EX_DATAERR});
    }
    return std::move(opened->map.positions_W);
  }
  const auto map = read_map_csv(path);
  if (!map) {
    return tl::unexpected(CommandError{map.error().message + '\n', EX_DATAERR});
  }
  std::vector<core::Point2> map_W;
  std::transform(map->begin(), map->end(), std::back_inserter(map_W),
                 [](const MapPoint& p) { return p.position_W; });
  return map_W;
}

CommandResult run(const Options& options) {
  const auto loaded = load(options.config);
  if (!loaded) {
    return tl::unexpected(loaded.error());
  }
  const auto landmarks_W = read_landmarks(options.map);
  if (!landmarks_W) {
    return tl::unexpected(landmarks_W.error());
  }
  const std::vector<core::Point2>& map_W = *landmarks_W;
  const std::array<std::filesystem::path, 1> inputs{options.scans};
  auto source = open_scans(inputs, loaded->config);
  if (!source) {
    return tl::unexpected(CommandError{source.error().message + '\n', EX_DATAERR});
  }
  core::Config config = with_room_for(loaded->config.core, map_W.size());
  if (!options.search.empty()) {
    config.association.search =
        options.search == "paper" ? core::SearchMethod::Paper : core::SearchMethod::Fast;
  }
  firmware::ArenaBlock<core::Localizer> localizer(config);
  if (!localizer->set_map(map_W)) {
    return tl::unexpected(CommandError{options.map.string() + ": a landmark is out of reach\n", EX_DATAERR});
  }
  std::vector<Query> queries;
  ProgressBar bar("locate");
  for (;;) {
    const auto scan = (*source)->next();
    if (!scan || (*scan && !(*scan)->is_landmark_list)) {
      return tl::unexpected(
          CommandError{(scan ? options.scans.string() + ": locate takes a landmark list (scan,x_m,y_m)"
                             : scan.error().message) +
                           '\n',
                       EX_DATAERR});
    }
    if (!*scan) {
      break;
    }
    const auto begin = std::chrono::steady_clock::now();
    const core::Fix fix =
        localizer->locate((*scan)->landmarks, loaded->config.landmark_list.view(),
                          options.no_deadline ? core::Deadline{} : deadline_from(begin, loaded->config));
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    queries.push_back({(*scan)->number, fix, took.count()});
    bar.update(queries.size(), (*source)->count());
  }
  const auto written = write_file(options.out, poses_csv(queries));
  if (!written) {
    return tl::unexpected(CommandError{written.error().message + '\n', EX_CANTCREAT});
  }
  print_summary(queries, map_W.size());
  return print_not_read((*source)->not_read()) ? EX_DATAERR : EX_OK;
}

}  // namespace

void add_locate(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("locate", "find many independent scans in one frozen map");
  options->config.add_to(*verb);
  verb->add_option("--map", options->map, "the map: id,x_m,y_m, or a map file NAME.slammap")
      ->required()
      ->type_name("MAP");
  verb->add_option("--scans", options->scans, "the scans: scan,x_m,y_m[,diameter_m[,weight]]")
      ->required()
      ->type_name("scans.csv");
  verb->add_option("--out", options->out, "the poses, a line per scan")->required()->type_name("poses.csv");
  verb->add_option("--search", options->search, "how to search, instead of association.search")
      ->check(CLI::IsMember({"fast", "paper"}));
  verb->add_flag("--no-deadline", options->no_deadline,
                 "let no search be cut: the same input gives the same poses");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
