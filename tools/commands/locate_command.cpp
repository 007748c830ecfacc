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
#include <iterator>
#include <memory>
#include <optional>
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

using LocalizerBlock = firmware::ArenaBlock<core::Localizer>;

struct Query {
  std::int64_t scan = 0;
  core::Fix fix;
  double milliseconds = 0.0;
};

std::chrono::nanoseconds steady_now(void*) noexcept {
  return std::chrono::steady_clock::now().time_since_epoch();
}

core::Deadline deadline_from(std::chrono::steady_clock::time_point begin, const firmware::Config& config) {
  return {steady_now, nullptr,
          begin.time_since_epoch() + hal::from_seconds(config.daemon.realtime.slam_deadline_s)};
}

std::string poses_csv(const std::vector<Query>& queries) {
  std::string csv =
      "scan,status,reason,x_m,y_m,heading_rad,protection_radius_m,matches,expected_false_alarms,"
      "milliseconds\n";
  std::array<char, 256> line{};
  for (const Query& q : queries) {
    const std::string_view status = core::to_string(q.fix.status);
    const std::string_view reason = core::to_string(q.fix.reason);
    std::snprintf(line.data(), line.size(), "%lld,%.*s,%.*s,", static_cast<long long>(q.scan),
                  static_cast<int>(status.size()), status.data(), static_cast<int>(reason.size()),
                  reason.data());
    csv += line.data();
    if (q.fix.status == core::FixStatus::NoFix) {
      csv += ",,,";
    } else {
      std::snprintf(line.data(), line.size(), "%.6f,%.6f,%.9f,%.3f", q.fix.pose_W.x_m, q.fix.pose_W.y_m,
                    q.fix.pose_W.heading_rad, q.fix.protection_radius_m);
      csv += line.data();
    }
    std::snprintf(line.data(), line.size(), ",%u,%.3g,%.4f\n", q.fix.matches, q.fix.expected_false_alarms,
                  q.milliseconds);
    csv += line.data();
  }
  return csv;
}

void print_summary(const std::vector<Query>& queries, std::size_t map_landmarks, const LeftOut& left_out) {
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
    std::printf(
        "cut        %zu searches before their end (realtime.slam_deadline_s, --no-deadline; "
        "association.effort_max)\n",
        cut);
  }
  std::fputs(left_out.text().c_str(), stdout);
}

/// Names what was not read; whether a scan may be among it.
bool print_not_read(std::span<const NotRead> not_read) {
  for (const NotRead& entry : not_read) {
    std::fprintf(stderr, "slamsensor: not read: %s: %s\n", entry.path.c_str(), entry.reason.c_str());
  }
  return std::any_of(not_read.begin(), not_read.end(),
                     [](const NotRead& entry) { return entry.kind == NotReadKind::Missed; });
}

/// The map that is given: a survey, which leaves nothing out, or what a sensor has made of its scans.
struct GivenMap {
  std::vector<core::Point2> survey_W;
  std::vector<core::LandmarkSize> sizes;  ///< of each
  std::optional<firmware::MapFile> made;

  [[nodiscard]] std::size_t landmarks() const { return made ? made->landmarks.size() : survey_W.size(); }
};

/// The configuration with room for the whole map: it is known before anything is taken.
core::Config with_room_for(core::Config config, const GivenMap& map) {
  const auto count = static_cast<std::uint32_t>(std::max<std::size_t>(map.landmarks(), 1));
  const double edges_each =
      static_cast<double>(config.capacities.map_edges) / config.capacities.map_landmarks;
  config.capacities.map_landmarks = count;
  config.capacities.map_edges = static_cast<std::uint32_t>(edges_each * count) + 64;
  const std::size_t poses = map.made ? map.made->path.size() : 0;
  config.capacities.path_poses = static_cast<std::uint32_t>(std::max<std::size_t>(poses, 1));
  config.capacities.sightings = config.capacities.scan_landmarks;
  return config;
}

/// A map.csv that tells of sightings, as `replay` and `map --csv` write it, is what a sensor has made.
firmware::MapFile made_of(const std::vector<MapPoint>& points) {
  firmware::MapFile made;
  for (const MapPoint& point : points) {
    core::MapLandmark landmark;
    landmark.id = static_cast<std::uint32_t>(made.landmarks.size());
    landmark.sightings = landmark.chances = *point.sightings;
    landmark.size = core::LandmarkSize::seen(point.diameter_m);
    made.landmarks.push_back(landmark);
    made.positions_W.push_back(point.position_W);
  }
  made.numbers.next_id = static_cast<std::uint32_t>(made.landmarks.size());
  made.numbers.scans = 1;
  return made;
}

/// A map file of the sensor (by its suffix), else a map.csv.
tl::expected<GivenMap, CommandError> read_given_map(const std::filesystem::path& path) {
  GivenMap given;
  if (path.extension() == ".slammap") {
    auto opened = open_map(path.string(), {});
    if (!opened) {
      return tl::unexpected(CommandError{opened.error() + '\n', EX_DATAERR});
    }
    given.made = std::move(opened->map);
    return given;
  }
  const auto points = read_map_csv(path);
  if (!points) {
    return tl::unexpected(CommandError{points.error().message + '\n', EX_DATAERR});
  }
  if (points->front().sightings) {
    given.made = made_of(*points);
    return given;
  }
  std::transform(points->begin(), points->end(), std::back_inserter(given.survey_W),
                 [](const MapPoint& p) { return p.position_W; });
  std::transform(points->begin(), points->end(), std::back_inserter(given.sizes),
                 [](const MapPoint& p) { return core::LandmarkSize::seen(p.diameter_m); });
  return given;
}

tl::expected<void, CommandError> give(const GivenMap& map, const core::Config& config,
                                      const std::filesystem::path& path, LocalizerBlock& localizer) {
  if (!map.made) {
    return localizer->set_map(map.survey_W, map.sizes)
               ? tl::expected<void, CommandError>()
               : tl::unexpected(CommandError{path.string() + ": a landmark is out of reach\n", EX_DATAERR});
  }
  const core::MapCheck check = localizer->restore(map.made->state());
  if (!check.ok()) {
    const std::string flaw = firmware::flaw_text(check, map.made->state(), config.capacities);
    return tl::unexpected(CommandError{path.string() + ": " + flaw + '\n', EX_DATAERR});
  }
  return {};
}

/// Every scan of `source` in the map that `localizer` has; an error when one is no list of landmarks.
tl::expected<std::vector<Query>, CommandError> locate_all(ScanSource& source, const Options& options,
                                                          const firmware::Config& config,
                                                          LocalizerBlock& localizer, LeftOut& left_out) {
  std::vector<Query> queries;
  ProgressBar bar("locate");
  for (;;) {
    const auto scan = source.next();
    if (!scan || (*scan && !(*scan)->is_landmark_list)) {
      return tl::unexpected(
          CommandError{(scan ? options.scans.string() + ": locate takes a landmark list (scan,x_m,y_m)"
                             : scan.error().message) +
                           '\n',
                       EX_DATAERR});
    }
    if (!*scan) {
      return queries;
    }
    left_out.see(**scan);
    const auto begin = std::chrono::steady_clock::now();
    const core::Fix fix =
        localizer->locate((*scan)->landmarks, config.landmark_list.view(),
                          options.no_deadline ? core::Deadline{} : deadline_from(begin, config));
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    queries.push_back({(*scan)->number, fix, took.count()});
    bar.update(queries.size(), source.count());
  }
}

CommandResult run(const Options& options) {
  const std::vector<std::filesystem::path> outputs{options.out};
  const std::array<std::filesystem::path, 1> inputs{options.scans};
  std::vector<std::filesystem::path> own_inputs = files_read(inputs, options.config);
  own_inputs.push_back(options.map);
  if (auto checked = refuse_own_inputs(outputs, own_inputs); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  const auto loaded = load(options.config);
  if (!loaded) {
    return tl::unexpected(loaded.error());
  }
  const auto map = read_given_map(options.map);
  if (!map) {
    return tl::unexpected(map.error());
  }
  auto source = open_scans(inputs, loaded->config);
  if (!source) {
    return tl::unexpected(CommandError{source.error().message + '\n', EX_DATAERR});
  }
  core::Config config = with_room_for(loaded->config.core, *map);
  if (!options.search.empty()) {
    config.association.search =
        options.search == "paper" ? core::SearchMethod::Paper : core::SearchMethod::Fast;
  }
  LocalizerBlock localizer(config);
  if (auto given = give(*map, config, options.map, localizer); !given) {
    return tl::unexpected(std::move(given.error()));
  }
  LeftOut left_out;
  const auto queries = locate_all(**source, options, loaded->config, localizer, left_out);
  if (!queries) {
    return tl::unexpected(queries.error());
  }
  const auto written = write_file(options.out, poses_csv(*queries));
  if (!written) {
    return tl::unexpected(CommandError{written.error().message + '\n', EX_CANTCREAT});
  }
  print_summary(*queries, map->landmarks(), left_out);
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
