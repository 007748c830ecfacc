#include "firmware/config/list_config.hpp"
#include "tools/commands/command.hpp"
#include "tools/eval/evaluation.hpp"
#include "tools/input/text_files.hpp"
#include "tools/output/result_files.hpp"
#include "tools/recording/recording_file.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/replay_report.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>

namespace slamsensor::tools {
namespace {

struct Options {
  ConfigOptions config;
  std::string truth;
  std::string out;
  std::string landmarks;
  std::vector<std::filesystem::path> inputs;
  bool no_times = false;
  double tolerance_s = EvaluationConfig().time_tolerance_s;
};

tl::expected<std::vector<TimedPose>, CommandError> read_truth(const std::string& path) {
  if (path.empty()) {
    return std::vector<TimedPose>{};
  }
  return read_tum(path).map_error([](const InputError& e) {
    return CommandError{e.message + '\n', EX_DATAERR};
  });
}

CommandError bad_input(const InputError& error) {
  return {error.message + '\n', EX_NOINPUT};
}

/// The recordings in the file that is to be replayed; none when the inputs are files of scans.
tl::expected<std::vector<RecordingFile>, CommandError> find_recordings(
    const std::vector<std::filesystem::path>& inputs) {
  const auto found = std::find_if(inputs.begin(), inputs.end(), is_event_log_file);
  if (found == inputs.end()) {
    return std::vector<RecordingFile>{};
  }
  if (inputs.size() > 1) {
    return tl::unexpected(CommandError{
        found->string() + ": a recording is replayed alone; give it as the only INPUT\n", EX_USAGE});
  }
  return open_recordings(*found).map_error(bad_input);
}

/// Leaves out what the command line names itself: the results of an earlier run, the truth, the settings.
void leave_out_own(const Options& options, std::vector<NotRead>& not_read) {
  const auto is_own = [&](const NotRead& entry) {
    const std::array<std::filesystem::path, 3> own{options.out, options.truth, options.config.file};
    return std::any_of(own.begin(), own.end(), [&](const std::filesystem::path& path) {
      std::error_code error;
      return !path.empty() && std::filesystem::equivalent(path, entry.path, error);
    });
  };
  not_read.erase(std::remove_if(not_read.begin(), not_read.end(), is_own), not_read.end());
}

/// The settings of a replay. Keys of a recording that this version does not have are left out: `note`.
struct ReplaySettings {
  firmware::LoadedConfig loaded;
  std::string note;
};

/// What `recording` was made with.
tl::expected<ReplaySettings, CommandError> recorded_settings(const RecordingFile& recording) {
  ReplaySettings settings;
  const std::string name = recording.path.string() + " (settings)";
  auto errors = firmware::apply_config_toml(settings.loaded, *recording.config, name);
  const auto unknown = std::stable_partition(errors.begin(), errors.end(),
                                             [](const auto& error) { return !error.is_unknown; });
  if (unknown != errors.begin()) {
    errors.erase(unknown, errors.end());
    return tl::unexpected(CommandError{firmware::error_lines(errors), EX_DATAERR});
  }
  firmware::append(errors, std::exchange(settings.loaded.warnings, {}));
  for (const firmware::ConfigError& error : errors) {
    settings.note += (settings.note.empty() ? "" : ", ") + error.key;
  }
  if (!errors.empty()) {
    settings.note = name + ": made by another version; without effect are " + settings.note;
  }
  return settings;
}

/// What the recording, if there is one, was made with, under --config and --set.
tl::expected<ReplaySettings, CommandError> load_for(const RecordingFile* recording,
                                                    const ConfigOptions& options) {
  ReplaySettings settings;
  if (recording != nullptr && recording->config) {
    auto recorded = recorded_settings(*recording);
    if (!recorded) {
      return recorded;
    }
    settings = std::move(*recorded);
  }
  auto loaded = load(options, std::move(settings.loaded));
  if (!loaded) {
    return tl::unexpected(loaded.error());
  }
  settings.loaded = std::move(*loaded);
  return settings;
}

std::string foreign_text(const RecordingFile& recording, std::size_t parts) {
  return recording.path.string() + ": part " + std::to_string(recording.part + 1) + " of the " +
         std::to_string(parts) + " that are joined in it, " + std::to_string(recording.events) +
         " events, is no recording of scans and was passed over";
}

/// Each recording with its own settings, one after the other.
tl::expected<Replay, CommandError> replay_all(const std::vector<RecordingFile>& recordings,
                                              const Options& options, const ReplayProgress& progress) {
  Replay all;
  for (const RecordingFile& recording : recordings) {
    if (!recording.has_scans()) {
      all.notes.push_back(foreign_text(recording, recordings.size()));
      continue;
    }
    const auto settings = load_for(&recording, options.config);
    if (!settings) {
      return tl::unexpected(settings.error());
    }
    if (!settings->note.empty()) {
      all.notes.push_back(settings->note);
    }
    auto replayed = replay_recording(recording, settings->loaded.config, progress);
    if (!replayed) {
      return tl::unexpected(bad_input(replayed.error()));
    }
    all = joined(std::move(all), std::move(*replayed));
  }
  if (recordings.size() > 1) {
    all.notes.push_back(recordings.front().path.string() + ": " + std::to_string(recordings.size()) +
                        " recordings are joined in it; each was replayed from its own first scan on, and the "
                        "map is that of the last one with scans");
  }
  return all;
}

tl::expected<Replay, CommandError> make_replay(const Options& options,
                                               const std::vector<RecordingFile>& recordings,
                                               const firmware::Config& config) {
  ProgressBar bar("replay");
  const auto progress = [&](std::size_t done, std::size_t total, const FixRow&) { bar.update(done, total); };
  return recordings.empty()
             ? replay(options.inputs, config, progress, options.no_times ? ReplayClock::Off : ReplayClock::On)
                   .map_error(bad_input)
             : replay_all(recordings, options, progress);
}

tl::expected<std::optional<Evaluation>, CommandError> compare(const std::vector<TimedPose>& truth,
                                                              const Replay& result, const Options& options) {
  if (truth.empty()) {
    return std::nullopt;
  }
  EvaluationConfig config;
  config.time_tolerance_s = options.tolerance_s;
  return evaluate(truth, trajectory_of(result.rows), config)
      .map([](Evaluation&& evaluation) { return std::optional(std::move(evaluation)); })
      .map_error([&](const EvaluationError& error) {
        return CommandError{options.truth + ": " + error.message + '\n', EX_DATAERR};
      });
}

void print(const Replay& result, const std::optional<Evaluation>& evaluation, const std::string& out) {
  for (const std::string& message : result.refused) {
    std::fprintf(stderr, "slamsensor: refused: %s\n", message.c_str());
  }
  for (const NotRead& entry : result.not_read) {
    std::fprintf(stderr, "slamsensor: not read: %s: %s\n", entry.path.c_str(), entry.reason.c_str());
  }
  std::fputs(replay_summary(result).c_str(), stdout);
  if (evaluation) {
    std::fputs(evaluation_text(*evaluation).c_str(), stdout);
  }
  std::printf("written to %s: trajectory.tum hindsight.tum fixes.csv map.csv track.nmea plot.svg\n",
              out.c_str());
}

tl::expected<void, CommandError> check_outputs_of(const Options& options) {
  std::vector<std::filesystem::path> inputs = files_read(options.inputs, options.config);
  inputs.emplace_back(options.truth);
  std::vector<std::filesystem::path> outputs = replay_files(options.out);
  outputs.emplace_back(options.landmarks);
  return refuse_own_inputs(outputs, inputs);
}

/// Exit status EX_DATAERR when the replay is incomplete or the truth has none of its times, after everything
/// that could be done is done.
CommandResult run(const Options& options) {
  if (auto checked = check_outputs_of(options); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  const auto recordings = find_recordings(options.inputs);
  if (!recordings) {
    return tl::unexpected(recordings.error());
  }
  const auto first = std::find_if(recordings->begin(), recordings->end(),
                                  [](const RecordingFile& recording) { return recording.has_scans(); });
  const auto settings = load_for(first == recordings->end() ? nullptr : &*first, options.config);
  if (!settings) {
    return tl::unexpected(settings.error());
  }
  const auto truth = read_truth(options.truth);
  if (!truth) {
    return tl::unexpected(truth.error());
  }
  auto result = make_replay(options, *recordings, settings->loaded.config);
  if (!result) {
    return tl::unexpected(result.error());
  }
  leave_out_own(options, result->not_read);
  const auto evaluation = compare(*truth, *result, options);
  if (!evaluation) {
    return tl::unexpected(evaluation.error());
  }
  const auto times = options.no_times ? MeasuredTimes::Empty : MeasuredTimes::Written;
  const auto written =
      write_replay(*result, settings->loaded.config, *truth, *evaluation, times, options.out);
  if (!written) {
    return tl::unexpected(CommandError{written.error().message + '\n', EX_CANTCREAT});
  }
  if (!options.landmarks.empty()) {
    const auto listed = write_file(options.landmarks, format_landmarks(result->landmarks));
    if (!listed) {
      return tl::unexpected(CommandError{listed.error().message + '\n', EX_CANTCREAT});
    }
  }
  print(*result, *evaluation, options.out);
  const bool is_compared = !*evaluation || !has_nothing_in_common(**evaluation);
  return is_compared && !is_incomplete(*result) ? EX_OK : EX_DATAERR;
}

}  // namespace

void add_replay(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "replay", "localise recorded scans: point clouds, readings, landmark lists, recordings");
  options->config.add_to(*verb);
  verb->add_option("--truth", options->truth,
                   "true poses to compare with (TUM: t x y z qx qy qz qw, t = time stamp or scan number)")
      ->type_name("T.tum");
  verb->add_option("--time-tolerance", options->tolerance_s,
                   "a fix belongs to the nearest true pose if their times differ by no more, s")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->check(is_finite);
  verb->add_option("--out", options->out, "folder for the results")->required()->type_name("DIR");
  verb->add_option("--landmarks", options->landmarks,
                   "write the landmarks that were found in the readings as a list, which replay takes, too")
      ->type_name("FILE");
  verb->add_flag("--no-times", options->no_times,
                 "cut no search by the deadline and leave the measured milliseconds out of fixes.csv: the "
                 "same input gives "
                 "the same bytes");
  verb->add_option("INPUT", options->inputs,
                   "folders or files: .pcd clouds, readings .csv, landmarks .csv; or one recording or log of "
                   "lcm-logger")
      ->required();
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
