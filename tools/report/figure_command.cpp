#include "tools/report/figure_command.hpp"

#include "core/detection/landmark_detector.hpp"
#include "firmware/arena_block.hpp"
#include "tools/commands/command.hpp"
#include "tools/input/scan_source.hpp"
#include "tools/plot/svg.hpp"
#include "tools/recording/recording_file.hpp"
#include "tools/report/correspondence_figure.hpp"
#include "tools/report/scan_figures.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace slamsensor::tools {
namespace {

struct Options {
  ConfigOptions config;
  std::vector<std::filesystem::path> inputs;
  std::vector<std::int64_t> scans;  ///< numbers; empty: the first of the input
  std::optional<std::size_t> line;
  std::uint32_t landmarks = 20;
  std::filesystem::path out;
};

tl::unexpected<CommandError> fail(std::string message, int exit_status) {
  return tl::unexpected(CommandError{std::move(message) + '\n', exit_status});
}

/// The configuration of a figure that is no input of its own.
tl::expected<firmware::LoadedConfig, CommandError> prepare(const Options& options) {
  return refuse_own_inputs(picture_files(options.out), files_read(options.inputs, options.config))
      .and_then([&] { return load(options.config); });
}

/// The first `count` scans of the inputs, or those whose numbers are asked for, in that order.
tl::expected<std::vector<InputScan>, CommandError> read_scans(const Options& options,
                                                              const firmware::Config& config,
                                                              std::size_t count) {
  if (const auto log = std::find_if(options.inputs.begin(), options.inputs.end(), is_event_log_file);
      log != options.inputs.end()) {
    return fail(log->string() + ": is a recording; figures are drawn from clouds, readings or landmark lists",
                EX_DATAERR);
  }
  const auto source = open_scans(options.inputs, config);
  if (!source) {
    return fail(source.error().message, EX_NOINPUT);
  }
  std::vector<std::optional<InputScan>> found(count);
  std::size_t missing = count;
  for (std::size_t number = 0; missing > 0;) {
    auto scan = (*source)->next();
    if (!scan) {
      return fail(scan.error().message, EX_DATAERR);
    }
    if (!*scan) {
      break;
    }
    const auto asked = std::find(options.scans.begin(), options.scans.end(), (*scan)->number);
    const auto place =
        options.scans.empty() ? number++ : static_cast<std::size_t>(asked - options.scans.begin());
    if (place < count && !found[place]) {
      found[place] = std::move(**scan);
      --missing;
    }
  }
  std::vector<InputScan> scans;
  for (std::size_t i = 0; i < count; ++i) {
    if (!found[i]) {
      return fail(
          options.scans.empty()
              ? "the input holds " + std::to_string(i) + " scans; the figure takes " + std::to_string(count)
              : "no scan of the input has the number " + std::to_string(options.scans[i]),
          EX_DATAERR);
    }
    scans.push_back(std::move(*found[i]));
  }
  return scans;
}

CommandResult write(const Options& options, const std::string& svg) {
  if (const auto written = write_picture(options.out, svg); !written) {
    return fail(written.error().message, EX_CANTCREAT);
  }
  std::printf("%s\n", options.out.c_str());
  return EX_OK;
}

/// Its name without the folders it lies in.
std::string short_name(const InputScan& scan) {
  return std::filesystem::path(scan.name).filename().string();
}

/// The scan of a figure that is drawn from readings.
tl::expected<InputScan, CommandError> read_readings(const Options& options, const firmware::Config& config) {
  auto scans = read_scans(options, config, 1);
  if (!scans) {
    return tl::unexpected(scans.error());
  }
  if (scans->front().is_landmark_list) {
    return fail(scans->front().name + ": holds landmarks; this figure is drawn from readings or clouds",
                EX_DATAERR);
  }
  return std::move(scans->front());
}

CommandResult run_spiderweb(const Options& options) {
  const auto config = prepare(options);
  if (!config) {
    return tl::unexpected(config.error());
  }
  const auto scan = read_readings(options, config->config);
  return scan ? write(options, draw_spiderweb(scan->scanlines, config->config.core.detection,
                                              "Spiderweb grid of " + short_name(*scan)))
              : tl::unexpected(scan.error());
}

CommandResult run_scanline(const Options& options) {
  const auto config = prepare(options);
  if (!config) {
    return tl::unexpected(config.error());
  }
  const core::DetectionConfig& detection = config->config.core.detection;
  const auto scan = read_readings(options, config->config);
  if (!scan) {
    return tl::unexpected(scan.error());
  }
  const std::optional<std::size_t> line =
      options.line ? options.line : richest_scanline(scan->scanlines, detection);
  if (!line || *line >= scan->scanlines.size()) {
    return fail(scan->name + ": has " + std::to_string(scan->scanlines.size()) + " scanlines" +
                    (line ? "; they are counted from 0" : ", of which none is looked at"),
                EX_DATAERR);
  }
  return write(options, draw_scanline(scan->scanlines[*line], detection,
                                      "Scanline " + std::to_string(*line) + " of " + short_name(*scan)));
}

/// What the detector makes of a scan, or the list that it is; the heaviest.
std::vector<core::ScanLandmark> landmarks_of(const InputScan& scan, const core::Config& config,
                                             std::size_t count_max) {
  std::vector<core::ScanLandmark> landmarks = scan.landmarks;
  if (!scan.is_landmark_list) {
    firmware::ArenaBlock<core::LandmarkDetector> detector(config.detection, config.capacities);
    for (const std::vector<core::Reading>& scanline : scan.scanlines) {
      detector->add_scanline(scanline);
    }
    const auto found = detector->finish();
    landmarks.assign(found.begin(), found.end());
  }
  landmarks.resize(std::min(landmarks.size(), count_max));
  return landmarks;
}

CommandResult run_correspondences(const Options& options) {
  const auto config = prepare(options);
  if (!config) {
    return tl::unexpected(config.error());
  }
  if (options.scans.size() == 2 && options.scans[0] == options.scans[1]) {
    return fail("--scans: two different scans are needed", EX_USAGE);
  }
  const auto scans = read_scans(options, config->config, 2);
  if (!scans) {
    return tl::unexpected(scans.error());
  }
  const core::Config& core = config->config.core;
  return write(options, draw_correspondences(landmarks_of((*scans)[1], core, options.landmarks),
                                             landmarks_of((*scans)[0], core, options.landmarks), core,
                                             "Correspondence graph of " + short_name((*scans)[1]) + " and " +
                                                 short_name((*scans)[0])));
}

void add_common(CLI::App& verb, Options& options) {
  verb.add_option("INPUT", options.inputs, "clouds, readings or landmark lists, as replay takes them")
      ->required();
  verb.add_option("--out", options.out, "the picture; of F.png the SVG stands beside it")
      ->required()
      ->check(is_picture_name)
      ->type_name("F.svg|F.png");
  options.config.add_to(verb);
}

}  // namespace

void add_figure(CLI::App& app, CommandResult& result) {
  CLI::App* figure = app.add_subcommand("figure", "the paper's figures from your scans (edges draws Fig. 5)");
  figure->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, CommandResult (*run)(const Options&)) {
    auto options = std::make_shared<Options>();
    CLI::App* verb = figure->add_subcommand(name, what);
    add_common(*verb, *options);
    verb->callback([options, run, &result] { result = run(*options); });
    return std::pair(verb, options);
  };
  constexpr const char* kScan = "the number of the scan; else the first";
  {
    const auto [verb, options] =
        add("spiderweb", "the grid of a scan and its landmarks (Fig. 3)", run_spiderweb);
    verb->add_option("--scan", options->scans, kScan)->expected(1)->type_name("N");
  }
  {
    const auto [verb, options] = add("scanline", "one scanline and its clusters (Fig. 4)", run_scanline);
    verb->add_option("--scan", options->scans, kScan)->expected(1)->type_name("N");
    verb->add_option("--line", options->line, "the scanline, from 0; else the one that shows the most");
  }
  const auto [verb, options] =
      add("correspondences", "the correspondence graph of two scans (Fig. 6)", run_correspondences);
  verb->add_option("--scans", options->scans, "the numbers of the two; else the first two")
      ->expected(2)
      ->type_name("N M");
  verb->add_option("--landmarks", options->landmarks, "of each scan, the heaviest")
      ->check(CLI::Range(3, 60))
      ->capture_default_str();
}

}  // namespace slamsensor::tools
