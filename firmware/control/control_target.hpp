#pragma once

#include "firmware/config/config.hpp"
#include "firmware/control/control_answer.hpp"
#include "firmware/scan/scan_config.hpp"
#include "firmware/status/sensor_status.hpp"
#include "firmware/supervision/log_level.hpp"

#include <string>
#include <string_view>

namespace slamsensor::firmware {

/// Whether the map may change.
enum class MapMode : std::uint8_t { Growing, Frozen };

/// What control requests act on: the daemon. Called by the thread that steps the ControlServer, and never
/// waits: a function that cannot answer at once returns none, and the server is given the answer with the
/// token later. All arguments have been checked as far as that can be done without knowing the state: names
/// are map_name_allowed, a datum lies in the ranges of its settings, a key is one of settings().
class ControlTarget {
 public:
  ControlTarget() = default;
  ControlTarget(const ControlTarget&) = delete;
  ControlTarget& operator=(const ControlTarget&) = delete;
  virtual ~ControlTarget() = default;

  /// The newest status; valid until the next call.
  [[nodiscard]] virtual const SensorStatus& status() = 0;
  /// "slamsensord 0.1.0", in one line.
  [[nodiscard]] virtual std::string version() const = 0;

  virtual ControlOutcome scan_now(ControlToken token) = 0;
  virtual ControlOutcome scan_pause(ControlToken token) = 0;
  virtual ControlOutcome scan_resume(ControlToken token) = 0;
  virtual ControlOutcome scan_mode(ControlToken token, ScanMode mode) = 0;

  virtual ControlOutcome map_list(ControlToken token) = 0;
  virtual ControlOutcome map_info(ControlToken token) = 0;
  /// An empty `name` is that of the map in use.
  virtual ControlOutcome map_save(ControlToken token, std::string_view name) = 0;
  virtual ControlOutcome map_load(ControlToken token, std::string_view name) = 0;
  virtual ControlOutcome map_remove(ControlToken token, std::string_view name) = 0;
  virtual ControlOutcome map_reset(ControlToken token) = 0;
  virtual ControlOutcome map_mode(ControlToken token, MapMode mode) = 0;

  virtual ControlOutcome datum_show(ControlToken token) = 0;
  virtual ControlOutcome datum_set(ControlToken token, const Datum& datum) = 0;
  virtual ControlOutcome datum_clear(ControlToken token) = 0;

  virtual ControlOutcome config_get(ControlToken token, std::string_view key) = 0;
  /// `value` as it was written: TOML, or a bare word for a text.
  virtual ControlOutcome config_set(ControlToken token, std::string_view key, std::string_view value) = 0;
  virtual ControlOutcome config_unset(ControlToken token, std::string_view key) = 0;
  virtual ControlOutcome config_list(ControlToken token) = 0;
  virtual ControlOutcome config_reload(ControlToken token) = 0;

  /// An empty `name` lets the daemon choose one.
  virtual ControlOutcome record_start(ControlToken token, std::string_view name) = 0;
  virtual ControlOutcome record_stop(ControlToken token) = 0;
  virtual ControlOutcome record_status(ControlToken token) = 0;

  virtual ControlOutcome set_log_level(ControlToken token, LogLevel level) = 0;
};

}  // namespace slamsensor::firmware
