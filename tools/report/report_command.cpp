#include "tools/report/report_command.hpp"

#include "tools/commands/command.hpp"
#include "tools/input/text.hpp"
#include "tools/input/text_files.hpp"
#include "tools/output/text_output.hpp"
#include "tools/plot/svg.hpp"
#include "tools/report/report_plots.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace slamsensor::tools {
namespace {

struct Options {
  std::filesystem::path run;
  std::filesystem::path truth;
  std::filesystem::path out;
  bool png = false;
};

tl::unexpected<CommandError> fail(std::string message, int exit_status) {
  return tl::unexpected(CommandError{std::move(message) + '\n', exit_status});
}

/// Of the fixes against the truth, aligned by the first; none without a truth.
tl::expected<std::optional<AlignedErrors>, CommandError> errors_of(const Options& options) {
  if (options.truth.empty()) {
    return std::nullopt;
  }
  const auto truth = read_tum(options.truth);
  const auto trajectory = truth ? read_tum(options.run / "trajectory.tum") : truth;
  if (!trajectory) {
    return fail(trajectory.error().message, EX_DATAERR);
  }
  auto evaluation = evaluate(*truth, *trajectory);
  if (!evaluation) {
    return fail(evaluation.error().message, EX_DATAERR);
  }
  if (!evaluation->first_fix) {
    return fail(options.truth.string() + ": no fix has a time of the truth; check that both count time alike",
                EX_DATAERR);
  }
  return std::move(evaluation->first_fix);
}

/// A picture of the report and the file it goes to.
struct ReportPicture {
  std::filesystem::path path;
  std::string svg;
};

tl::expected<void, CommandError> check_outputs_of(std::span<const ReportPicture> pictures,
                                                  const Options& options) {
  const std::vector<std::filesystem::path> inputs{options.run / "fixes.csv", options.run / "trajectory.tum",
                                                  options.run / "plot.svg", options.truth};
  std::vector<std::filesystem::path> outputs;
  for (const ReportPicture& picture : pictures) {
    std::ranges::copy(picture_files(picture.path), std::back_inserter(outputs));
  }
  return refuse_own_inputs(outputs, inputs);
}

/// Trajectory and map, as the replay drew them, if it did, and the plots of its fixes.
std::vector<ReportPicture> pictures_of(std::span<const ReportPlot> plots, const std::filesystem::path& out,
                                       const Options& options) {
  const std::string ending = options.png ? ".png" : ".svg";
  std::vector<ReportPicture> pictures;
  if (const auto picture = read_file(options.run / "plot.svg")) {
    pictures.push_back({out / ("map" + ending), *picture});
  }
  for (const ReportPlot& plot : plots) {
    pictures.push_back({out / (plot.name + ending), draw_curve(plot.plot)});
  }
  return pictures;
}

CommandResult run(const Options& options) {
  const std::filesystem::path table = options.run / "fixes.csv";
  const auto text = read_file(table);
  if (!text) {
    return fail(text.error().message + "; name the --out folder of a replay", EX_NOINPUT);
  }
  const auto rows = parse_report_rows(*text, table.string());
  if (!rows) {
    return fail(rows.error().message, EX_DATAERR);
  }
  const auto errors = errors_of(options);
  if (!errors) {
    return tl::unexpected(errors.error());
  }
  const std::filesystem::path out = options.out.empty() ? options.run / "report" : options.out;
  const std::vector<ReportPicture> pictures = pictures_of(report_plots(*rows, *errors), out, options);
  if (auto checked = check_outputs_of(pictures, options); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  std::error_code ignored;  // what is wrong shows in the next step
  std::filesystem::create_directories(out, ignored);
  for (const ReportPicture& picture : pictures) {
    if (const auto written = write_picture(picture.path, picture.svg); !written) {
      return fail(written.error().message, EX_CANTCREAT);
    }
    for (const std::filesystem::path& file : picture_files(picture.path)) {
      std::printf("%s\n", file.c_str());
    }
  }
  return EX_OK;
}

}  // namespace

void add_report(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "report", "plots of a replay: map and trajectory, errors, sigma, xi, matches, time per scan");
  verb->add_option("RUN", options->run, "the --out folder of a replay")->required()->type_name("DIR");
  verb->add_option("--truth", options->truth, "true poses: plots of the errors too")->type_name("T.tum");
  verb->add_option("--out", options->out, "folder for the plots; else RUN/report")->type_name("DIR");
  verb->add_flag("--png", options->png, "also as PNG, by rsvg-convert (librsvg2-bin)");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace slamsensor::tools
