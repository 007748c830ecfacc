#include "firmware/config/daemon_config.hpp"
#include "tools/commands/command.hpp"
#include "tools/emulator/emulated_head.hpp"
#include "tools/output/result_files.hpp"
#include "tools/recording/record.hpp"

#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>

namespace slamsensor::tools {
namespace {

struct Options {
  std::filesystem::path input;
  RecordDrive drive;
  ConfigOptions config;
  std::optional<HeadKind> head;
  std::optional<std::uint64_t> seed;
  std::filesystem::path truth;
  bool is_live = false;
  std::string socket = firmware::ControlConfig().socket;
};

tl::expected<void, CommandError> prepare(const Options& options, RecordDrive& drive) {
  auto scenario = load_scenario(options.input, options.head);
  if (!scenario) {
    return tl::unexpected(CommandError{scenario.error().message + '\n', EX_DATAERR});
  }
  drive.scenario = std::move(*scenario);
  drive.scenario.seed = options.seed.value_or(drive.scenario.seed);
  return load(options.config).map([&](const firmware::LoadedConfig& loaded) {
    drive.config = loaded.config;
  });
}

void print(const RecordSummary& summary, const std::filesystem::path& out, double real_s) {
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  const std::uint64_t scans = std::max<std::uint64_t>(summary.scans, 1);
  std::printf("%u scans of %llu readings, %u fixes, %u scans aborted\n", summary.scans,
              number(summary.readings / scans), summary.fixes, summary.scans_aborted);
  std::printf("%.1f s of the sensor in %.1f s, %.2f s a scan\n", summary.simulated_s, real_s,
              real_s / static_cast<double>(scans));
  std::printf("written to %s: %llu bytes, %llu a scan, %llu events, %llu of them tape\n", out.c_str(),
              number(summary.bytes), number(summary.bytes / scans), number(summary.events),
              number(summary.tape_chunks));
  if (!summary.problem.empty()) {
    std::printf("at the end the head did not scan: %s\n", summary.problem.c_str());
  }
}

tl::expected<void, OutputError> write_truth_of(const RecordSummary& summary,
                                               const std::filesystem::path& path) {
  if (path.empty()) {
    return {};
  }
  return write_trajectory(path, summary.truth).and_then([&] {
    return write_file(events_path(path), summary.faults);
  });
}

/// Exit status EX_UNAVAILABLE when the head made fewer scans than were asked for.
CommandResult run(const Options& options) {
  if (options.is_live) {
    return record_live({options.socket, options.input.string(), options.drive.seconds}, stdout);
  }
  if (options.input.empty() || options.drive.out.empty()) {
    return tl::unexpected(CommandError{
        "record: name a world or scenario and --out FILE, or --live for the running daemon\n", EX_USAGE});
  }
  RecordDrive drive = options.drive;
  if (auto prepared = prepare(options, drive); !prepared) {
    return tl::unexpected(prepared.error());
  }
  const std::vector<std::filesystem::path> outputs{
      options.drive.out, options.truth, options.truth.empty() ? options.truth : events_path(options.truth)};
  std::vector<std::filesystem::path> own_inputs = options.config.files();
  own_inputs.insert(own_inputs.end(), {options.input, drive.scenario.world_file});
  if (auto checked = refuse_own_inputs(outputs, own_inputs); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  const auto begin = std::chrono::steady_clock::now();
  tl::expected<RecordSummary, WorldError> summary;
  {
    ProgressBar bar("record");
    summary = record_drive(drive, [&](std::uint32_t done, std::uint32_t total) { bar.update(done, total); });
  }
  if (!summary) {
    return tl::unexpected(CommandError{summary.error().message + '\n', EX_CANTCREAT});
  }
  const std::chrono::duration<double> real = std::chrono::steady_clock::now() - begin;
  print(*summary, drive.out, real.count());
  if (const auto written = write_truth_of(*summary, options.truth); !written) {
    return tl::unexpected(CommandError{written.error().message + '\n', EX_CANTCREAT});
  }
  return summary->scans >= drive.scans.value_or(drive.seconds ? 0 : 1) ? EX_OK : EX_UNAVAILABLE;
}

void add_options(CLI::App& verb, Options& options) {
  const std::map<std::string, HeadKind> kinds = {{"paper", HeadKind::Paper}, {"fast", HeadKind::Fast}};
  verb.add_option(
      "INPUT", options.input,
      "world or scenario (TOML), see config/worlds, config/scenarios; with --live the recording's "
      "name");
  verb.add_option("--out", options.drive.out, "the recording, an LCM event log")->type_name("FILE");
  verb.add_option("--scans", options.drive.scans,
                  "end after so many scans (1 without --seconds); the next stand comes with each")
      ->check(CLI::Range(1, 1'000'000));
  verb.add_option("--seconds", options.drive.seconds,
                  "end after so many s; the stands change as the scenario says")
      ->check(CLI::Range(0.001, 1e9))
      ->check(is_finite);
  auto* const live =
      verb.add_flag("--live", options.is_live,
                    "have the running daemon record its sensor, until interrupted or for --seconds");
  verb.add_option("--socket", options.socket, "the daemon's control socket")
      ->type_name("PATH")
      ->capture_default_str()
      ->needs(live);
  options.config.add_to(verb);
  verb.add_option_function<std::string>(
          "--head", [&options, kinds](const std::string& name) { options.head = kinds.at(name); },
          "paper: 1000 readings/s as in the paper; fast: 20000")
      ->check(CLI::IsMember(kinds));
  verb.add_option("--seed", options.seed, "of everything that happens by chance");
  verb.add_option("--truth", options.truth,
                  "where the sensor was at each scan (TUM), with stands and faults beside it (CSV)")
      ->type_name("FILE");
}

}  // namespace

void add_record(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "record", "record a live sensor, or a drive of an emulated one as fast as the processor, for replay");
  add_options(*verb, *options);
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
