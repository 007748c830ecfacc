#include "tools/commands/command.hpp"
#include "tools/emulator/emulated_head.hpp"
#include "tools/emulator/real_time_head.hpp"
#include "tools/emulator/scenario.hpp"
#include "tools/output/text_output.hpp"

#include <CLI/CLI.hpp>

#include <csignal>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace slamsensor::tools {
namespace {

CommandResult run(DriveOptions& options) {
  return options.run().map([&](const SimulateSummary& summary) {
    std::printf("%u scans of %llu readings, %llu with a return, among %u objects (%u found no room)\n",
                summary.scans,
                static_cast<unsigned long long>(summary.readings / std::max(summary.scans, 1U)),
                static_cast<unsigned long long>(summary.returns / std::max(summary.scans, 1U)),
                summary.objects, summary.unplaced);
    std::printf("written to %s: scan_*.csv truth.tum stems.csv\n", options.simulate.out.c_str());
    return EX_OK;
  });
}

}  // namespace

void add_simulate(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<DriveOptions>();
  CLI::App* verb = app.add_subcommand("simulate", "make scans of a simulated world, with their truth");
  options->add_to(*verb);
  verb->add_option("--out", options->simulate.out, "folder for the scans")->required()->type_name("DIR");
  verb->add_option("WORLD", options->simulate.world, "world file (TOML); see config/worlds")->required();
  verb->callback([options, &result] { result = run(*options); });
}

namespace {

struct Options {
  std::filesystem::path input;
  RealTimeConfig places;
  std::optional<HeadKind> head;
  std::optional<std::uint64_t> seed;
  std::optional<double> dwell_s;
  std::optional<double> duration_s;
  std::filesystem::path truth;
  bool any_baud = false;
};

RealTimeHead::Orders orders;

extern "C" void obey(int signal) {
  (signal == SIGUSR1 ? orders.next_stand : orders.stop) = 1;
}

// Blocked here and let through where the head waits: no signal comes between looking and waiting.
void take_orders() {
  sigset_t taken;
  sigemptyset(&taken);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) {
    sigaddset(&taken, signal);
    struct sigaction action {};
    action.sa_handler = obey;
    ::sigaction(signal, &action, nullptr);
  }
  ::sigprocmask(SIG_BLOCK, &taken, nullptr);
}

// --can alone asks for a head on the bus.
void fit_to_places(Scenario& scenario, const RealTimeConfig& places) {
  HeadProfile& head = scenario.head;
  if (!places.can.empty() && !is_on_bus(head.ptu.unit) && !is_on_bus(head.rangefinder.unit) &&
      head.inclinometer.unit == InclinometerModel::None) {
    head.ptu.unit = PanTiltModel::CanOpen;
    head.rangefinder.unit = RangefinderModel::Tf03Can;
  }
}

tl::expected<Scenario, WorldError> scenario_of(const Options& options) {
  return load_scenario(options.input, options.head).map([&](Scenario scenario) {
    fit_to_places(scenario, options.places);
    scenario.seed = options.seed.value_or(scenario.seed);
    scenario.drive.period_s = options.dwell_s.value_or(scenario.drive.period_s);
    return scenario;
  });
}

void print_places(EmulatedHead& head, const Scenario& scenario, const RealTimeConfig& places) {
  const PtuProfile& ptu = scenario.head.ptu;
  const RangefinderProfile& finder = scenario.head.rangefinder;
  const auto place = [&](const char* name, std::string_view title, const EmulatedPort* port,
                         std::uint32_t baud, const std::filesystem::path& path) {
    const std::string where = port != nullptr ? "at " + std::to_string(baud) + " baud on " + path.string()
                                              : "on the CAN interface " + places.can;
    std::printf("%s: %.*s %s\n", name, static_cast<int>(title.size()), title.data(), where.c_str());
  };
  place("ptu", text_of(ptu.unit).title, head.ptu_port(), ptu.baud, places.ptu);
  place("rangefinder", text_of(finder.unit).title, head.rangefinder_port(), finder.baud, places.rangefinder);
  if (const InclinometerProfile& inclinometer = scenario.head.inclinometer;
      inclinometer.unit != InclinometerModel::None) {
    place("inclinometer", "CiA 410, node " + std::to_string(inclinometer.node), nullptr, 0, {});
  }
  const bool by_time = scenario.change == StandChange::AtTimes;
  std::printf("%zu stands, %s; send SIGUSR1 for the next stand, SIGINT to end\n", head.stands().stands(),
              by_time ? ("the next every " + fixed_text(scenario.drive.period_s, 1) + " s").c_str()
                      : "the next by signal alone");
  std::fflush(stdout);
}

void print_end(const EmulatedHead& head, const RealTimeHead& real_time) {
  std::printf("%.1f s, %zu places, %zu faults; bytes late: %s; %llu lost by hosts that did not read\n",
              hal::to_seconds(head.clock().now), head.visits().size(), head.faults().size(),
              real_time.lateness().text().c_str(), static_cast<unsigned long long>(real_time.lost()));
}

CommandResult emulate(const Options& options, EmulatedHead& head, RealTimeHead& real_time) {
  take_orders();
  const Stamp end = options.duration_s ? hal::from_seconds(*options.duration_s) : hal::kNever;
  real_time.run(end, orders);
  print_end(head, real_time);
  if (options.truth.empty()) {
    return EX_OK;
  }
  return write_truth(head, real_time.origin(), options.truth)
      .map([] { return EX_OK; })
      .map_error([](const OutputError& error) {
        return CommandError{error.message + '\n', EX_CANTCREAT};
      });
}

CommandResult run(const Options& options) {
  const auto refused = [](const WorldError& error, int status) {
    return tl::unexpected(CommandError{error.message + '\n', status});
  };
  const auto scenario = scenario_of(options);
  if (!scenario) {
    return refused(scenario.error(), EX_DATAERR);
  }
  const std::vector<std::filesystem::path> inputs{options.input, scenario->world_file};
  const std::vector<std::filesystem::path> outputs{
      options.truth, options.truth.empty() ? options.truth : events_path(options.truth)};
  if (auto checked = refuse_own_inputs(outputs, inputs); !checked) {
    return tl::unexpected(std::move(checked.error()));
  }
  const auto head = EmulatedHead::create(*scenario);
  if (!head) {
    return refused(head.error(), EX_DATAERR);
  }
  const auto real_time = RealTimeHead::create(**head, options.places);
  if (!real_time) {
    return refused(real_time.error(), EX_UNAVAILABLE);
  }
  print_places(**head, *scenario, options.places);
  return emulate(options, **head, **real_time);
}

void add_options(CLI::App& verb, Options& options) {
  const std::map<std::string, HeadKind> kinds = {{"paper", HeadKind::Paper}, {"fast", HeadKind::Fast}};
  verb.add_option("INPUT", options.input, "world or scenario (TOML); see config/worlds, config/scenarios")
      ->required();
  verb.add_option("--ptu", options.places.ptu, "name of the pan-tilt unit's port")->capture_default_str();
  verb.add_option("--rangefinder", options.places.rangefinder, "name of the rangefinder's port")
      ->capture_default_str();
  verb.add_option("--can", options.places.can,
                  "CAN interface of the devices on a bus; a head that has none gets them")
      ->type_name("IFACE");
  verb.add_option_function<std::string>(
          "--head", [&options, kinds](const std::string& name) { options.head = kinds.at(name); },
          "paper: 1000 readings/s as in the paper; fast: 20000, a scan in 15 s")
      ->check(CLI::IsMember(kinds));
  verb.add_option("--seed", options.seed, "of everything that happens by chance");
  verb.add_option("--dwell", options.dwell_s, "time at each stand, s")
      ->check(CLI::Range(0.001, 1e6))
      ->check(is_finite);
  verb.add_option("--duration", options.duration_s, "end after so many s")
      ->check(CLI::Range(0.0, 1e9))
      ->check(is_finite);
  verb.add_option("--truth", options.truth, "where the sensor was (TUM), with the faults beside it (CSV)")
      ->type_name("FILE");
  verb.add_flag("--any-baud", options.any_baud, "understand hosts whatever line rate they have set");
}

}  // namespace

void add_emulate(CLI::App& app, CommandResult& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "emulate", "a sensor head's devices on pseudo-terminals or a CAN interface, in a simulated world");
  add_options(*verb, *options);
  verb->callback([options, &result] {
    options->places.baud = options->any_baud ? BaudRule::AnyRate : BaudRule::AsOnALine;
    result = run(*options);
  });
}

}  // namespace slamsensor::tools
