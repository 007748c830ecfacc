#include "firmware/daemon/daemon_control.hpp"

#include "firmware/config/list_config.hpp"
#include "firmware/daemon/refusal.hpp"
#include "firmware/daemon/version.hpp"
#include "hal/clock.hpp"

#include <utility>

namespace slamsensor::firmware {
namespace {

struct Moment {
  hal::Stamp now{};
  std::int64_t utc_s = 0;

  [[nodiscard]] OutputTime output() const { return {now, now + hal::realtime_ahead()}; }
};

Moment moment() {
  const hal::Stamp now = hal::monotonic_now();
  return {now, std::chrono::duration_cast<std::chrono::seconds>(now + hal::realtime_ahead()).count()};
}

ControlReply done(std::string summary) {
  return {std::move(summary), {}};
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

}  // namespace

Config DaemonControl::effective() const {
  Config config = config_.current().config;
  if (!config.datum) {
    config.datum = maps_.datum();
  }
  return config;
}

void DaemonControl::apply() {
  const Config config = effective();
  threads_.publish().set_config(config);
  maps_.set_config(config_.current().config);
  recordings_.set_config(config_.current().config);
  if (std::exchange(mode_, config.scan_head.scan.mode) != config.scan_head.scan.mode) {
    threads_.scan_orders().mode = mode_;
  }
}

const SensorStatus& DaemonControl::status() {
  status_ = threads_.publish().status();
  return status_;
}

std::string DaemonControl::version() const {
  return "slamsensord " + std::string(kVersion);
}

ControlOutcome DaemonControl::scan_now(ControlToken) {
  ++threads_.scan_orders().scans_requested;
  return done("scan requested");
}

ControlOutcome DaemonControl::scan_pause(ControlToken) {
  threads_.scan_orders().paused = true;
  return done("scanning is paused");
}

ControlOutcome DaemonControl::scan_resume(ControlToken) {
  threads_.scan_orders().paused = false;
  return done("scanning goes on");
}

ControlOutcome DaemonControl::scan_mode(ControlToken, ScanMode mode) {
  threads_.scan_orders().mode = mode;
  return done("done");
}

ControlOutcome DaemonControl::map_list(ControlToken) {
  return maps_.list();
}

ControlOutcome DaemonControl::map_info(ControlToken) {
  return maps_.info();
}

ControlOutcome DaemonControl::map_save(ControlToken, std::string_view name) {
  const Moment at = moment();
  return maps_.save(name, at.now, at.utc_s);
}

ControlOutcome DaemonControl::map_load(ControlToken token, std::string_view name) {
  return maps_.load(token, name);
}

ControlOutcome DaemonControl::map_remove(ControlToken, std::string_view name) {
  return maps_.remove(name);
}

ControlOutcome DaemonControl::map_reset(ControlToken token) {
  const Moment at = moment();
  return maps_.reset(token, at.now, at.utc_s);
}

ControlOutcome DaemonControl::map_mode(ControlToken token, MapMode mode) {
  const Moment at = moment();
  return maps_.set_mode(token, mode, at.now, at.utc_s);
}

ControlOutcome DaemonControl::datum_show(ControlToken) {
  const Config config = effective();
  if (!config.datum) {
    return done("no datum: no latitude or longitude is told; datum set LATITUDE LONGITUDE HEIGHT BEARING");
  }
  ControlReply reply = done(config_.current().config.datum ? "of the configuration" : "of the map");
  reply.lines = {"latitude_deg: " + real_text(config.datum->latitude_deg),
                 "longitude_deg: " + real_text(config.datum->longitude_deg),
                 "height_m: " + real_text(config.datum->height_m),
                 "bearing_deg: " + real_text(config.datum->bearing_deg)};
  return reply;
}

ControlOutcome DaemonControl::datum_set(ControlToken, const Datum& datum) {
  return reconfigured(config_.set({{"datum.latitude_deg", real_text(datum.latitude_deg)},
                                   {"datum.longitude_deg", real_text(datum.longitude_deg)},
                                   {"datum.height_m", real_text(datum.height_m)},
                                   {"datum.bearing_deg", real_text(datum.bearing_deg)}}),
                      "datum set until the next start; write it into the configuration to keep it, or save "
                      "the map: it is kept with it");
}

ControlOutcome DaemonControl::datum_clear(ControlToken) {
  return reconfigured(config_.set_absent("datum"), "datum cleared");
}

ControlOutcome DaemonControl::config_get(ControlToken, std::string_view key) {
  const auto index = find_setting(key);
  if (!index) {
    return refusal(ControlErrorCode::NotFound, "there is no key '" + std::string(key) + "'");
  }
  const Setting& setting = settings()[*index];
  ControlReply reply = done("");
  reply.lines = {
      "value: " + value_text(setting, config_.current().config).value_or("none"),
      "from: " + config_.current().origin(key).short_text(), "allowed: " + allowed_text(setting),
      std::string("takes effect: ") + (setting.apply == Apply::Live ? "at once" : "at the next start")};
  return reply;
}

ControlOutcome DaemonControl::config_set(ControlToken, std::string_view key, std::string_view value) {
  return reconfigured(config_.set({{std::string(key), std::string(value)}}), "set until the next start");
}

ControlOutcome DaemonControl::config_unset(ControlToken, std::string_view key) {
  return reconfigured(config_.unset(key), "unset");
}

ControlOutcome DaemonControl::config_list(ControlToken) {
  ControlReply reply = done("");
  reply.lines = lines_of(list_config(config_.current()));
  for (const ConfigChange& change : config_.pending()) {
    reply.lines.push_back(change.text());
  }
  return reply;
}

ControlOutcome DaemonControl::config_reload(ControlToken) {
  return reconfigured(config_.reload(), "configuration read again");
}

ControlResult DaemonControl::reconfigured(const LayeredConfig::Result& result, std::string_view what) {
  if (!result) {
    std::string text;
    for (const ConfigError& error : result.error()) {
      log_.error(error.text());
      text += (text.empty() ? "" : "; ") + error.text();
    }
    return refusal(ControlErrorCode::Config, text + "; nothing was changed");
  }
  ControlReply reply = done(std::string(what));
  for (const auto* const changes : {&result->live, &result->pending}) {
    for (const ConfigChange& change : *changes) {
      log_.notice(change.text());
      reply.lines.push_back(change.text());
    }
  }
  apply();
  return reply;
}

ControlOutcome DaemonControl::record_start(ControlToken token, std::string_view name) {
  return recordings_.start(token, name, moment().output());
}

ControlOutcome DaemonControl::record_stop(ControlToken token) {
  return recordings_.stop(token);
}

ControlOutcome DaemonControl::record_status(ControlToken) {
  return recordings_.status();
}

ControlOutcome DaemonControl::set_log_level(ControlToken, LogLevel level) {
  log_.set_level(level);
  return done("log level " + std::string(to_string(level)));
}

}  // namespace slamsensor::firmware
