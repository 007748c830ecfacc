#include "firmware/control/control_request.hpp"
#include "firmware/control/status_json.hpp"
#include "firmware/control/status_text.hpp"

#include <array>

namespace slamsensor::firmware {
namespace {

using Arguments = ControlArguments;
using Request = ControlRequest;

/// The status or a part of it, in the form that was asked for.
ControlOutcome told(const Request& request, ControlTarget& target,
                    std::vector<std::string> (*text)(const SensorStatus&),
                    std::string (*json)(const SensorStatus&)) {
  const SensorStatus& status = target.status();
  return ControlReply{{}, request.form == ReplyForm::Json ? std::vector{json(status)} : text(status)};
}

constexpr std::array kCommands = {
    ControlCommand{"help", Arguments::OptionalCommand, "[COMMAND]", "the requests, or those that begin so",
                   [](const Request& r, ControlToken, ControlTarget&) -> ControlOutcome {
                     return control_help(r.name);
                   }},
    ControlCommand{"version", Arguments::None, "", "name and version of the daemon",
                   [](const Request&, ControlToken, ControlTarget& t) -> ControlOutcome {
                     return ControlReply{t.version(), {}};
                   }},
    ControlCommand{"status", Arguments::OptionalJson, "[json]",
                   "how the sensor, its devices and its map stand",
                   [](const Request& r, ControlToken, ControlTarget& t) {
                     return told(r, t, status_text, status_json);
                   }},
    ControlCommand{
        "fix", Arguments::OptionalJson, "[json]", "the last fix: where, how sure, from what",
        [](const Request& r, ControlToken, ControlTarget& t) { return told(r, t, fix_text, fix_json); }},
    ControlCommand{"counters", Arguments::OptionalJson, "[json]", "how often what has happened since start",
                   [](const Request& r, ControlToken, ControlTarget& t) {
                     return told(r, t, counters_text, counters_json);
                   }},
    ControlCommand{"devices", Arguments::OptionalJson, "[json]", "pan-tilt unit and rangefinder",
                   [](const Request& r, ControlToken, ControlTarget& t) {
                     return told(r, t, devices_text, devices_json);
                   }},
    ControlCommand{"scan now", Arguments::None, "", "one more scan, in mode single",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.scan_now(k); }},
    ControlCommand{"scan pause", Arguments::None, "", "stop scanning until scan resume",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.scan_pause(k); }},
    ControlCommand{"scan resume", Arguments::None, "", "scan again after scan pause",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.scan_resume(k); }},
    ControlCommand{"scan mode", Arguments::Mode, "continuous|single",
                   "one scan after the other, or on request",
                   [](const Request& r, ControlToken k, ControlTarget& t) { return t.scan_mode(k, r.mode); }},
    ControlCommand{"map list", Arguments::None, "", "the maps in the store",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.map_list(k); }},
    ControlCommand{"map info", Arguments::None, "", "the map in use",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.map_info(k); }},
    ControlCommand{"map save", Arguments::OptionalName, "[NAME]", "save the map, under another name if given",
                   [](const Request& r, ControlToken k, ControlTarget& t) { return t.map_save(k, r.name); }},
    ControlCommand{"map load", Arguments::Name, "NAME",
                   "use a map of the store; the present one is left as saved",
                   [](const Request& r, ControlToken k, ControlTarget& t) { return t.map_load(k, r.name); }},
    ControlCommand{"map reset", Arguments::None, "", "begin an empty map, with the next scan as its origin",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.map_reset(k); }},
    ControlCommand{
        "map remove", Arguments::Name, "NAME", "delete a map from the store",
        [](const Request& r, ControlToken k, ControlTarget& t) { return t.map_remove(k, r.name); }},
    ControlCommand{
        "map freeze", Arguments::None, "", "localise only: the map never changes",
        [](const Request&, ControlToken k, ControlTarget& t) { return t.map_mode(k, MapMode::Frozen); }},
    ControlCommand{
        "map unfreeze", Arguments::None, "", "let the map grow again",
        [](const Request&, ControlToken k, ControlTarget& t) { return t.map_mode(k, MapMode::Growing); }},
    ControlCommand{"datum show", Arguments::None, "", "what ties the map to the earth",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.datum_show(k); }},
    ControlCommand{
        "datum set", Arguments::Datum, "LAT LON HEIGHT BEARING",
        "tie the map's origin to the earth: deg, deg, m, true bearing of its x axis in deg",
        [](const Request& r, ControlToken k, ControlTarget& t) { return t.datum_set(k, r.datum); }},
    ControlCommand{"datum clear", Arguments::None, "", "no latitude and longitude any more",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.datum_clear(k); }},
    ControlCommand{
        "config get", Arguments::Key, "KEY", "a value in force and where it comes from",
        [](const Request& r, ControlToken k, ControlTarget& t) { return t.config_get(k, r.name); }},
    ControlCommand{
        "config set", Arguments::KeyValue, "KEY VALUE", "a value on top of all files, until the daemon ends",
        [](const Request& r, ControlToken k, ControlTarget& t) { return t.config_set(k, r.name, r.value); }},
    ControlCommand{
        "config unset", Arguments::Key, "KEY", "take back what config set has set",
        [](const Request& r, ControlToken k, ControlTarget& t) { return t.config_unset(k, r.name); }},
    ControlCommand{"config list", Arguments::None, "", "every value in force and where it comes from",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.config_list(k); }},
    ControlCommand{"config reload", Arguments::None, "", "read the files again; says what needs a restart",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.config_reload(k); }},
    ControlCommand{
        "record start", Arguments::OptionalName, "[NAME]", "record the devices' bytes and the outputs",
        [](const Request& r, ControlToken k, ControlTarget& t) { return t.record_start(k, r.name); }},
    ControlCommand{"record stop", Arguments::None, "", "end the recording",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.record_stop(k); }},
    ControlCommand{"record status", Arguments::None, "", "the recording under way",
                   [](const Request&, ControlToken k, ControlTarget& t) { return t.record_status(k); }},
    ControlCommand{
        "log level", Arguments::Level, "error|warning|notice|info|debug", "what the daemon's log shows",
        [](const Request& r, ControlToken k, ControlTarget& t) { return t.set_log_level(k, r.level); }},
};

}  // namespace

std::span<const ControlCommand> control_commands() {
  return kCommands;
}

}  // namespace slamsensor::firmware
