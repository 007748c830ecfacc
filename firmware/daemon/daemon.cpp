#include "firmware/daemon/daemon.hpp"

#include "firmware/config/list_config.hpp"
#include "firmware/control/status_report.hpp"
#include "firmware/daemon/realtime.hpp"
#include "firmware/status/sensor_status.hpp"
#include "firmware/status/status_text.hpp"
#include "hal/clock.hpp"

#include <array>
#include <poll.h>
#include <sys/random.h>
#include <utility>
#include <vector>

// What can be asked of the daemon by its control socket: one row for each request.

namespace slamsensor::firmware {
namespace {

using Request = ControlRequest;
using Context = ControlContext;

OutputTime time_now() {
  const hal::Stamp now = hal::monotonic_now();
  return {now, now + hal::realtime_ahead()};
}

ControlReply done(std::string summary) {
  return {std::move(summary), {}};
}

/// The status or a part of it, in the form that was asked for.
ControlReply shown(const Request& request, const Context& context,
                   std::vector<std::string> (*text)(const SensorStatus&),
                   std::string (*json)(const SensorStatus&)) {
  const SensorStatus status = context.threads.publish().status();
  return {{}, request.form == ReplyForm::Json ? std::vector{json(status)} : text(status)};
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// The settings in force; where no datum is configured, that of the map.
Config effective(const Context& context) {
  Config config = context.config.current().config;
  if (!config.datum) {
    config.datum = context.maps.datum();
  }
  return config;
}

ControlResult reconfigured(Context& context, const LayeredConfig::Result& result, std::string_view what) {
  if (!result) {
    std::string text;
    for (const ConfigError& error : result.error()) {
      context.log.error(error.text());
      text += (text.empty() ? "" : "; ") + error.text();
    }
    return refusal(ControlErrorCode::Config, text + "; nothing was changed");
  }
  ControlReply reply = done(std::string(what));
  for (const auto* const changes : {&result->live, &result->pending}) {
    for (const ConfigChange& change : *changes) {
      context.log.notice(change.text());
      reply.lines.push_back(change.text());
    }
  }
  apply_config(context);
  return reply;
}

ControlReply show_datum(const Context& context) {
  const auto datum = effective(context).datum;
  if (!datum) {
    return done("no datum: no latitude or longitude is sent; datum set LATITUDE LONGITUDE HEIGHT BEARING");
  }
  ControlReply reply = done(context.config.current().config.datum ? "of the configuration" : "of the map");
  reply.lines = {"latitude_deg: " + real_text(datum->latitude_deg),
                 "longitude_deg: " + real_text(datum->longitude_deg),
                 "height_m: " + real_text(datum->height_m), "bearing_deg: " + real_text(datum->bearing_deg)};
  return reply;
}

ControlResult set_datum(const Datum& datum, Context& context) {
  return reconfigured(context,
                      context.config.set({{"datum.latitude_deg", real_text(datum.latitude_deg)},
                                          {"datum.longitude_deg", real_text(datum.longitude_deg)},
                                          {"datum.height_m", real_text(datum.height_m)},
                                          {"datum.bearing_deg", real_text(datum.bearing_deg)}}),
                      "datum set until the next start; write it into the configuration to keep it, or save "
                      "the map: it is kept with it");
}

ControlReply get_config(const std::string& key, const LoadedConfig& config) {
  const Setting& setting = settings()[*find_setting(key)];
  ControlReply reply = done("");
  reply.lines = {
      "value: " + value_text(setting, config.config).value_or("none"),
      "from: " + config.origin(key).short_text(), "allowed: " + allowed_text(setting),
      std::string("takes effect: ") + (setting.apply == Apply::Live ? "at once" : "at the next start")};
  return reply;
}

ControlReply list_settings(const LayeredConfig& config) {
  ControlReply reply = done("");
  reply.lines = lines_of(list_config(config.current()));
  for (const ConfigChange& change : config.pending()) {
    reply.lines.push_back(change.text());
  }
  return reply;
}

constexpr std::array kVerbs = {
    ControlVerb{"help", "[COMMAND]", parse_words, "the requests, or those that begin so",
                [](const Request& r, Context&) -> ControlOutcome { return control_help(r.name); }},
    ControlVerb{"version", "", parse_nothing, "name and version of the daemon",
                [](const Request&, Context&) -> ControlOutcome {
                  return done("slamsensord " + std::string(kVersion));
                }},
    ControlVerb{
        "status", "[json]", parse_json, "how the sensor, its devices and its map stand",
        [](const Request& r, Context& c) -> ControlOutcome { return shown(r, c, status_text, status_json); }},
    ControlVerb{
        "fix", "[json]", parse_json, "the last fix: where, how sure, from what",
        [](const Request& r, Context& c) -> ControlOutcome { return shown(r, c, fix_text, fix_json); }},
    ControlVerb{"counters", "[json]", parse_json, "how often what has happened since start",
                [](const Request& r, Context& c) -> ControlOutcome {
                  return shown(r, c, counters_text, counters_json);
                }},
    ControlVerb{"devices", "[json]", parse_json, "pan-tilt unit and rangefinder",
                [](const Request& r, Context& c) -> ControlOutcome {
                  return shown(r, c, devices_text, devices_json);
                }},
    ControlVerb{"scan now", "", parse_nothing, "one more scan, in mode single",
                [](const Request&, Context& c) -> ControlOutcome {
                  ++c.threads.scan_orders().scans_requested;
                  return done(c.threads.scan_orders().paused
                                  ? "scan requested; scanning is paused: it is made after scan resume"
                                  : "scan requested");
                }},
    ControlVerb{"scan pause", "", parse_nothing, "stop scanning until scan resume",
                [](const Request&, Context& c) -> ControlOutcome {
                  c.threads.scan_orders().paused = true;
                  return done("scanning is paused");
                }},
    ControlVerb{"scan resume", "", parse_nothing, "scan again after scan pause",
                [](const Request&, Context& c) -> ControlOutcome {
                  c.threads.scan_orders().paused = false;
                  return done("scanning goes on");
                }},
    ControlVerb{"scan mode", "continuous|single", parse_mode, "one scan after the other, or on request",
                [](const Request& r, Context& c) -> ControlOutcome {
                  c.threads.scan_orders().mode = r.mode;
                  return done("done");
                }},
    ControlVerb{"map list", "", parse_nothing, "the maps in the store",
                [](const Request&, Context& c) -> ControlOutcome { return c.maps.list(); }},
    ControlVerb{"map info", "", parse_nothing, "the map in use",
                [](const Request&, Context& c) -> ControlOutcome { return c.maps.info(); }},
    ControlVerb{"map landmarks", "", parse_nothing,
                "the landmarks of the map in use: id, place, sigma, diameter",
                [](const Request&, Context& c) -> ControlOutcome { return c.maps.landmarks(); }},
    ControlVerb{
        "map save", "[NAME]", parse_optional_name, "save the map, under another name if given",
        [](const Request& r, Context& c) -> ControlOutcome { return c.maps.save(r.name, time_now()); }},
    ControlVerb{"map load", "NAME", parse_name, "use a map of the store; the present one is left as saved",
                [](const Request& r, Context& c) { return c.maps.load(r.token, r.name); }},
    ControlVerb{"map reset", "", parse_nothing, "begin an empty map, with the next scan as its origin",
                [](const Request& r, Context& c) { return c.maps.reset(r.token, time_now()); }},
    ControlVerb{"map remove", "NAME", parse_name, "delete a map from the store",
                [](const Request& r, Context& c) -> ControlOutcome { return c.maps.remove(r.name); }},
    ControlVerb{
        "map freeze", "", parse_nothing, "localise only: the map never changes",
        [](const Request& r, Context& c) { return c.maps.set_mode(r.token, MapMode::Frozen, time_now()); }},
    ControlVerb{
        "map unfreeze", "", parse_nothing, "let the map grow again",
        [](const Request& r, Context& c) { return c.maps.set_mode(r.token, MapMode::Growing, time_now()); }},
    ControlVerb{"datum show", "", parse_nothing, "what ties the map to the earth",
                [](const Request&, Context& c) -> ControlOutcome { return show_datum(c); }},
    ControlVerb{"datum set", "LAT LON HEIGHT BEARING", parse_datum,
                "tie the map's origin to the earth: deg, deg, m, true bearing of its x axis in deg",
                [](const Request& r, Context& c) -> ControlOutcome { return set_datum(r.datum, c); }},
    ControlVerb{"datum clear", "", parse_nothing, "no latitude and longitude any more",
                [](const Request&, Context& c) -> ControlOutcome {
                  return reconfigured(c, c.config.set_absent("datum"), "datum cleared");
                }},
    ControlVerb{"config get", "KEY", parse_key, "a value in force and where it comes from",
                [](const Request& r, Context& c) -> ControlOutcome {
                  return get_config(r.name, c.config.current());
                }},
    ControlVerb{"config set", "KEY VALUE", parse_key_and_value,
                "a value on top of all files, until the daemon ends",
                [](const Request& r, Context& c) -> ControlOutcome {
                  return reconfigured(c, c.config.set({{r.name, r.value}}), "set until the next start");
                }},
    ControlVerb{"config unset", "KEY", parse_key, "take back what config set has set",
                [](const Request& r, Context& c) -> ControlOutcome {
                  return reconfigured(c, c.config.unset(r.name), "unset");
                }},
    ControlVerb{"config list", "", parse_nothing, "every value in force and where it comes from",
                [](const Request&, Context& c) -> ControlOutcome { return list_settings(c.config); }},
    ControlVerb{"config reload", "", parse_nothing, "read the files again; says what needs a restart",
                [](const Request&, Context& c) -> ControlOutcome { return reload_config(c); }},
    ControlVerb{"record start", "[NAME]", parse_optional_name, "record the devices' bytes and the outputs",
                [](const Request& r, Context& c) { return c.recordings.start(r.token, r.name, time_now()); }},
    ControlVerb{"record stop", "", parse_nothing, "end the recording",
                [](const Request& r, Context& c) { return c.recordings.stop(r.token); }},
    ControlVerb{"record status", "", parse_nothing, "the recording under way",
                [](const Request&, Context& c) -> ControlOutcome { return c.recordings.status(); }},
    ControlVerb{"log level", "error|warning|notice|info|debug", parse_level, "what the daemon's log shows",
                [](const Request& r, Context& c) -> ControlOutcome {
                  c.log.set_level(r.level);
                  return done("log level " + std::string(to_string(r.level)));
                }},
};

}  // namespace

std::span<const ControlVerb> control_verbs() {
  return kVerbs;
}

void apply_config(ControlContext& context) {
  const Config& config = context.config.current().config;
  context.threads.publish().set_config(effective(context));
  context.maps.on_new_config();
  if (std::exchange(context.mode, config.scan_head.scan.mode) != config.scan_head.scan.mode) {
    context.threads.scan_orders().mode = context.mode;
  }
}

ControlResult reload_config(ControlContext& context) {
  ControlResult result = reconfigured(context, context.config.reload(), "configuration read again");
  if (result) {
    for (const ConfigError& warning : context.config.current().warnings) {
      context.log.warning(warning.text());
      result->lines.push_back(warning.text());
    }
  }
  return result;
}

namespace {

constexpr int kTurn_ms = 50;
constexpr hal::Stamp kTellPeriod = std::chrono::seconds(1);
constexpr hal::Stamp kFactsPeriod = std::chrono::milliseconds(200);
constexpr hal::Stamp kExtendPeriod = std::chrono::seconds(10);

OutputTime output_now() {
  const hal::Stamp now = hal::monotonic_now();
  return {now, now + hal::realtime_ahead()};
}

/// Differs from start to start, also where the clock was set back or never set.
std::uint64_t draw_initialization() {
  std::uint64_t value = 0;
  if (getrandom(&value, sizeof value, GRND_NONBLOCK) != sizeof value) {
    value = static_cast<std::uint64_t>(output_now().utc.count());
  }
  return value & INT64_MAX;  // LCM's integers are signed
}

/// Devices, outputs, map, recording and configuration, and every client that may connect.
std::uint64_t open_files_needed(const Config& config) {
  constexpr std::uint64_t kOwn = 32;
  return kOwn + kControlClientsMax +
         (config.daemon.nmea_tcp.enabled ? config.daemon.nmea_tcp.clients_max : 0);
}

tl::unexpected<StartFailure> failure(ExitReason reason, std::string message) {
  return tl::unexpected(StartFailure{reason, std::move(message)});
}

}  // namespace

tl::expected<std::unique_ptr<Daemon>, StartFailure> Daemon::create(LayeredConfig layers, SourceMode source,
                                                                   Log& log) {
  auto config = std::make_unique<LayeredConfig>(std::move(layers));
  if (auto raised = raise_open_files(open_files_needed(config->current().config)); !raised) {
    return failure(ExitReason::NoResources, raised.error());
  }
  auto signals = Signals::create();
  if (!signals) {
    return failure(ExitReason::NoResources, signals.error().message);
  }
  const hal::Stamp now = hal::monotonic_now();
  auto threads = SensorThreads::create(config->current().config, {source, draw_initialization(), now}, log);
  if (!threads) {
    return failure(ExitReason::Config, threads.error());
  }
  std::unique_ptr<Daemon> daemon(
      new Daemon(std::move(config), std::move(*signals), std::move(*threads), log, now));
  auto server = ControlServer::create(
      {.socket = daemon->config_->current().config.daemon.control.socket},
      [&control = daemon->control_](const ControlRequest& request) {
        return request.verb->run(request, control);
      },
      log);
  if (!server) {
    return failure(ExitReason::Unavailable, server.error().message);
  }
  daemon->server_ = std::move(*server);
  return daemon;
}

Daemon::Daemon(std::unique_ptr<LayeredConfig> config, Signals signals, std::unique_ptr<SensorThreads> threads,
               Log& log, hal::Stamp now)
    : config_(std::move(config)),
      log_(log),
      signals_(std::move(signals)),
      notifier_(ServiceNotifier::from_environment()),
      threads_(std::move(threads)),
      maps_(config_->current().config, *threads_, log, now),
      recordings_(config_->current().config, *threads_, maps_, log),
      control_{*config_, *threads_, maps_, recordings_, log},
      watchdog_(threads_->heartbeats(), notifier_) {
}

tl::expected<void, StartFailure> Daemon::run() {
  log_.notice("slamsensord " + std::string(kVersion) + " starts");
  maps_.load_at_start();
  if (auto started = threads_->start(); !started) {
    return failure(ExitReason::NoPermission, started.error());
  }
  log_.notice(threads_->is_realtime() ? "running in real time, memory locked"
                                      : "running without real-time rights");
  while (!is_stopping_ && !recordings_.failure()) {
    turn(output_now());
    wait();
  }
  return stop();
}

void Daemon::turn(const OutputTime& now) {
  take_signals(now);
  server_->step(now.monotonic);
  const std::uint32_t replaced = maps_.replaced();
  for (const MapKeeper::Answer& answer : maps_.step(now)) {
    server_->complete(answer.token, answer.result);
  }
  if (maps_.replaced() != replaced) {
    apply_config(control_);  // the map's datum may be in force now
    facts_told_ = {};
  }
  if (const auto answer = recordings_.step(now)) {
    server_->complete(answer->token, answer->result);
  }
  tell_facts(now.monotonic);
  tell_manager(now.monotonic);
}

void Daemon::wait() {
  std::vector<pollfd> interest{{signals_.fd(), POLLIN, 0}};
  server_->append_interest(interest);
  poll(interest.data(), interest.size(), kTurn_ms);
}

void Daemon::take_signals(const OutputTime& now) {
  while (const auto order = signals_.take()) {
    switch (*order) {
      case Order::Stop:
        is_stopping_ = true;
        break;
      case Order::Reload:
        reload(now);
        break;
      case Order::SaveMap:
        maps_.save_now(now);
        break;
    }
  }
}

void Daemon::reload(const OutputTime& now) {
  notifier_.reloading(now.monotonic);
  if (reload_config(control_)) {
    log_.notice("configuration read again");
  } else {
    log_.error("the configuration is not read again: it has mistakes; the one in force stays");
  }
  notifier_.ready();
}

/// Ready is said when the devices have answered; until then the manager is asked for patience.
void Daemon::tell_manager(hal::Stamp now) {
  if (const auto stalled = watchdog_.step(now)) {
    log_.error("thread " + std::string(stalled->name) + " has made no progress for " +
               std::to_string(std::chrono::duration_cast<std::chrono::seconds>(stalled->silence).count()) +
               " s");
  }
  if (now - told_ < kTellPeriod) {
    return;
  }
  told_ = now;
  log_.tick();
  const SensorStatus status = threads_->publish().status();
  notifier_.status(status_line(status));
  if (is_ready_) {
    return;
  }
  if (status.state != SensorState::Starting) {
    is_ready_ = true;
    notifier_.ready();
  } else if (now - extended_ >= kExtendPeriod || extended_ == hal::Stamp{}) {
    extended_ = now;
    notifier_.extend_timeout(3 * kExtendPeriod);
  }
}

void Daemon::tell_facts(hal::Stamp now) {
  if (facts_told_ != hal::Stamp{} && now - facts_told_ < kFactsPeriod) {
    return;
  }
  facts_told_ = now;
  SupervisorFacts facts;
  facts.map_name = hal::FixedText<64>(maps_.name());
  facts.map_saved = maps_.saved();
  facts.map_unsaved = maps_.is_unsaved();
  facts.realtime = threads_->is_realtime();
  facts.maps_replaced = maps_.replaced();
  facts.counters.append(server_->counters());
  facts.counters.append(std::array{hal::Counter{"log_lines_lost", log_.lost()}});
  threads_->publish().set_facts(facts);
}

tl::expected<void, StartFailure> Daemon::stop() {
  notifier_.stopping();
  log_.notice("stopping");
  threads_->stop();
  const OutputTime now = output_now();
  recordings_.finish_at_end(now);
  maps_.save_at_end(now);
  log_.flush();
  if (const auto& lost = recordings_.failure()) {
    return failure(ExitReason::Fault, *lost);
  }
  return {};
}

}  // namespace slamsensor::firmware
