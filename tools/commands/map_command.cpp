#include "firmware/config/daemon_config.hpp"
#include "firmware/store/map_names.hpp"
#include "firmware/store/map_store.hpp"
#include "tools/commands/command.hpp"
#include "tools/map_files/export_map.hpp"
#include "tools/map_files/open_map.hpp"
#include "tools/map_files/survey_map.hpp"
#include "tools/output/result_files.hpp"
#include "tools/output/text_output.hpp"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace slamsensor::tools {

/// Adds `export` and `import` to the verb `map`; each leaves its result in `result`.
void add_map_export(CLI::App& map, CommandResult& result);
void add_map_import(CLI::App& map, CommandResult& result);

namespace {

constexpr std::string_view kSuffix = ".slammap";

tl::unexpected<CommandError> fail(std::string message, int exit_status = EX_DATAERR) {
  return tl::unexpected(CommandError{std::move(message) + '\n', exit_status});
}

/// --datum: where the map lies on the earth.
class DatumOption {
 public:
  void add_to(CLI::App& verb, const std::string& help) {
    verb.add_option("--datum", values_, help)->expected(4)->type_name("LATITUDE LONGITUDE HEIGHT BEARING");
  }

  /// None when it was not given.
  [[nodiscard]] tl::expected<std::optional<firmware::Datum>, CommandError> datum() const {
    if (values_.empty()) {
      return std::nullopt;
    }
    const firmware::Datum datum{values_[0], values_[1], values_[2], values_[3]};
    if (!firmware::is_on_earth(datum)) {
      return fail("--datum: latitude -90 to 90, longitude -180 to 180, height " +
                      shown(firmware::kDatumHeightMin_m) + " to " + shown(firmware::kDatumHeightMax_m) +
                      " m, bearing -360 to 360",
                  EX_USAGE);
    }
    return datum;
  }

 private:
  std::vector<double> values_;
};

void add_store(CLI::App& verb, std::filesystem::path& store) {
  store = firmware::MapStoreConfig().directory;
  verb.add_option("--store", store, "the folder of the sensor's maps (map.directory)")
      ->type_name("FOLDER")
      ->capture_default_str();
}

// --- export ----------------------------------------------------------------------------------------------

struct ExportOptions {
  std::string map;
  std::filesystem::path store;
  ExportFormat format = ExportFormat::GeoJson;
  std::filesystem::path out;
  DatumOption datum;
};

CommandResult run_export(const ExportOptions& options) {
  const auto datum = options.datum.datum();
  if (!datum) {
    return tl::unexpected(datum.error());
  }
  auto opened = open_map(options.map, options.store);
  if (!opened) {
    return fail(opened.error());
  }
  const std::vector<std::filesystem::path> outputs{options.out};
  const std::vector<std::filesystem::path> inputs{opened->path};
  if (auto checked = refuse_own_inputs(outputs, inputs); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  firmware::MapFile& map = opened->map;
  if (*datum) {
    map.about.datum = *datum;
  }
  const auto text = export_map(map, options.format);
  if (!text) {
    return fail(opened->path.string() + ": " + text.error());
  }
  if (!opened->warning.empty()) {
    std::fprintf(stderr, "slamsensor: %s\n", opened->warning.c_str());
  }
  if (options.out.empty()) {
    std::fputs(text->c_str(), stdout);
  } else if (const auto written = write_file(options.out, *text); !written) {
    return fail(written.error().message, EX_CANTCREAT);
  }
  std::fprintf(stderr, "%s: %zu landmarks, %zu poses, %s\n", map.about.name.c_str(), map.landmarks.size(),
               map.path.size(),
               map.about.datum ? "WGS 84" : "metres in the map's frame, for the map has no datum");
  return EX_OK;
}

// --- import ----------------------------------------------------------------------------------------------

struct ImportOptions {
  std::filesystem::path survey;
  std::string out;
  std::filesystem::path store;
  std::vector<std::string> columns;
  std::string where;
  std::vector<double> origin_m;
  DatumOption datum;
  bool growing = false;
  bool replace = false;
};

tl::expected<SurveyColumns, CommandError> columns_of(const ImportOptions& options) {
  SurveyColumns columns;
  if (!options.columns.empty()) {
    columns.x = options.columns[0];
    columns.y = options.columns[1];
  }
  if (!options.where.empty()) {
    const std::size_t sign = options.where.find('=');
    if (sign == 0 || sign == std::string::npos) {
      return fail("--where: COLUMN=VALUE is needed, such as plot=3", EX_USAGE);
    }
    columns.where.emplace(options.where.substr(0, sign), options.where.substr(sign + 1));
  }
  return columns;
}

bool is_file_name(const std::string& out) {
  return out.ends_with(kSuffix);
}

/// The name that the map has inside: of a file its stem.
tl::expected<std::string, CommandError> map_name_of(const std::string& out) {
  if (out.find('/') != std::string::npos && !is_file_name(out)) {
    return fail("--out: " + in_quotes(out) + " is neither a name nor a map file; end a path in " +
                    std::string(kSuffix) + ", as in " + out + std::string(kSuffix),
                EX_USAGE);
  }
  std::string name = is_file_name(out) ? std::filesystem::path(out).stem().string() : out;
  if (!firmware::is_map_name(name)) {
    return fail("--out: " + firmware::bad_map_name(name).value().message, EX_USAGE);
  }
  return name;
}

/// The daemon reads its maps as the owner of the store.
void give_to_owner_of_folder(const std::filesystem::path& path) {
  struct stat folder {};
  if (::geteuid() == 0 && ::stat(path.parent_path().c_str(), &folder) == 0 &&
      ::chown(path.c_str(), folder.st_uid, folder.st_gid) != 0) {
    std::fprintf(stderr, "slamsensor: %s: its owner stays root; chown it to that of the folder\n",
                 path.c_str());
  }
}

/// A new file can be put beside the maps of a running daemon, which looks at it when it is asked to load it;
/// a map that is there is replaced as the daemon would, with its generation before, while no daemon runs.
tl::expected<std::filesystem::path, CommandError> put(const ImportOptions& options, firmware::MapFile& map,
                                                      std::int64_t now_utc_s) {
  const bool is_file = is_file_name(options.out);
  const std::filesystem::path path = is_file ? std::filesystem::path(options.out)
                                             : firmware::paths_of(options.store, map.about.name).current;
  std::error_code ignored;
  const bool is_there = std::filesystem::exists(path, ignored);
  if (std::filesystem::equivalent(path, options.survey, ignored)) {
    return fail(path.string() + ": it is the survey itself, which would be overwritten; choose another name",
                EX_CANTCREAT);
  }
  if (is_there && !options.replace) {
    return fail(path.string() + ": it is there already; choose another name, or say --replace", EX_CANTCREAT);
  }
  if (is_there && !is_file) {
    firmware::MapStore store(options.store, firmware::unlimited_capacities());
    if (const auto prepared = store.prepare(); !prepared) {
      return fail(prepared.error().message, EX_CANTCREAT);
    }
    if (const auto saved = store.save(map.about, map.state(), now_utc_s); !saved) {
      return fail(saved.error().message, EX_CANTCREAT);
    }
  } else {
    map.about.created_utc_s = map.about.saved_utc_s = now_utc_s;
    map.about.saves = 1;
    const std::vector<std::uint8_t> bytes = firmware::encode_map(map.about, map.state());
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (const auto written = write_file(path, text); !written) {
      return fail(written.error().message + (is_file ? "" : ", or name another store with --store FOLDER"),
                  EX_CANTCREAT);
    }
  }
  if (!is_file) {
    give_to_owner_of_folder(path);
  }
  return path;
}

void print_import(const SurveyMap& made, const Survey& survey, const std::filesystem::path& path) {
  const firmware::MapFile& map = made.map;
  std::printf("file       %s\n", path.c_str());
  std::printf("landmarks  %zu, xi 0, ids %s; %s\n", map.landmarks.size(),
              made.id_problem.empty() ? "of the survey" : ("given in its order: " + made.id_problem).c_str(),
              map.about.frozen ? "frozen: a sensor localises in it and does not change it" : "it may grow");
  if (survey.passed_over > 0 || made.at_one_place > 0) {
    std::printf("left out   %zu rows or features that are no points asked for, %zu within 1 cm of another\n",
                survey.passed_over, made.at_one_place);
  }
  if (!survey.degrees_not_read.empty()) {
    std::printf("not read   the columns in degrees, as there are some in metres; --columns %s reads them\n",
                survey.degrees_not_read.c_str());
  }
  if (!map.about.datum) {
    std::printf("datum      none: the map's metres are those of the survey (--datum gives it a place)\n");
    return;
  }
  const firmware::Datum& datum = *map.about.datum;
  std::printf("datum      latitude %.7f, longitude %.7f, height %.2f m, x towards %.3f deg%s\n",
              datum.latitude_deg, datum.longitude_deg, datum.height_m, datum.bearing_deg,
              made.is_datum_of_points ? "; the middle of the points" : "");
}

CommandResult run_import(const ImportOptions& options) {
  const auto datum = options.datum.datum();
  if (!datum) {
    return tl::unexpected(datum.error());
  }
  const auto columns = columns_of(options);
  if (!columns) {
    return tl::unexpected(columns.error());
  }
  auto name = map_name_of(options.out);
  if (!name) {
    return tl::unexpected(name.error());
  }
  const auto survey = read_survey(options.survey, *columns);
  if (!survey) {
    return fail(survey.error().message);
  }
  if (survey->frame == SurveyFrame::Wgs84 && !options.origin_m.empty()) {
    return fail(
        "--origin: it is subtracted from metres, and this survey is in degrees; --datum says where the "
        "map's origin lies",
        EX_USAGE);
  }
  SurveyMapWishes wishes{*datum, core::Point2::Zero(), !options.growing};
  if (!options.origin_m.empty()) {
    wishes.origin_m = {options.origin_m[0], options.origin_m[1]};
  }
  auto made = map_of_survey(*survey, options.survey.string(), wishes);
  if (!made) {
    return fail(made.error().message);
  }
  made->map.about.name = *name;
  const auto path = put(options, made->map, std::time(nullptr));
  if (!path) {
    return tl::unexpected(path.error());
  }
  print_import(*made, *survey, *path);
  return EX_OK;
}

}  // namespace

void add_map_export(CLI::App& map, CommandResult& result) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* verb = map.add_subcommand("export", "write a map for other programs to read");
  verb->add_option("MAP", options->map, "a map file, or the name of a map of the store")->required();
  const std::map<std::string, ExportFormat> formats = {{"geojson", ExportFormat::GeoJson},
                                                       {"csv", ExportFormat::Csv},
                                                       {"gpx", ExportFormat::Gpx},
                                                       {"kml", ExportFormat::Kml}};
  verb->add_option_function<std::string>(
          "--format", [options, formats](const std::string& name) { options->format = formats.at(name); },
          "of what is written; gpx and kml need a datum")
      ->check(CLI::IsMember(formats))
      ->required();
  verb->add_option("--out", options->out, "the file to write; else the text is printed")->type_name("FILE");
  options->datum.add_to(*verb,
                        "where the map's origin lies and where its x axis points, deg and m, instead of "
                        "the map's own");
  add_store(*verb, options->store);
  verb->callback([options, &result] { result = run_export(*options); });
}

void add_map_import(CLI::App& map, CommandResult& result) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* verb = map.add_subcommand(
      "import", "make a map from a survey, so that a sensor localises in it without ever having mapped");
  verb->add_option("FILE", options->survey,
                   "CSV with x_m,y_m or latitude_deg,longitude_deg (and id), or GeoJSON points")
      ->required();
  verb->add_option("--out", options->out, "the map: a name in the store, or a file NAME.slammap")
      ->required()
      ->type_name("NAME");
  verb->add_option("--columns", options->columns,
                   "the columns of a CSV that hold the metres, or the degrees: latitude, longitude")
      ->expected(2)
      ->type_name("X Y");
  verb->add_option("--where", options->where, "only the rows of a CSV whose column has that value")
      ->type_name("COLUMN=VALUE");
  verb->add_option("--origin", options->origin_m, "subtracted from local metres: near the survey's middle")
      ->expected(2)
      ->check(is_finite)
      ->type_name("X Y");
  options->datum.add_to(*verb, "where the map's origin lies and where its x axis points, deg and m");
  verb->add_flag("--growing", options->growing, "let the sensor change the map; else it is marked frozen");
  verb->add_flag("--replace", options->replace, "a map of that name goes before it");
  add_store(*verb, options->store);
  verb->callback([options, &result] { result = run_import(*options); });
}

namespace {

struct Options {
  std::string map;
  std::filesystem::path store = firmware::MapStoreConfig().directory;
  std::filesystem::path csv;
};

CommandResult run(const Options& options) {
  if (options.map.empty()) {
    return tl::unexpected(CommandError{
        "map: name a map file or a map of the store, or say export or import; slamsensor map --help\n",
        EX_USAGE});
  }
  const auto opened = open_map(options.map, options.store);
  if (!opened) {
    return tl::unexpected(CommandError{opened.error() + '\n', EX_DATAERR});
  }
  const std::vector<std::filesystem::path> outputs{options.csv};
  const std::vector<std::filesystem::path> inputs{opened->path};
  if (auto checked = refuse_own_inputs(outputs, inputs); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  std::fputs(map_info_text(opened->map, opened->bytes).c_str(), stdout);
  if (!options.csv.empty()) {
    if (const auto written = write_map(options.csv, map_rows(opened->map)); !written) {
      return tl::unexpected(CommandError{written.error().message + '\n', EX_CANTCREAT});
    }
  }
  return EX_OK;
}

}  // namespace

void add_map(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("map", "what a map holds; a map for other programs, a survey as a map");
  verb->add_option("MAP", options->map, "a map file NAME.slammap, or the name of a map of the store");
  verb->add_option("--store", options->store, "the folder of the sensor's maps (map.directory)")
      ->type_name("FOLDER")
      ->capture_default_str();
  verb->add_option("--csv", options->csv, "write its landmarks for locate --map: id,x_m,y_m,...")
      ->type_name("map.csv");
  verb->require_subcommand(0, 1);
  add_map_export(*verb, result);
  add_map_import(*verb, result);
  verb->callback([verb, options, &result] {
    if (verb->get_subcommands().empty()) {
      result = run(*options);
    }
  });
}

}  // namespace slamsensor::tools
